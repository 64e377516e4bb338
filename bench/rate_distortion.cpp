// Bytes against picture error: QNV (packed, records) beside quadric-simplified meshes as Draco and as gzip'd VRML97.
//
//   rate_distortion MODEL... [--svg PLOT.svg]
//
// Prints a Markdown table a model: for every budget PSNR (dB) and SSIM against pictures of the full model from six
// sides, 800x600, headlight. A budget of a QNV stream is a prefix of one file; a mesh needs a file of its own for each,
// the best of several simplifications and quantisations. Needs draco_encoder and draco_decoder in the PATH.
#include "app/surface_triangles.h"
#include "app/world_loader.h"
#include "bench/picture_error.h"
#include "qnv/decoder.h"
#include "qnv/encode_surface.h"
#include "render/camera.h"
#include "render/context.h"
#include "render/renderer.h"

#include <meshoptimizer.h>
#include <zlib.h>
#include <glm/trigonometric.hpp>

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace {

using namespace gs;
using bench::PictureError;

constexpr std::array<std::size_t, 12> kBudgets{1000,   2000,    4000,    8000,    14'700,    32'000,
                                               64'000, 125'000, 250'000, 500'000, 1'000'000, 2'000'000};
constexpr std::array<std::array<float, 2>, 6> kViews{{{0, 0}, {60, 20}, {120, -20}, {180, 0}, {240, 30}, {300, -10}}};
constexpr int kWidth = 800, kHeight = 600;
constexpr std::array<const char*, 4> kCodecs{"packed", "records", "Draco", "gzip VRML"};

struct Mesh {
  std::vector<float> positions;  // x y z
  std::vector<unsigned> indices;
};

Mesh welded(const render::RenderList& list) {
  Mesh mesh;
  std::map<std::array<float, 3>, unsigned> seen;
  app::for_each_triangle(list, [&](std::span<const qnv::Triangle> triangles) {
    for (const qnv::Triangle& t : triangles)
      for (const glm::vec3& p : t.positions) {
        const auto [at, fresh] =
            seen.emplace(std::array<float, 3>{p.x, p.y, p.z}, static_cast<unsigned>(mesh.positions.size() / 3));
        if (fresh) mesh.positions.insert(mesh.positions.end(), {p.x, p.y, p.z});
        mesh.indices.push_back(at->second);
      }
    return true;
  });
  return mesh;
}

Mesh simplified(const Mesh& mesh, double part) {
  Mesh out;
  std::vector<unsigned> indices(mesh.indices.size());
  const auto target = static_cast<std::size_t>(static_cast<double>(mesh.indices.size()) * part) / 3 * 3;
  if (part < 1)
    indices.resize(meshopt_simplify(indices.data(), mesh.indices.data(), mesh.indices.size(), mesh.positions.data(),
                                    mesh.positions.size() / 3, 12, target, 1.0f, 0, nullptr));
  else
    indices = mesh.indices;
  std::vector<unsigned> places(mesh.positions.size() / 3, ~0u);
  for (const unsigned i : indices) {
    if (places[i] == ~0u) {
      places[i] = static_cast<unsigned>(out.positions.size() / 3);
      out.positions.insert(out.positions.end(),
                           {mesh.positions[3 * i], mesh.positions[3 * i + 1], mesh.positions[3 * i + 2]});
    }
    out.indices.push_back(places[i]);
  }
  return out;
}

void write_obj(const Mesh& mesh, const std::string& path) {
  std::ofstream out(path);
  char line[96];
  for (std::size_t i = 0; i + 2 < mesh.positions.size(); i += 3) {
    std::snprintf(line, sizeof line, "v %.9g %.9g %.9g\n", mesh.positions[i], mesh.positions[i + 1],
                  mesh.positions[i + 2]);
    out << line;
  }
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
    out << "f " << mesh.indices[i] + 1 << ' ' << mesh.indices[i + 1] + 1 << ' ' << mesh.indices[i + 2] + 1 << '\n';
}

// The bytes of the mesh as gzip'd VRML97 text, coordinates with six digits.
std::size_t gzip_vrml_bytes(const Mesh& mesh) {
  std::string text =
      "#VRML V2.0 utf8\nShape{appearance Appearance{material Material{}}geometry IndexedFaceSet{creaseAngle 3.14 solid "
      "FALSE coord Coordinate{point[\n";
  char line[96];
  for (std::size_t i = 0; i + 2 < mesh.positions.size(); i += 3) {
    std::snprintf(line, sizeof line, "%.6g %.6g %.6g\n", mesh.positions[i], mesh.positions[i + 1],
                  mesh.positions[i + 2]);
    text += line;
  }
  text += "]}coordIndex[\n";
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    std::snprintf(line, sizeof line, "%u %u %u -1\n", mesh.indices[i], mesh.indices[i + 1], mesh.indices[i + 2]);
    text += line;
  }
  text += "]}}\n";
  uLongf size = compressBound(text.size());
  std::vector<Bytef> packed(size);
  compress2(packed.data(), &size, reinterpret_cast<const Bytef*>(text.data()), text.size(), 9);
  return size + 12;  // gzip's header and trailer are that much larger than zlib's
}

