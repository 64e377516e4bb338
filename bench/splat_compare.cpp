// splat_compare [--width W] [--height H] [--runs R] [--backend NAME]: compares the ways to draw QNV with the exact ray
// caster.
//
// Draws small geometries with one sample per pixel: surfaces with a headlight (diffuse, white without colours) on the
// processor, with OpenGL and by render/raycast; a volume by the renderer with its lighting. PSNR covers all components
// of all pixels, in 0..1 before rounding for surfaces, and in 8 bits for the volume. Splats per second count the whole
// geometry over the median of R runs; the ray caster runs once. Prints a Markdown table.

#include "bench/shared/open_gl.h"
#include "qnv/codecs/octree/encode/encode_surface.h"
#include "qnv/codecs/octree/lod/lod.h"
#include "qnv/codecs/shared/encode_options.h"
#include "render/draw/renderer.h"
#include "render/gl/context.h"
#include "render/gl/gl.h"
#include "render/scene/camera.h"
#include "render/splat/software/splat_kernel.h"
#include "render/splat/software/splat_raster.h"
#include "render/splat/splat_gl.h"
#include "render/splat/splat_pieces.h"
#include "tests/render/rays/raycast.h"

#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace gs::bench {
namespace {

constexpr float kPi = 3.14159265f;

struct Settings {
  int width = 320, height = 240, runs = 7;
  std::string backend = "auto";
};

void add(qnv::VectorArrays& geometry, const glm::vec3& position, const glm::vec3& normal, float weight) {
  geometry.positions.push_back(position);
  geometry.normals.push_back(normal);
  geometry.weights.push_back(weight);
  geometry.description.box.add(position);
}

/// Returns 1 + bumps of the sphere in direction n, and an outward vector of any length.
float bumpy_radius(const glm::vec3& n) {
  return 1 + 0.02f * (std::sin(20 * n.x) + std::sin(20 * n.y) + std::sin(20 * n.z));
}
glm::vec3 bumpy_outward(const glm::vec3& n) {
  const glm::vec3 slope = 0.4f * glm::vec3(std::cos(20 * n.x), std::cos(20 * n.y), std::cos(20 * n.z));
  return n - (slope - n * glm::dot(slope, n)) / bumpy_radius(n);
}

std::shared_ptr<qnv::Splats> bumpy_sphere(std::size_t count) {
  auto geometry = std::make_shared<qnv::Splats>();
  for (std::size_t i = 0; i < count; ++i) {
    const float z = 1 - 2 * (static_cast<float>(i) + 0.5f) / static_cast<float>(count);
    const auto angle = static_cast<float>(std::fmod(2.39996322972865332 * static_cast<double>(i), 6.28318530717958648));
    const float across = std::sqrt(1 - z * z);
    const glm::vec3 n(across * std::cos(angle), across * std::sin(angle), z), outward = bumpy_outward(n);
    add(*geometry, n * bumpy_radius(n), outward / glm::length(outward),
        4 * kPi / static_cast<float>(count) * glm::length(outward));
  }
  return geometry;
}

std::shared_ptr<qnv::Splats> colored_torus(std::size_t count) {
  constexpr float kAround = 0.8f, kTube = 0.35f;
  auto geometry = std::make_shared<qnv::Splats>();
  // The vectors are spread evenly over the area, which grows outwards.
  std::mt19937 random(3);
  std::uniform_real_distribution<float> part(0, 1);
  const float area = 4 * kPi * kPi * kAround * kTube / static_cast<float>(count);
  for (std::size_t i = 0; geometry->size() < count; ++i) {
    const auto turn = static_cast<float>(std::fmod(0.618033988749894848 * static_cast<double>(i), 1.0)) * 2 * kPi;
    const float roll = part(random) * 2 * kPi;
    if (part(random) * (kAround + kTube) > kAround + kTube * std::cos(roll)) continue;
    const glm::vec3 out(std::cos(turn), 0, std::sin(turn)), n = out * std::cos(roll) + glm::vec3(0, std::sin(roll), 0);
    add(*geometry, out * kAround + n * kTube, n, area);
    const auto level = [](float v) { return static_cast<std::uint8_t>(std::lround((v * 0.5f + 0.5f) * 255)); };
    geometry->colors.push_back(
        {level(std::sin(3 * turn)), level(std::cos(2 * roll)), level(std::cos(5 * turn + roll))});
  }
  return geometry;
}

/// Encodes triangles of the bumpy sphere as an octree, and returns a view's cut of that stream.
std::shared_ptr<const qnv::Geometry> packed_stream(std::size_t vectors) {
  constexpr int kRows = 200;
  std::vector<qnv::Triangle> triangles;
  const auto corner = [](int row, int column) {
    const float theta = kPi * static_cast<float>(row) / kRows, phi = kPi * static_cast<float>(column) / kRows;
    return glm::vec3(std::sin(theta) * std::cos(phi), std::cos(theta), -std::sin(theta) * std::sin(phi));
  };
  const auto put = [&](const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    qnv::Triangle triangle;
    triangle.positions = {a * bumpy_radius(a), b * bumpy_radius(b), c * bumpy_radius(c)};
    triangle.normals = {glm::normalize(bumpy_outward(a)), glm::normalize(bumpy_outward(b)),
                        glm::normalize(bumpy_outward(c))};
    triangles.push_back(triangle);
  };
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < 2 * kRows; ++column) {
      if (row + 1 < kRows) put(corner(row, column), corner(row + 1, column), corner(row + 1, column + 1));
      if (row > 0) put(corner(row, column), corner(row + 1, column + 1), corner(row, column + 1));
    }
  qnv::EncodeOptions options;
  options.vectors = vectors;
  auto encoded =
      qnv::encode_surface([&](const qnv::TriangleSink& sink) { return sink(std::span(triangles)); }, options);
  auto* stream = std::get_if<qnv::EncodedStream>(&encoded);
  if (!stream) return nullptr;
  auto opened = qnv::LodStream::open(std::move(stream->bytes));
  auto* levels = std::get_if<std::unique_ptr<qnv::LodStream>>(&opened);
  if (!levels) return nullptr;
  return std::make_shared<const qnv::Geometry>(qnv::OctreeSplats(std::move(*levels)));
}

