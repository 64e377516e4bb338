// Compares bytes with picture errors of textured models: QNV (`encode` with default options, displaced, octree) and a
// simplified mesh with texture coordinates in Draco with its reduced texture as JPEG.
//
//   textured_distortion [--streams-alone] MODEL...
//
// Prints a Markdown table per model: for every budget PSNR (dB) and SSIM against pictures of the full model from six
// sides, 800x600, headlight. A budget of a QNV stream is a prefix of one file. Mesh and texture need their own files
// per budget, the best of several simplifications, quantisations, sizes and qualities, with and without normals. A
// model has one Shape with one texture. Needs draco_encoder and draco_decoder in the PATH.
#include "app/encode/surface_triangles.h"
#include "app/encode/textured_surface.h"
#include "app/loading/world_loader.h"
#include "bench/shared/curve_table.h"
#include "bench/shared/picture_error.h"
#include "bench/shared/studio.h"
#include "qnv/codecs/payloads.h"
#include "qnv/codecs/shared/encode_options.h"
#include "qnv/reader/stream_decoder.h"
#include "render/image/image.h"

#include <meshoptimizer.h>

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
#include <utility>
#include <vector>

#include <jpeglib.h>

namespace {

using namespace gs;
using bench::list_of;
using bench::PictureError;
using bench::Studio;

constexpr std::array<std::size_t, 10> kBudgets{1000,   2000,   4000,    8000,    14'700,
                                               32'000, 64'000, 125'000, 250'000, 500'000};
constexpr std::array<bench::View, 6> kViews{{{0, 0}, {60, 20}, {120, -20}, {180, 0}, {240, 30}, {300, -10}}};
constexpr std::array<const char*, 4> kCodecs{"encode", "displaced", "packed", "Draco and JPEG"};

struct Measured {
  std::size_t bytes = 0;
  PictureError error;
};
using Curve = std::map<std::size_t, Measured>;  // by budget

/// Vertices of a textured mesh: position, texture coordinates, normal.
struct TexturedMesh {
  std::vector<std::array<float, 8>> vertices;
  std::vector<unsigned> indices;
};

TexturedMesh textured_mesh(const render::DrawItem& item) {
  TexturedMesh mesh;
  std::map<std::array<float, 8>, unsigned> seen;
  const vrml::Mesh& from = *item.mesh;
  const glm::dmat3 turned(item.world_from_node);
  for (const std::uint32_t i : from.indices) {
    const glm::vec3 p(item.world_from_node * glm::dvec4(from.positions[i], 1));
    const glm::vec2 t = from.texture_coordinates[i];
    glm::vec3 n(0);
    if (from.normals.size() == from.positions.size())
      n = glm::vec3(glm::normalize(turned * glm::dvec3(from.normals[i])));
    const std::array<float, 8> vertex{p.x, p.y, p.z, t.x, t.y, n.x, n.y, n.z};
    const auto [at, fresh] = seen.emplace(vertex, static_cast<unsigned>(mesh.vertices.size()));
    if (fresh) mesh.vertices.push_back(vertex);
    mesh.indices.push_back(at->second);
  }
  return mesh;
}

TexturedMesh simplified(const TexturedMesh& mesh, double part) {
  TexturedMesh out;
  out.indices.resize(mesh.indices.size());
  const auto target = static_cast<std::size_t>(static_cast<double>(mesh.indices.size()) * part) / 3 * 3;
  if (part < 1)
    out.indices.resize(meshopt_simplify(out.indices.data(), mesh.indices.data(), mesh.indices.size(),
                                        mesh.vertices.front().data(), mesh.vertices.size(), sizeof mesh.vertices[0],
                                        target, 1.0f, 0, nullptr));
  else
    out.indices = mesh.indices;
  std::map<unsigned, unsigned> places;
  for (unsigned& i : out.indices) {
    const auto [at, fresh] = places.emplace(i, static_cast<unsigned>(out.vertices.size()));
    if (fresh) out.vertices.push_back(mesh.vertices[i]);
    i = at->second;
  }
  return out;
}

void write_obj(const TexturedMesh& mesh, bool normals, const std::string& path) {
  std::ofstream out(path);
  char line[120];
  for (const auto& v : mesh.vertices) {
    std::snprintf(line, sizeof line, "v %.9g %.9g %.9g\nvt %.9g %.9g\n", v[0], v[1], v[2], v[3], v[4]);
    out << line;
    if (!normals) continue;
    std::snprintf(line, sizeof line, "vn %.6g %.6g %.6g\n", v[5], v[6], v[7]);
    out << line;
  }
  for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
    const std::string n = std::to_string(mesh.indices[i] + 1);
    out << (i % 3 == 0 ? "f " : " ") << n << '/' << n;
    if (normals) out << '/' << n;
    if (i % 3 == 2) out << '\n';
  }
}

/// Returns an image of the means of `by` x `by` pixels.
render::Image smaller(const render::Image& image, std::uint32_t by) {
  render::Image out;
  out.components = 3;
  out.width = std::max(1u, image.width / by);
  out.height = std::max(1u, image.height / by);
  for (std::uint32_t y = 0; y < out.height; ++y)
    for (std::uint32_t x = 0; x < out.width; ++x)
      for (std::uint32_t k = 0; k < 3; ++k) {
        std::size_t sum = 0, count = 0;
        for (std::uint32_t v = y * by; v < std::min((y + 1) * by, image.height); ++v)
          for (std::uint32_t u = x * by; u < std::min((x + 1) * by, image.width); ++u, ++count)
            sum += image.pixels[(std::size_t{v} * image.width + u) * image.components + (image.components < 3 ? 0 : k)];
        out.pixels.push_back(static_cast<std::uint8_t>((sum + count / 2) / count));
      }
  return out;
}

std::vector<std::byte> as_jpeg(const render::Image& image, int quality) {
  jpeg_compress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_compress(&jpeg);
  unsigned char* memory = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&jpeg, &memory, &size);
  jpeg.image_width = image.width;
  jpeg.image_height = image.height;
  jpeg.input_components = 3;
  jpeg.in_color_space = JCS_RGB;
  jpeg_set_defaults(&jpeg);
  jpeg_set_quality(&jpeg, quality, TRUE);
  jpeg.optimize_coding = TRUE;
  jpeg_start_compress(&jpeg, TRUE);
  while (jpeg.next_scanline < jpeg.image_height) {
    auto* row = const_cast<JSAMPROW>(image.pixels.data() + std::size_t{jpeg.next_scanline} * image.width * 3);
    jpeg_write_scanlines(&jpeg, &row, 1);
  }
  jpeg_finish_compress(&jpeg);
  const auto* first = reinterpret_cast<const std::byte*>(memory);
  std::vector<std::byte> bytes(first, first + size);
  jpeg_destroy_compress(&jpeg);
  std::free(memory);
  return bytes;
}