class Studio {
 public:
  Studio() {
    auto opened = render::open_headless_context("auto");
    if (auto* context = std::get_if<std::unique_ptr<render::GlContext>>(&opened)) context_ = std::move(*context);
    if (!context_) return;
    auto created = render::Renderer::create(*context_);
    if (auto* renderer = std::get_if<std::unique_ptr<render::Renderer>>(&created)) renderer_ = std::move(*renderer);
  }
  [[nodiscard]] bool good() const { return renderer_ != nullptr; }

  std::vector<render::Image> pictures(const render::RenderList& list, const vrml::Bounds& bounds) {
    std::vector<render::Image> out;
    render::DrawOptions draw;
    draw.width = kWidth;
    draw.height = kHeight;
    draw.background = glm::vec3(0);
    for (const auto& view : kViews) {
      const render::Camera camera = render::fit_depth(
          render::orbit_camera(bounds, glm::radians(view[0]), glm::radians(view[1]), 0.785398f, kWidth, kHeight),
          bounds);
      auto drawn = renderer_->draw_to_image(list, camera, draw);
      if (auto* image = std::get_if<render::Image>(&drawn)) out.push_back(std::move(*image));
    }
    return out;
  }

 private:
  std::unique_ptr<render::GlContext> context_;
  std::unique_ptr<render::Renderer> renderer_;
};

struct Measured {
  std::size_t bytes = 0;
  PictureError error;
};
using Curve = std::map<std::size_t, Measured>;  // by budget

render::RenderList list_of(qnv::Cloud cloud) {
  render::RenderList list;
  render::SplatItem item;
  item.cloud = std::make_shared<const qnv::Cloud>(std::move(cloud));
  item.own_color = true;
  list.splats.push_back(std::move(item));
  return list;
}

Curve measure_stream(Studio& studio, const render::RenderList& full, const std::vector<render::Image>& references,
                     qnv::Payload payload, bool two_sided) {
  qnv::EncodeOptions options;
  options.payload = payload;
  options.two_sided = two_sided;
  options.max_bytes = kBudgets.back();
  const auto encoded =
      qnv::encode_surface([&](const qnv::TriangleSink& sink) { return app::for_each_triangle(full, sink); }, options);
  Curve curve;
  const auto* stream = std::get_if<qnv::EncodedStream>(&encoded);
  if (!stream) return curve;
  for (const std::size_t budget : kBudgets) {
    const std::size_t bytes = std::min(budget, stream->bytes.size());
    qnv::StreamDecoder decoder;
    decoder.push(std::span(stream->bytes).first(bytes));
    const auto pictures = studio.pictures(list_of(decoder.cloud()), full.bounds);
    if (pictures.size() == references.size()) curve[budget] = {bytes, bench::picture_error(pictures, references)};
  }
  return curve;
}

void keep_best(Curve& curve, std::size_t bytes, const PictureError& error) {
  for (const std::size_t budget : kBudgets)
    if (bytes <= budget && (!curve.contains(budget) || error.psnr > curve[budget].error.psnr))
      curve[budget] = {bytes, error};
}

void measure_meshes(Studio& studio, const render::RenderList& full, const std::vector<render::Image>& references,
                    Curve& draco, Curve& gzip) {
  const Mesh mesh = welded(full);
  const std::string base =
      (std::filesystem::temp_directory_path() / ("rate_distortion." + std::to_string(getpid()))).string();
  for (const double part : {0.0015, 0.003, 0.006, 0.01, 0.016, 0.025, 0.04, 0.07, 0.12, 0.2, 0.35, 0.6, 1.0}) {
    const Mesh small = simplified(mesh, part);
    if (small.indices.size() < 30) continue;
    write_obj(small, base + ".obj");
    for (const int bits : {7, 8, 9, 10, 11, 12, 14}) {
      if ((part < 0.01 && bits > 10) || (part > 0.1 && bits < 10)) continue;
      const std::string command = "draco_encoder -i " + base + ".obj -o " + base + ".drc -cl 10 -qp " +
                                  std::to_string(bits) + " >/dev/null 2>&1 && draco_decoder -i " + base + ".drc -o " +
                                  base + ".out.obj >/dev/null 2>&1";
      if (std::system(command.c_str()) != 0) continue;
      app::OpenedWorld world = app::load_world(base + ".out.obj");
      if (!world.scene) continue;
      render::MeshCache cache;
      const auto pictures = studio.pictures(render::collect(*world.scene, world.images, cache), full.bounds);
      if (pictures.size() != references.size()) continue;
      const PictureError error = bench::picture_error(pictures, references);
      keep_best(draco, std::filesystem::file_size(base + ".drc"), error);
      // Six digits of text are finer than any of these quantisations.
      if (bits == 14 || (part < 0.01 && bits == 10)) keep_best(gzip, gzip_vrml_bytes(small), error);
    }
  }
  for (const char* end : {".obj", ".drc", ".out.obj"}) std::filesystem::remove(base + end);
}

