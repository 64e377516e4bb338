// Measures Gaussian splats on the CPU: `gaussian_bench [--size WxH] [--threads N] [--runs N] FILE...` prints for each
// file of splats the number of splats, those in view, the median milliseconds of a picture (1024x768) over a turn
// around the model, and splats per second.
#include "app/loading/world_loader.h"
#include "render/collection/render_scene.h"
#include "render/gaussians/gaussian_raster.h"

#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

namespace {

using namespace gs;

bool measure(const std::string& file, render::SplatView view, int runs) {
  const app::LoadedWorld world = app::load_world(file);
  if (!world.scene) return false;
  render::MeshCache cache;
  const render::RenderList list =
      render::collect(*world.scene, world.images, cache, glm::vec3(0, 0, 10), world.geometries);
  for (const render::SplatItem& splats : list.splats) {
    const auto* gaussians = splats.geometry ? splats.geometry->as<qnv::Gaussians>() : nullptr;
    if (!gaussians) continue;
    const glm::vec3 low = gaussians->description.box.lower, size = gaussians->description.box.size();
    const glm::vec3 middle = low + size * 0.5f;
    // Outliers enlarge the box. The median distance from the middle gives the size of the model.
    std::vector<float> distances;
    for (const glm::vec3& p : gaussians->positions) distances.push_back(glm::length(p - middle));
    std::ranges::nth_element(distances, distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2));
    const float radius = 3.5f * distances[distances.size() / 2];
    std::vector<double> times;
    double seen = 0;
    for (int run = 0; run <= runs; ++run) {
      const float turn = 6.2831853f * static_cast<float>(run) / static_cast<float>(runs);
      render::GaussianItem item;
      item.gaussians = gaussians;
      item.count = gaussians->size();
      item.camera_from_node =
          glm::lookAt(middle + radius * glm::vec3(std::sin(turn), 0.2f, std::cos(turn)), middle, glm::vec3(0, 1, 0));
      const auto start = std::chrono::steady_clock::now();
      const render::VolumeLayer layer = render::rasterize_gaussians({&item, 1}, view);
      const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - start;
      if (run == 0) continue;
      times.push_back(time.count());
      seen += static_cast<double>(layer.vectors) / runs;
    }
    std::ranges::nth_element(times, times.begin() + runs / 2);
    const double median = times[static_cast<std::size_t>(runs / 2)];
    std::printf("| %s | %zu | %.0f | %.1f | %.1f |\n", file.substr(file.rfind('/') + 1).c_str(), gaussians->size(),
                seen, median, seen / median / 1000);
    std::fflush(stdout);
    return true;
  }
  return false;
}

}  // namespace

int main(int count, char** arguments) {
  render::SplatView view;
  view.width = 1024;
  view.height = 768;
  int runs = 24, first = 1;
  for (; first + 1 < count && arguments[first][0] == '-'; first += 2) {
    const char* const value = arguments[first + 1];
    if (std::strcmp(arguments[first], "--runs") == 0)
      runs = std::max(1, std::atoi(value));
    else if (std::strcmp(arguments[first], "--threads") == 0)
      view.threads = static_cast<unsigned>(std::atoi(value));
    else
      (void)std::sscanf(value, "%dx%d", &view.width, &view.height);
  }
  if (first >= count) {
    std::fprintf(stderr, "usage: gaussian_bench [--size WxH] [--threads N] [--runs N] FILE...\n");
    return 2;
  }
  view.tangents = {0.55f, 0.55f * static_cast<float>(view.height) / static_cast<float>(view.width)};
  view.near_plane = 0.01f;
  std::printf("| file | splats | in view | ms a picture | M splats/s |\n|---|--:|--:|--:|--:|\n");
  for (int i = first; i < count; ++i)
    if (!measure(arguments[i], view, runs)) {
      std::fprintf(stderr, "gaussian_bench: %s has no Gaussian splats\n", arguments[i]);
      return 1;
    }
  return 0;
}