Curve measure_stream(Studio& studio, const render::RenderList& full, const std::vector<render::Image>& references,
                     qnv::Payload payload, bool two_sided, bool chosen) {
  qnv::EncodeOptions options;
  options.two_sided = two_sided;
  options.only_if_suited = chosen;
  options.exact_bits = qnv::kExactWherePays;
  if (const auto shine = app::summarize_surface(full).shine) options.metadata = render::metadata_of(*shine);
  const auto textured = app::textured_surface(full, glm::dvec3(0));
  if (textured) options.textured = &*textured;
  const qnv::TriangleSource source = [&](const qnv::TriangleSink& sink) { return app::for_each_triangle(full, sink); };
  auto encoded = qnv::row_of(payload).encode(std::cref(source), options, nullptr);
  if (const auto* problem = std::get_if<qnv::EncodeError>(&encoded); problem && problem->unsuited)
    encoded = qnv::row_of(qnv::Payload::packed).encode(std::cref(source), options, nullptr);
  Curve curve;
  const auto* stream = std::get_if<qnv::EncodedStream>(&encoded);
  if (!stream) return curve;
  std::fprintf(stderr, "%s: %zu bytes\n", std::string(qnv::row_of(stream->header.payload).name).c_str(),
               stream->bytes.size());
  for (const std::size_t budget : kBudgets) {
    const std::size_t bytes = std::min(budget, stream->bytes.size());
    qnv::StreamDecoder decoder;
    (void)decoder.push(std::span(stream->bytes).first(bytes));
    qnv::Geometry geometry = decoder.geometry();
    if (geometry.size() == 0) continue;
    const auto pictures = studio.pictures(list_of(std::move(geometry)), full.bounds, kViews);
    if (pictures.size() == references.size()) curve[budget] = {bytes, bench::picture_error(pictures, references)};
  }
  return curve;
}

/// Mesh or texture with its size in bytes.
template <class Content>
struct Candidate {
  std::size_t bytes = 0;
  Content content;
  double psnr = 0;
};

/// Keeps the candidates that are better than all smaller candidates.
template <class Content>
void keep_efficient(std::vector<Candidate<Content>>& all) {
  std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.bytes < b.bytes; });
  double best = 0;
  std::erase_if(all, [&](const auto& one) { return one.psnr <= std::exchange(best, std::max(best, one.psnr)); });
}

class DracoAndJpeg {
 public:
  DracoAndJpeg(Studio& studio, const render::RenderList& full, const render::DrawItem& item,
               const std::vector<render::Image>& references)
      : studio_(studio), full_(full), item_(item), references_(references) {}

  Curve measured() {
    std::vector<Candidate<render::RenderList>> meshes = all_meshes();
    std::vector<Candidate<std::shared_ptr<const render::Image>>> textures = all_textures();
    keep_efficient(meshes);
    keep_efficient(textures);
    Curve curve;
    for (const auto& mesh : meshes)
      for (const auto& texture : textures) {
        const std::size_t bytes = mesh.bytes + texture.bytes;
        if (bytes > kBudgets.back()) continue;
        const PictureError error = error_of(mesh.content, texture.content);
        for (const std::size_t budget : kBudgets)
          if (bytes <= budget && (!curve.contains(budget) || error.psnr > curve[budget].error.psnr))
            curve[budget] = {bytes, error};
      }
    return curve;
  }