void plot(const std::string& path, const std::vector<std::pair<std::string, std::array<Curve, 4>>>& models) {
  constexpr std::array<const char*, 4> kColors{"#0066cc", "#66a3e0", "#cc3300", "#999999"};
  std::ofstream out(path);
  const int width = 420, height = 300, columns = 2;
  const int rows = static_cast<int>((models.size() + columns - 1) / columns);
  out << "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" << width * columns << "\" height=\"" << height * rows
      << "\" font-family=\"sans-serif\" font-size=\"11\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n";
  for (std::size_t m = 0; m < models.size(); ++m) {
    const int left = static_cast<int>(m) % columns * width + 45, top = static_cast<int>(m) / columns * height + 25;
    const auto x = [&](double bytes) { return left + (std::log10(bytes) - 3) / 3.3 * (width - 65); };
    const auto y = [&](double psnr) { return top + (1 - (psnr - 15) / 35) * (height - 60); };
    out << "<text x=\"" << left << "\" y=\"" << top - 8 << "\" font-weight=\"bold\">" << models[m].first << "</text>\n";
    for (int decibel = 15; decibel <= 50; decibel += 5)
      out << "<line x1=\"" << x(1e3) << "\" x2=\"" << x(2e6) << "\" y1=\"" << y(decibel) << "\" y2=\"" << y(decibel)
          << "\" stroke=\"#ddd\"/><text x=\"" << left - 5 << "\" y=\"" << y(decibel) + 4 << "\" text-anchor=\"end\">"
          << decibel << "</text>\n";
    for (const double bytes : {1e3, 1e4, 1e5, 1e6})
      out << "<text x=\"" << x(bytes) << "\" y=\"" << y(15) + 15 << "\" text-anchor=\"middle\">" << bytes / 1000
          << " kB</text>\n";
    for (std::size_t c = 0; c < 4; ++c) {
      out << "<polyline fill=\"none\" stroke-width=\"2\" stroke=\"" << kColors[c] << "\" points=\"";
      for (const auto& [budget, measured] : models[m].second[c])
        out << x(static_cast<double>(budget)) << ',' << y(std::clamp(measured.error.psnr, 15.0, 50.0)) << ' ';
      out << "\"/>\n<text x=\"" << x(2.2e5) << "\" y=\"" << y(28 - 3.0 * static_cast<double>(c)) << "\" fill=\""
          << kColors[c] << "\">" << kCodecs[c] << "</text>\n";
    }
  }
  out << "</svg>\n";
}

}  // namespace

int main(int count, char** arguments) {
  std::vector<std::string> files;
  std::string svg;
  for (int i = 1; i < count; ++i) {
    if (std::string(arguments[i]) == "--svg" && i + 1 < count)
      svg = arguments[++i];
    else
      files.emplace_back(arguments[i]);
  }
  if (files.empty()) {
    std::fprintf(stderr, "usage: rate_distortion MODEL... [--svg PLOT.svg]\n");
    return 2;
  }
  Studio studio;
  if (!studio.good()) {
    std::fprintf(stderr, "rate_distortion: no way to draw here\n");
    return 1;
  }
  std::vector<std::pair<std::string, std::array<Curve, 4>>> models;
  for (const std::string& file : files) {
    app::OpenedWorld world = app::load_world(file);
    if (!world.scene) {
      std::fprintf(stderr, "rate_distortion: %s cannot be opened\n", file.c_str());
      return 1;
    }
    render::MeshCache cache;
    const render::RenderList full = render::collect(*world.scene, world.images, cache);
    const app::SurfaceSummary summary = app::summarize_surface(full);
    const auto references = studio.pictures(full, full.bounds);
    std::array<Curve, 4> curves;
    curves[0] = measure_stream(studio, full, references, qnv::Payload::packed, summary.two_sided);
    curves[1] = measure_stream(studio, full, references, qnv::Payload::records, summary.two_sided);
    measure_meshes(studio, full, references, curves[2], curves[3]);
    const std::string name = std::filesystem::path(file).filename().string();
    std::printf("### %s (%zu triangles)\n\n| budget, bytes |", name.c_str(), summary.triangles);
    for (const char* codec : kCodecs) std::printf(" %s |", codec);
    std::printf("\n|---:|---:|---:|---:|---:|\n");
    for (const std::size_t budget : kBudgets) {
      std::printf("| %zu |", budget);
      for (const Curve& curve : curves) {
        const auto found = curve.find(budget);
        if (found == curve.end())
          std::printf(" - |");
        else
          std::printf(" %.1f / %.3f |", found->second.error.psnr, found->second.error.ssim);
      }
      std::printf("\n");
    }
    std::printf("\n");
    std::fflush(stdout);
    models.emplace_back(name, std::move(curves));
  }
  if (!svg.empty()) plot(svg, models);
  return 0;
}