/// Returns a thick spherical shell of vectors with all magnitudes and classes.
std::shared_ptr<qnv::Volume> volume(std::size_t count) {
  std::mt19937 random(7);
  std::normal_distribution<float> normal;
  std::uniform_real_distribution<float> part(0, 1);
  const auto direction = [&] {
    return glm::normalize(glm::vec3(normal(random), normal(random), normal(random)) + 1e-6f);
  };
  auto geometry = std::make_shared<qnv::Volume>();
  geometry->description.spacing = 0.05f;
  geometry->description.transfer = {{0, {255, 60, 20}, 0.02f}, {0.5f, {60, 230, 90}, 0.3f}, {1, {240, 240, 255}, 0.9f}};
  for (std::size_t i = 0; i < count; ++i) {
    add(*geometry, direction() * (0.7f + 0.3f * part(random)), direction(), 0.1f + part(random));
    geometry->classes.push_back(static_cast<std::uint8_t>(random() % 256));
  }
  return geometry;
}

/// RGB, 0..1.
using Picture = std::vector<double>;

double psnr(const Picture& a, const Picture& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return 10 * std::log10(static_cast<double>(a.size()) / std::max(sum, 1e-12));
}

Picture shaded(const render::SplatLayer& layer, const render::SplatView& view) {
  Picture picture(3 * static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height));
  for (int y = 0; y < layer.height; ++y)
    for (int x = 0; x < layer.width; ++x) {
      const auto from =
          4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(layer.width) + static_cast<std::size_t>(x));
      const auto to = 3 * (static_cast<std::size_t>(y + layer.y) * static_cast<std::size_t>(view.width) +
                           static_cast<std::size_t>(x + layer.x));
      const std::uint16_t* n = &layer.normals[from];
      const double light = std::max(n[2] / 32767.5 - 1, 0.0) * n[3] / 65535.0;
      for (std::size_t c = 0; c < 3; ++c)
        picture[to + c] = light * (layer.colors.empty() ? 1.0 : layer.colors[from + c] / 255.0);
    }
  return picture;
}

Picture shaded(const render::RaySurface& exact, bool colored) {
  Picture picture(3 * exact.normal.size());
  for (std::size_t i = 0; i < exact.normal.size(); ++i)
    for (int c = 0; c < 3; ++c)
      picture[3 * i + static_cast<std::size_t>(c)] = std::max(static_cast<double>(exact.normal[i].z), 0.0) *
                                                     static_cast<double>(exact.normal[i].w) *
                                                     (colored ? static_cast<double>(exact.color[i][c]) : 1.0);
  return picture;
}

