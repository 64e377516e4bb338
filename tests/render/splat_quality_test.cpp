// Tests of surfaces on every cut and path: closed, and steady during rotation.

#include "tests/render/drawing.h"
#include "tests/render/splat_scenes.h"

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <numeric>
#include <random>
#include <vector>

using namespace gs;
using namespace gs::render;
using namespace gs::render::testing;

namespace {

RenderList bumpy_list(std::shared_ptr<const qnv::Geometry> geometry) {
  RenderList list;
  SplatItem item;
  item.geometry = std::move(geometry);
  list.splats.push_back(std::move(item));
  list.bounds.add({-1.06f, -1.06f, -1.06f});
  list.bounds.add({1.06f, 1.06f, 1.06f});
  return list;
}

/// Returns a white item in any light.
RenderList white(std::shared_ptr<const qnv::Geometry> geometry) {
  RenderList list = bumpy_list(std::move(geometry));
  list.splats[0].material.diffuse = glm::vec3(0);
  list.splats[0].material.emissive = glm::vec3(1);
  return list;
}

/// Returns a view from `eye` to the origin, 53 degrees high.
Camera narrow_camera(const glm::vec3& eye) {
  Camera camera;
  camera.world_from_camera = glm::inverse(glm::lookAt(eye, glm::vec3(0), glm::vec3(0.1f, 1, 0.05f)));
  camera.field_of_view = 2 * std::atan(0.5f);
  return camera;
}

struct Holes {
  std::size_t pixels = 0, open = 0;
};

/// Counts the pixels with rays within `within` of the origin, and those of them that show the background.
Holes holes_in(Drawing& drawing, const RenderList& list, float distance, float within) {
  Holes holes;
  const auto size = static_cast<float>(drawing.options.width);
  for (int k = 0; k < 3; ++k) {
    const auto turn = 1.7f * static_cast<float>(k);
    const glm::vec3 eye = glm::normalize(glm::vec3(std::sin(turn), 0.3f * turn - 0.4f, std::cos(turn))) * distance;
    const Image image = drawing.draw(list, narrow_camera(eye));
    for (std::uint32_t y = 0; y < image.height; ++y)
      for (std::uint32_t x = 0; x < image.width; ++x) {
        const glm::vec3 ray((static_cast<float>(x) + 0.5f) / size - 0.5f, 0.5f - (static_cast<float>(y) + 0.5f) / size,
                            -1);
        const float miss = glm::length(ray * (distance / glm::dot(ray, ray)) + glm::vec3(0, 0, distance));
        if (miss > within) continue;
        ++holes.pixels;
        if (pixel(image, x, y).g < 250) ++holes.open;
      }
  }
  return holes;
}

double decibels(double sum_of_squares, std::size_t count) {
  return 10 * std::log10(255.0 * 255.0 * static_cast<double>(count) / std::max(sum_of_squares, 1e-9));
}

/// Returns the lowest PSNR of any picture against the mean of its neighbours.
double steadiness(const std::vector<Image>& frames) {
  double worst = 1000;
  for (std::size_t i = 1; i + 1 < frames.size(); ++i) {
    double sum = 0;
    for (std::size_t k = 0; k < frames[i].pixels.size(); ++k) {
      const double mean = (frames[i - 1].pixels[k] + frames[i + 1].pixels[k]) * 0.5;
      sum += (frames[i].pixels[k] - mean) * (frames[i].pixels[k] - mean);
    }
    worst = std::min(worst, decibels(sum, frames[i].pixels.size()));
  }
  return worst;
}

}  // namespace

TEST_CASE("draws a closed surface without holes at any distance and budget", "[optimised]") {
  Drawing drawing;
  const RenderList list = white(bumpy_stream(60000));
  drawing.options.background = glm::vec3(1, 0, 1);
  drawing.options.headlight = false;
  drawing.options.width = drawing.options.height = 120;
  for (const SplatPath path : {SplatPath::cpu, SplatPath::gl}) {
    drawing.options.splats = path;
    int samples = 1;
    for (const std::size_t budget : {1000u, 4000u, 20000u, 100000u, 1000000u})
      for (const float distance : {1.25f, 1.7f, 2.5f, 4.0f, 8.0f, 20.0f, 60.0f}) {
        samples = 5 - samples;  // alternates 4 and 1; the case below covers the other half
        drawing.options.budget = budget;
        drawing.options.samples = samples;
        const Holes holes = holes_in(drawing, list, distance, 0.9f);
        INFO((path == SplatPath::gl ? "gl" : "cpu") << ", budget " << budget << ", distance " << distance << ", "
                                                    << samples << " samples, " << holes.pixels << " pixels");
        CHECK(holes.pixels > 0);
        // A hundred splats for the whole surface leave gaps wider than the closed half voxel.
        CHECK(holes.open <= (budget == 1000 ? holes.pixels / 1000 : 0));
      }
  }
}

TEST_CASE("draws a closed surface without holes after any earlier views", "[optimised]") {
  struct View {
    std::size_t budget;
    float distance;
    int samples;
  };
  std::vector<View> views;
  for (const std::size_t budget : {4000u, 20000u, 100000u, 1000000u})
    for (const float distance : {1.25f, 1.7f, 2.5f, 4.0f, 8.0f, 20.0f, 60.0f})
      for (const int samples : {1, 4}) views.push_back({budget, distance, samples});
  std::reverse(views.begin(), views.end());
  Drawing drawing;
  const RenderList list = white(bumpy_stream(60000));
  drawing.options.background = glm::vec3(1, 0, 1);
  drawing.options.headlight = false;
  drawing.options.width = drawing.options.height = 120;
  drawing.options.splats = SplatPath::cpu;
  std::mt19937 random(5);
  for (int order = 0; order < 2; ++order, std::shuffle(views.begin(), views.end(), random))
    for (const View& view : views) {
      drawing.options.budget = view.budget;
      drawing.options.samples = view.samples;
      const Holes holes = holes_in(drawing, list, view.distance, 0.9f);
      INFO("order " << order << ", budget " << view.budget << ", distance " << view.distance << ", " << view.samples
                    << " samples, " << holes.pixels << " pixels");
      CHECK(holes.pixels > 0);
      CHECK(holes.open == 0);
    }
}

TEST_CASE("changes a slowly turning surface as smoothly as polygons", "[optimised]") {
  Drawing drawing;
  const auto stream = bumpy_stream(60000);
  drawing.options.background = glm::vec3(0.2f, 0.3f, 0.5f);
  drawing.options.width = drawing.options.height = 120;
  drawing.options.samples = 4;
  for (const SplatPath path : {SplatPath::cpu, SplatPath::gl}) {
    drawing.options.splats = path;
    for (const std::size_t budget : {3000u, 12000u, 0u})
      for (const float distance : {2.5f, 9.0f}) {
        drawing.options.budget = budget;
        std::vector<Image> frames;
        for (int i = 0; i < (path == SplatPath::gl ? 6 : 20); ++i) {
          const float turn = 0.004f * static_cast<float>(i);
          frames.push_back(drawing.draw(bumpy_list(stream),
                                        narrow_camera(distance * glm::vec3(std::sin(turn), 0.2f, std::cos(turn)))));
        }
        const double psnr = steadiness(frames);
        INFO((path == SplatPath::gl ? "gl" : "cpu")
             << ", budget " << budget << ", distance " << distance << ", PSNR " << psnr);
        CHECK(psnr > 45);
      }
  }
}
