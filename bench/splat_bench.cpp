// splat_bench [--discs N] [--runs R] [--backend NAME]: measures splatting of surfaces on the processor and with OpenGL.
//
// Draws N small splats of a bumpy sphere at 1024x768 with one and four samples per pixel, unshaded. Each of R rounds
// runs in sequence: the processor with one and two threads and with each vector instruction set; a plain sum over the
// same arrays, the minimum for any splatter; and OpenGL with splats in its memory, until glFinish. Prints medians and
// minima as a Markdown table: splats per second, for all splats and for the splats in view. A first round, which
// uploads and compiles, is not counted.

#include "base/parallel.h"
#include "bench/shared/open_gl.h"
#include "render/gl/context.h"
#include "render/gl/gl.h"
#include "render/splat/software/splat_kernel.h"
#include "render/splat/software/splat_raster.h"
#include "render/splat/splat_gl.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace gs::bench {
namespace {

std::shared_ptr<const qnv::Splats> bumpy_sphere(std::size_t count) {
  constexpr float kPi = 3.14159265f;
  auto geometry = std::make_shared<qnv::Splats>();
  for (std::size_t i = 0; i < count; ++i) {
    const float z = 1 - 2 * (static_cast<float>(i) + 0.5f) / static_cast<float>(count);
    const auto angle = static_cast<float>(std::fmod(2.39996322972865332 * static_cast<double>(i), 6.28318530717958648));
    const float across = std::sqrt(1 - z * z), x = across * std::cos(angle), y = across * std::sin(angle);
    const glm::vec3 n(x, y, z), bump(std::cos(20 * x), std::cos(20 * y), std::cos(20 * z));
    geometry->positions.push_back(n * (1 + 0.02f * (std::sin(20 * x) + std::sin(20 * y) + std::sin(20 * z))));
    const glm::vec3 tilted = n - (bump - n * glm::dot(bump, n)) * 0.4f;
    geometry->normals.push_back(tilted / glm::length(tilted));
    geometry->weights.push_back(4 * kPi / static_cast<float>(count));
    geometry->description.box.add(geometry->positions.back());
  }
  return geometry;
}

struct Row {
  std::string name;
  std::function<void()> work;
  std::vector<double> seconds = {};
};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// Reads the positions, normals and weights that a splatter must read.
float sum_of(const qnv::Splats& geometry, unsigned threads) {
  constexpr std::size_t kPart = 16384, kLanes = 16;
  std::vector<float> sums((geometry.size() + kPart - 1) / kPart);
  const auto sum = [](const float* values, std::size_t count) {
    std::array<float, kLanes> lanes{};
    std::size_t i = 0;
    for (; i + kLanes <= count; i += kLanes)
      for (std::size_t lane = 0; lane < kLanes; ++lane) lanes[lane] += values[i + lane];
    float all = 0;
    for (; i < count; ++i) all += values[i];
    for (const float lane : lanes) all += lane;
    return all;
  };
  parallel_for(
      sums.size(),
      [&](std::size_t part) {
        const std::size_t first = part * kPart, count = std::min(kPart, geometry.size() - first);
        sums[part] = sum(&geometry.positions[first].x, 3 * count) + sum(&geometry.normals[first].x, 3 * count) +
                     sum(&geometry.weights[first], count);
      },
      threads);
  return sum(sums.data(), sums.size());
}

bool measure(const render::Gl& gl, const std::shared_ptr<const qnv::Splats>& geometry, int runs, int supersample) {
  render::SplatView view;
  view.camera_from_node[3] = glm::vec4(0, 0, -3, 1);
  view.tangents = {0.4f * 1024 / 768, 0.4f};
  view.width = 1024;
  view.height = 768;
  view.near_plane = 0.1f;
  view.supersample = supersample;
  render::SplatGl splats(gl);
  const render::SharedSplatPiece whole{geometry, 0, geometry->size()};
  bool good = true;
  const render::SplatPiece all{geometry.get(), 0, geometry->size()};
  const std::size_t in_view = render::rasterize_surface(std::span(&all, 1), view).discs;
  const auto finished = [&](const std::optional<render::SplatTextures>& drawn) {
    good = good && drawn && drawn->normals != 0;
    gl.Finish();
  };
  std::vector<Row> rows;
  volatile float kept = 0;  // prevents optimisation
  for (const unsigned threads : {1u, 2u}) {
    const std::string on = threads == 1 ? ", 1 thread" : ", 2 threads";
    for (const render::SplatKernel& kernel : render::splat_kernels())
      rows.push_back({std::string(kernel.name) + on, [&, threads] {
                        render::SplatView own = view;
                        own.threads = threads;
                        good = good && !render::rasterize_surface(std::span(&all, 1), own, kernel).empty();
                      }});
    rows.push_back({"sum over the arrays, 28 bytes a disc" + on, [&, threads] { kept = sum_of(*geometry, threads); }});
  }
  rows.push_back({"OpenGL (" + gl.renderer + ")", [&] { finished(splats.draw(std::span(&whole, 1), view)); }});
  for (int run = -1; run < runs; ++run) {
    for (Row& row : rows) {
      const auto start = std::chrono::steady_clock::now();
      row.work();
      const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      if (run >= 0) row.seconds.push_back(seconds);
    }
  }
  std::printf("\n%zu discs, %zu of them in view, 1024x768, %d sample%s a pixel, %d runs\n\n", geometry->size(), in_view,
              supersample * supersample, supersample > 1 ? "s" : "", runs);
  std::printf(
      "| | ms | least ms | M discs/s | M discs/s in view | of OpenGL |\n| --- | --- | --- | --- | --- | --- |\n");
  const double gl_seconds = median(rows.back().seconds);
  for (const Row& row : rows) {
    const double seconds = median(row.seconds);
    std::printf("| %s | %.1f | %.1f | %.2f | %.2f | %.2f |\n", row.name.c_str(), seconds * 1e3,
                *std::min_element(row.seconds.begin(), row.seconds.end()) * 1e3,
                static_cast<double>(geometry->size()) / seconds / 1e6, static_cast<double>(in_view) / seconds / 1e6,
                gl_seconds / seconds);
  }
  return good;
}

int run(std::size_t discs, int runs, const std::string& backend) {
  const OpenGl opened(backend);
  if (!opened.context) return 1;
  const auto geometry = bumpy_sphere(discs);
  for (const int supersample : {1, 2}) {
    if (measure(opened.gl, geometry, runs, supersample)) continue;
    std::fprintf(stderr, "OpenGL could not draw the discs\n");
    return 1;
  }
  return 0;
}

}  // namespace
}  // namespace gs::bench

int main(int argc, char** argv) {
  std::size_t discs = 1'000'000;
  int runs = 5;
  std::string backend = "auto";
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    if (argument == "--discs" && i + 1 < argc) {
      discs = static_cast<std::size_t>(std::max(1ll, std::atoll(argv[++i])));
    } else if (argument == "--runs" && i + 1 < argc) {
      runs = std::max(1, std::atoi(argv[++i]));
    } else if (argument == "--backend" && i + 1 < argc) {
      backend = argv[++i];
    } else {
      std::fprintf(stderr, "usage: splat_bench [--discs N] [--runs R] [--backend auto|egl|osmesa]\n");
      return 2;
    }
  }
  return gs::bench::run(discs, runs, backend);
}