 private:
  PictureError error_of(const render::RenderList& list, const std::shared_ptr<const render::Image>& texture) {
    render::RenderList dressed = list;
    for (render::DrawItem& item : dressed.items) {
      item.material = item_.material;
      item.texture = item_.texture;
      item.texture.image = texture;
    }
    const auto pictures = studio_.pictures(dressed, full_.bounds, kViews);
    return pictures.size() == references_.size() ? bench::picture_error(pictures, references_) : PictureError{};
  }

  std::vector<Candidate<render::RenderList>> all_meshes() {
    const std::string base =
        (std::filesystem::temp_directory_path() / ("textured_distortion." + std::to_string(getpid()))).string();
    const TexturedMesh whole = textured_mesh(item_);
    std::vector<Candidate<render::RenderList>> all;
    for (const double part : {0.02, 0.04, 0.08, 0.15, 0.3, 0.55, 1.0}) {
      const TexturedMesh small = simplified(whole, part);
      if (small.indices.size() < 30) continue;
      for (const int bits : {7, 9, 11})
        for (const bool normals : {false, true}) {
          write_obj(small, normals, base + ".obj");
          // One texel of 512 or 1024 suffices for coordinates, and an eighth of a degree for visible normals.
          const std::string command = "draco_encoder -i " + base + ".obj -o " + base + ".drc -cl 10 -qp " +
                                      std::to_string(bits) + " -qt " + std::to_string(std::min(bits + 1, 10)) +
                                      " -qn 7 >/dev/null 2>&1 && draco_decoder -i " + base + ".drc -o " + base +
                                      ".out.obj >/dev/null 2>&1";
          if (std::system(command.c_str()) != 0) continue;
          app::LoadedWorld world = app::load_world(base + ".out.obj");
          if (!world.scene) continue;
          render::MeshCache cache;
          Candidate<render::RenderList> one{std::filesystem::file_size(base + ".drc"),
                                            render::collect(*world.scene, world.images, cache)};
          one.psnr = error_of(one.content, item_.texture.image).psnr;
          all.push_back(std::move(one));
        }
    }
    for (const char* end : {".obj", ".drc", ".out.obj"}) std::filesystem::remove(base + end);
    return all;
  }

  std::vector<Candidate<std::shared_ptr<const render::Image>>> all_textures() {
    std::vector<Candidate<std::shared_ptr<const render::Image>>> all;
    for (const std::uint32_t by : {1u, 2u, 4u, 8u, 16u, 32u})
      for (const int quality : {20, 50, 75, 92}) {
        const std::vector<std::byte> bytes = as_jpeg(smaller(*item_.texture.image, by), quality);
        auto decoded = render::decode_image(bytes);
        if (!std::holds_alternative<render::Image>(decoded)) continue;
        auto image = std::make_shared<const render::Image>(std::move(std::get<render::Image>(decoded)));
        const double psnr = error_of(full_, image).psnr;
        all.push_back({bytes.size(), std::move(image), psnr});
      }
    return all;
  }

  Studio& studio_;
  const render::RenderList& full_;
  const render::DrawItem& item_;
  const std::vector<render::Image>& references_;
};

}  // namespace

int main(int count, char** arguments) {
  Studio studio;
  if (count < 2 || !studio.good()) {
    std::fprintf(stderr,
                 count < 2 ? "usage: textured_distortion [--streams-alone] MODEL...\n" : "no way to draw here\n");
    return 2;
  }
  bool others = true;
  for (int i = 1; i < count; ++i) {
    if (std::string(arguments[i]) == "--streams-alone") {
      others = false;
      continue;
    }
    app::LoadedWorld world = app::load_world(arguments[i]);
    render::MeshCache cache;
    const render::RenderList full =
        world.scene ? render::collect(*world.scene, world.images, cache) : render::RenderList{};
    const auto textured = [](const render::DrawItem& item) { return item.texture.image && app::has_surface(item); };
    const auto item = std::find_if(full.items.begin(), full.items.end(), textured);
    if (item == full.items.end()) {
      std::fprintf(stderr, "textured_distortion: %s has no texture\n", arguments[i]);
      return 1;
    }
    const app::SurfaceSummary summary = app::summarize_surface(full);
    const auto references = studio.pictures(full, full.bounds, kViews);
    std::array<Curve, kCodecs.size()> curves;
    if (others) curves[0] = measure_stream(studio, full, references, qnv::Payload::displaced, summary.two_sided, true);
    curves[1] = measure_stream(studio, full, references, qnv::Payload::displaced, summary.two_sided, false);
    if (others) curves[2] = measure_stream(studio, full, references, qnv::Payload::packed, summary.two_sided, false);
    if (others) curves[3] = DracoAndJpeg(studio, full, *item, references).measured();
    std::printf("### %s (%zu triangles, texture of %u x %u)\n\n",
                std::filesystem::path(arguments[i]).filename().c_str(), summary.triangles, item->texture.image->width,
                item->texture.image->height);
    bench::print_curve_table(kCodecs, kBudgets, curves);
    std::printf("\n");
    std::fflush(stdout);
  }
  return 0;
}
