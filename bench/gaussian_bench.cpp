// Measures Gaussian splats: `gaussian_bench [--size WxH] [--threads N] [--runs N] [--copies N] [--backend NAME
// [--samples N] [--path cpu]] [--error E] FILE...`. Prints for each file the number of splats, and median and minimum
// times of a picture (1024x768) over a turn around the model, on the CPU. With a backend, draws by the renderer, with
// OpenGL and on the CPU. First the eye moves around the model, so that OpenGL sorts for each picture. Then the eye
// looks around from one position, so that the order stays. Also prints the PSNR between both paths. `--path cpu` omits
// OpenGL.
// `--copies` puts copies of the splats beside each other. `--error E` draws cuts with an error of E pixels.
#include "app/loading/world_loader.h"
#include "bench/shared/open_gl.h"
#include "qnv/codecs/gaussians/encode/gaussians_stream.h"
#include "qnv/codecs/gaussians/lod/splat_stream.h"
#include "render/collection/render_scene.h"
#include "render/draw/renderer.h"
#include "render/gaussians/gaussian_raster.h"
#include "render/splat/splat_pieces.h"

#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace {

using namespace gs;

struct Setting {
  render::SplatView view;
  int runs = 24, samples = 4;
  std::size_t copies = 1;
  std::string backend;
  bool only_cpu = false;
  float error = 0;  // of cuts, in pixels; 0 means all Gaussians
};

/// Returns copies of splats, in a grid of squares on the plane y = 0.
std::shared_ptr<const qnv::Gaussians> copied(const qnv::Gaussians& one, std::size_t copies) {
  auto made = std::make_shared<qnv::Gaussians>(one);
  const glm::vec3 size = one.description.box.size();
  const auto side = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(copies))));
  for (std::size_t i = 1; i < copies; ++i) {
    const glm::vec3 move(size.x * static_cast<float>(i % side), 0, size.z * static_cast<float>(i / side));
    for (const glm::vec3& position : one.positions) made->positions.push_back(position + move);
    const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
    append(made->normals, one.normals);
    append(made->weights, one.weights);
    append(made->colors, one.colors);
    append(made->scales, one.scales);
    append(made->rotations, one.rotations);
    append(made->opacities, one.opacities);
    append(made->bases, one.bases);
    append(made->harmonics, one.harmonics);
    made->description.box.add(one.description.box.upper + move);
  }
  return made;
}

/// Turn around a model, in its own space.
struct Orbit {
  glm::vec3 middle;
  float radius;

  [[nodiscard]] glm::vec3 eye(float turn) const {
    return middle + radius * glm::vec3(std::sin(turn), 0.2f, std::cos(turn));
  }
};

Orbit orbit_of(const qnv::Gaussians& gaussians) {
  const glm::vec3 low = gaussians.description.box.lower, size = gaussians.description.box.size();
  const glm::vec3 middle = low + size * 0.5f;
  // Outliers enlarge the box. The median distance from the middle gives the size of the model.
  std::vector<float> distances;
  for (const glm::vec3& p : gaussians.positions) distances.push_back(glm::length(p - middle));
  std::ranges::nth_element(distances, distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2));
  return {middle, 3.5f * distances[distances.size() / 2]};
}

struct Times {
  double median, least;
};

/// Returns the milliseconds of `draw(turn)` for turns from 0 to `most` radians. The first call is not counted.
template <class Draw>
Times times_of(int runs, float most, const Draw& draw) {
  std::vector<double> times;
  for (int run = 0; run <= runs; ++run) {
    const auto start = std::chrono::steady_clock::now();
    draw(most * static_cast<float>(run) / static_cast<float>(runs));
    const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - start;
    if (run > 0) times.push_back(time.count());
  }
  std::ranges::sort(times);
  return {times[static_cast<std::size_t>(runs / 2)], times.front()};
}

constexpr float kWholeTurn = 6.2831853f;

void measure_cpu(const std::string& name, const qnv::Gaussians& gaussians, const Setting& setting) {
  const Orbit orbit = orbit_of(gaussians);
  double seen = 0;
  const auto [median, least] = times_of(setting.runs, kWholeTurn, [&](float turn) {
    render::GaussianItem item;
    item.gaussians = &gaussians;
    item.count = gaussians.size();
    item.camera_from_node = glm::lookAt(orbit.eye(turn), orbit.middle, glm::vec3(0, 1, 0));
    const render::VolumeLayer layer = render::rasterize_gaussians({&item, 1}, setting.view, {}, false);
    if (turn > 0) seen += static_cast<double>(layer.vectors) / setting.runs;
  });
  std::printf("| %s | %zu | %.0f | %.1f | %.1f | %.1f |\n", name.c_str(), gaussians.size(), seen, median, least,
              seen / median / 1000);
}