Picture of_image(const render::Image& image) {
  Picture picture;
  for (std::uint32_t y = image.height; y-- > 0;)
    for (std::size_t i = 0; i < std::size_t{image.width} * 3; ++i)
      picture.push_back(image.pixels[std::size_t{y} * image.width * 3 + i] / 255.0);
  return picture;
}

double seconds(const std::function<void()>& work, int runs) {
  std::vector<double> times;
  work();  // uploads, and compiles the programs
  for (int i = 0; i < runs; ++i) {
    const auto start = std::chrono::steady_clock::now();
    work();
    times.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  std::sort(times.begin(), times.end());
  return times[times.size() / 2];
}

struct Result {
  Picture processor, opengl, oracle;
  double processor_seconds = 0, opengl_seconds = 0, oracle_seconds = 0;
};

void print(const std::string& name, std::size_t discs, const Result& r) {
  const auto rate = [&](double time) { return static_cast<double>(discs) / time / 1e6; };
  std::printf("| %s | %zu | %.1f | %.1f | %.1f | %.2f | %.3f | %.4f |\n", name.c_str(), discs,
              psnr(r.processor, r.oracle), psnr(r.opengl, r.oracle), psnr(r.processor, r.opengl),
              rate(r.processor_seconds), rate(r.opengl_seconds), rate(r.oracle_seconds));
  std::fflush(stdout);
}

render::SplatView view_of(const Settings& settings) {
  render::SplatView view;
  view.camera_from_node = glm::lookAt(glm::vec3(0.8f, 1.2f, 2.4f), glm::vec3(0), glm::vec3(0, 1, 0));
  view.tangents = {0.5f * static_cast<float>(settings.width) / static_cast<float>(settings.height), 0.5f};
  view.width = settings.width;
  view.height = settings.height;
  view.near_plane = 0.1f;
  return view;
}

/// Copies all pieces into one list for the ray caster.
qnv::Splats together(std::span<const render::SharedSplatPiece> pieces) {
  qnv::Splats all;
  if (!pieces.empty()) all.description = pieces.front().splats->description;
  for (const render::SharedSplatPiece& piece : pieces) {
    const auto append = [&piece](const auto& from, auto& to) {
      if (from.empty()) return;
      const auto first = from.begin() + static_cast<std::ptrdiff_t>(piece.first);
      to.insert(to.end(), first, first + static_cast<std::ptrdiff_t>(piece.count));
    };
    append(piece.splats->positions, all.positions);
    append(piece.splats->normals, all.normals);
    append(piece.splats->weights, all.weights);
    append(piece.splats->colors, all.colors);
    append(piece.splats->cells, all.cells);
  }
  return all;
}

/// Compares the ways to draw a surface. OpenGL draws `pieces`.
bool compare_surface(const std::string& name, const std::vector<render::SharedSplatPiece>& shared,
                     render::SplatGl& splats, const std::function<std::optional<render::SplatTextures>()>& by_opengl,
                     const render::Gl& gl, const Settings& settings) {
  const render::SplatView view = view_of(settings);
  std::vector<render::SplatPiece> pieces;
  for (const auto& p : shared) pieces.push_back({p.splats.get(), p.first, p.count, p.growth, p.tint});
  const qnv::Splats all = together(shared);
  const render::SplatPiece whole{&all, 0, all.size()};
  const bool smooth = render::measure_surface(std::span(&whole, 1), view, all.size()).smooth;
  Result result;
  render::SplatLayer layer;
  result.processor_seconds = seconds([&] { layer = render::rasterize_surface(pieces, view); }, settings.runs);
  result.processor = shaded(layer, view);
  std::optional<render::SplatTextures> drawn;
  result.opengl_seconds = seconds(
      [&] {
        drawn = by_opengl();
        gl.Finish();
      },
      settings.runs);
  if (!drawn || drawn->normals == 0) return false;
  result.opengl = shaded(splats.read(*drawn, view), view);
  render::RaySurface exact;
  const auto start = std::chrono::steady_clock::now();
  exact = render::raycast_surface(all, view, smooth);
  result.oracle_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  result.oracle = shaded(exact, !all.colors.empty());
  print(name, all.size(), result);
  return true;
}

bool compare_volume(const std::shared_ptr<const qnv::Geometry>& geometry, render::GlContext& context,
                    const Settings& settings) {
  auto made = render::Renderer::create(context);
  auto* renderer = std::get_if<std::unique_ptr<render::Renderer>>(&made);
  if (!renderer) return false;
  render::RenderList list;
  render::SplatItem item;
  item.geometry = geometry;
  list.splats.push_back(item);
  list.bounds.add(geometry->description().box.lower);
  list.bounds.add(geometry->description().box.upper);
  render::SplatView view = view_of(settings);
  render::Camera camera;
  camera.world_from_camera = glm::inverse(view.camera_from_node);
  camera.field_of_view = 2 * std::atan(view.tangents.y);
  render::DrawOptions options;
  options.width = settings.width;
  options.height = settings.height;
  options.samples = 1;
  options.background = glm::vec3(0);
  Result result;
  bool good = true;
  const auto draw = [&](render::SplatPath path, Picture& picture) {
    options.splats = path;
    render::Image image;
    render::FrameStatistics statistics;
    const double time = seconds(
        [&] {
          auto drawn = (*renderer)->draw_to_image(list, camera, options, &statistics);
          // Draws again until the vectors are sorted for this view.
          while (statistics.pending && std::holds_alternative<render::Image>(drawn))
            drawn = (*renderer)->draw_to_image(list, camera, options, &statistics);
          if (auto* got = std::get_if<render::Image>(&drawn)) image = std::move(*got);
        },
        settings.runs);
    picture = of_image(image);
    good =
        good && !image.empty() && std::string_view(statistics.splats) == (path == render::SplatPath::gl ? "gl" : "cpu");
    return time;
  };
  result.processor_seconds = draw(render::SplatPath::cpu, result.processor);
  result.opengl_seconds = draw(render::SplatPath::gl, result.opengl);
  const auto start = std::chrono::steady_clock::now();
  const render::RayImage exact = render::raycast_volume(*geometry->as<qnv::Volume>(), view, {});
  result.oracle_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  for (const glm::vec4& c : exact.color)
    for (int k = 0; k < 3; ++k) result.oracle.push_back(static_cast<double>(c[k]));
  if (!good || result.oracle.size() != result.processor.size()) return false;
  print("volume, a thick shell", geometry->size(), result);
  return true;
}

int run(const Settings& settings) {
  const OpenGl opened(settings.backend);
  if (!opened.context) return 1;
  const render::Gl& gl = opened.gl;
  render::SplatGl splats(gl);
  std::printf("%dx%d, 1 sample a pixel; processor: %s; OpenGL: %s; medians of %d\n\n", settings.width, settings.height,
              std::string(render::splat_kernels().front().name).c_str(), gl.renderer.c_str(), settings.runs);
  std::printf(
      "| geometry | vectors | processor, oracle (dB) | OpenGL, oracle (dB) | processor, OpenGL (dB) | processor M/s |"
      " OpenGL M/s | oracle M/s |\n| --- | --: | --: | --: | --: | --: | --: | --: |\n");
  bool good = true;
  const auto surface = [&](const std::string& name, const std::vector<render::SharedSplatPiece>& pieces) {
    return compare_surface(
        name, pieces, splats, [&] { return splats.draw(pieces, view_of(settings)); }, gl, settings);
  };
  const std::shared_ptr<const qnv::Splats> sphere = bumpy_sphere(20000), torus = colored_torus(20000);
  good = surface("bumpy sphere", {{sphere, 0, sphere->size()}}) && good;
  good = surface("coloured torus", {{torus, 0, torus->size()}}) && good;
  const auto stream = packed_stream(100'000);
  render::CutOptions cut;
  cut.budget = 20000;
  good = stream && surface("cut of a packed stream", render::cut_splats(stream, view_of(settings), cut).pieces) && good;
  good = compare_volume(std::make_shared<const qnv::Geometry>(*volume(20000)), *opened.context, settings) && good;
  if (!good) std::fprintf(stderr, "not all could be drawn\n");
  return good ? 0 : 1;
}

}  // namespace
}  // namespace gs::bench

int main(int argc, char** argv) {
  gs::bench::Settings settings;
  const auto number = [](const char* text) { return std::clamp(std::atoi(text), 1, 8192); };
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    if (argument == "--width" && i + 1 < argc) {
      settings.width = number(argv[++i]);
    } else if (argument == "--height" && i + 1 < argc) {
      settings.height = number(argv[++i]);
    } else if (argument == "--runs" && i + 1 < argc) {
      settings.runs = number(argv[++i]);
    } else if (argument == "--backend" && i + 1 < argc) {
      settings.backend = argv[++i];
    } else {
      std::fprintf(stderr, "usage: splat_compare [--width W] [--height H] [--runs R] [--backend auto|egl|osmesa]\n");
      return 2;
    }
  }
  return gs::bench::run(settings);
}