double decibels(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size() && i < b.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  const double mean = sum / static_cast<double>(std::max<std::size_t>(a.size(), 1));
  return mean > 0 ? 10 * std::log10(255.0 * 255.0 / mean) : std::numeric_limits<double>::infinity();
}

/// Measures cuts of a stream of the Gaussians, as they are drawn while the view moves.
void measure_cuts(const std::string& name, const qnv::Gaussians& gaussians, const Setting& setting) {
  const Orbit orbit = orbit_of(gaussians);
  const auto start = std::chrono::steady_clock::now();
  const auto encoded = qnv::encode_gaussians(gaussians, {});
  const auto* bytes = std::get_if<qnv::EncodedStream>(&encoded);
  if (!bytes) return;
  auto opened = qnv::SplatStream::open(bytes->bytes);
  auto* stream = std::get_if<std::unique_ptr<qnv::SplatStream>>(&opened);
  if (!stream) return;
  const std::chrono::duration<double> encoding = std::chrono::steady_clock::now() - start;
  render::SplatView view = setting.view;
  render::GaussianItem item;
  std::vector<render::GaussianItem> items;
  const auto cut = [&](float turn) {
    view.camera_from_node = item.camera_from_node = glm::lookAt(orbit.eye(turn), orbit.middle, glm::vec3(0, 1, 0));
    auto lod = render::lod_view(view);
    items.clear();
    if (!lod) return;
    lod->error_pixels = setting.error;
    for (const qnv::SplatRun& run : (*stream)->cut(*lod)) {
      item.gaussians = run.splats.get();
      item.first = run.first;
      item.count = run.count;
      items.push_back(item);
    }
  };
  (void)times_of(setting.runs, kWholeTurn, cut);  // decodes
  const Times cutting = times_of(setting.runs, kWholeTurn, cut);
  double drawn = 0, psnr = 0;
  const Times all = times_of(setting.runs, kWholeTurn, [&](float turn) {
    cut(turn);
    const render::VolumeLayer layer = render::rasterize_gaussians(items, view, {}, false);
    if (turn > 0) drawn += static_cast<double>(layer.vectors) / setting.runs;
  });
  for (int run = 1; run <= setting.runs; ++run) {
    cut(kWholeTurn * static_cast<float>(run) / static_cast<float>(setting.runs));
    const render::VolumeLayer coarse = render::rasterize_gaussians(items, view, {}, false);
    item.gaussians = &gaussians;
    item.first = 0;
    item.count = gaussians.size();
    const render::VolumeLayer whole = render::rasterize_gaussians({&item, 1}, view, {}, false);
    psnr += decibels(coarse.pixels, whole.pixels) / setting.runs;
  }
  std::printf("| %s, error of %.1f pixels | %zu | %.0f | %.1f | %.1f | cut %.1f, encoded in %.1f s, %.1f dB |\n",
              name.c_str(), static_cast<double>(setting.error), gaussians.size(), drawn, all.median, all.least,
              cutting.median, encoding.count(), psnr);
}

void measure_renderer(const std::string& name, const render::SplatItem& item, const Setting& setting,
                      render::Renderer& renderer, const render::Gl& gl) {
  const auto& gaussians = *item.geometry->as<qnv::Gaussians>();
  const Orbit orbit = orbit_of(gaussians);
  render::RenderList list;
  list.splats.push_back(item);
  list.splats[0].world_from_node = glm::dmat4(1);
  for (const glm::vec3& corner : {orbit.middle - 4 * orbit.radius, orbit.middle + 4 * orbit.radius})
    list.bounds.add(corner);
  render::DrawOptions options;
  options.width = setting.view.width;
  options.height = setting.view.height;
  options.samples = setting.samples;
  options.background = glm::vec3(0);
  render::Camera camera;
  camera.field_of_view = 2 * std::atan(setting.view.tangents.y);
  render::FrameStatistics statistics;
  const auto draw = [&](const glm::vec3& eye, const glm::vec3& at) {
    camera.world_from_camera = glm::inverse(glm::dmat4(glm::lookAt(eye, at, glm::vec3(0, 1, 0))));
    statistics = renderer.draw(list, camera, options);
    gl.Finish();
  };
  const auto around = [&](float turn) { draw(orbit.eye(turn), orbit.middle); };
  const glm::vec3 place = orbit.eye(0);
  const auto looking = [&](float turn) { draw(place, orbit.middle + orbit.radius * glm::vec3(turn, 0, 0)); };
  std::string row;
  std::optional<render::Image> images[2];
  for (const render::SplatPath path : {render::SplatPath::gl, render::SplatPath::cpu}) {
    options.splats = path;
    const bool by_gl = path == render::SplatPath::gl;
    if (setting.only_cpu && by_gl) continue;
    const int runs = by_gl || setting.only_cpu ? setting.runs : std::max(setting.runs / 4, 3);
    const auto start = std::chrono::steady_clock::now();
    around(0);
    const std::chrono::duration<double, std::milli> first = std::chrono::steady_clock::now() - start;
    const Times moving = times_of(runs, kWholeTurn, around), turning = times_of(runs, 0.3f, looking);
    char text[128];
    std::snprintf(text, sizeof text, " %s | %.0f | %.2f | %.2f | %.2f | %.2f |", statistics.splats, first.count(),
                  moving.median, moving.least, turning.median, turning.least);
    row += text;
    around(0);
    auto image = renderer.draw_to_image(list, camera, options, &statistics);
    if (auto* drawn = std::get_if<render::Image>(&image)) images[by_gl ? 0 : 1] = std::move(*drawn);
  }
  std::printf("| %s | %zu |%s %.1f |\n", name.c_str(), gaussians.size(), row.c_str(),
              images[0] && images[1] ? decibels(images[0]->pixels, images[1]->pixels) : 0.0);
}

bool measure(const std::string& file, const Setting& setting, render::Renderer* renderer, const render::Gl* gl) {
  const app::LoadedWorld world = app::load_world(file);
  if (!world.scene) return false;
  render::MeshCache cache;
  const render::RenderList list =
      render::collect(*world.scene, world.images, cache, glm::vec3(0, 0, 10), world.geometries);
  for (render::SplatItem item : list.splats) {
    const auto* gaussians = item.geometry ? item.geometry->as<qnv::Gaussians>() : nullptr;
    if (!gaussians) continue;
    if (setting.copies > 1) item.geometry = std::make_shared<const qnv::Geometry>(*copied(*gaussians, setting.copies));
    const std::string name = file.substr(file.rfind('/') + 1);
    if (renderer)
      measure_renderer(name, item, setting, *renderer, *gl);
    else
      (setting.error > 0 ? measure_cuts : measure_cpu)(name, *item.geometry->as<qnv::Gaussians>(), setting);
    std::fflush(stdout);
    return true;
  }
  return false;
}

}  // namespace

int main(int count, char** arguments) {
  Setting setting;
  render::SplatView& view = setting.view;
  view.width = 1024;
  view.height = 768;
  int first = 1;
  for (; first + 1 < count && arguments[first][0] == '-'; first += 2) {
    const char* const value = arguments[first + 1];
    const std::string_view name = arguments[first];
    if (name == "--runs") setting.runs = std::max(1, std::atoi(value));
    if (name == "--threads") view.threads = static_cast<unsigned>(std::atoi(value));
    if (name == "--copies") setting.copies = static_cast<std::size_t>(std::max(1, std::atoi(value)));
    if (name == "--samples") setting.samples = std::max(1, std::atoi(value));
    if (name == "--error") setting.error = static_cast<float>(std::atof(value));
    if (name == "--path") setting.only_cpu = std::string_view(value) == "cpu";
    if (name == "--backend") setting.backend = value;
    if (name == "--size") (void)std::sscanf(value, "%dx%d", &view.width, &view.height);
  }
  if (first >= count) {
    std::fprintf(stderr,
                 "usage: gaussian_bench [--size WxH] [--threads N] [--runs N] [--copies N] [--backend NAME [--samples "
                 "N] [--path cpu]] [--error E] FILE...\n");
    return 2;
  }
  view.tangents = {0.55f, 0.55f * static_cast<float>(view.height) / static_cast<float>(view.width)};
  view.near_plane = 0.01f;
  std::optional<bench::OpenGl> opened;
  std::unique_ptr<render::Renderer> renderer;
  if (!setting.backend.empty()) {
    opened.emplace(setting.backend);
    if (!opened->context) return 1;
    auto created = render::Renderer::create(*opened->context);
    if (auto* error = std::get_if<render::ContextError>(&created)) return std::fputs(error->message.c_str(), stderr), 1;
    renderer = std::move(std::get<std::unique_ptr<render::Renderer>>(created));
    std::printf("%s, %dx%d, %d samples\n", opened->gl.renderer.c_str(), view.width, view.height, setting.samples);
    const int paths = setting.only_cpu ? 1 : 2;
    std::printf("| file | splats |");
    for (int i = 0; i < paths; ++i) std::printf(" path | first, ms | around, ms | least | looking, ms | least |");
    std::printf(" PSNR |\n|---|--:|");
    for (int i = 0; i < paths; ++i) std::printf("---|--:|--:|--:|--:|--:|");
    std::printf("--:|\n");
  } else {
    std::printf("| file | splats | in view | ms a picture | least | M splats/s |\n|---|--:|--:|--:|--:|--:|\n");
  }
  for (int i = first; i < count; ++i)
    if (!measure(arguments[i], setting, renderer.get(), opened ? &opened->gl : nullptr)) {
      std::fprintf(stderr, "gaussian_bench: %s has no Gaussian splats\n", arguments[i]);
      return 1;
    }
  return 0;
}
