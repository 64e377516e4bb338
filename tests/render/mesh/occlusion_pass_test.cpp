#include "tests/render/drawing.h"

#include <algorithm>
#include <vector>

namespace gs::render::occlusion_pass_test {

using namespace testing;

namespace {

/// Returns a white wall, with a white floor that stands out from its middle towards the viewer.
RenderList corner() {
  RenderList list;
  add(list, glowing(square(2), glm::vec3(1)));
  glm::mat4 floor(1.0f);
  floor[1] = glm::vec4(0, 0, -1, 0);
  floor[2] = glm::vec4(0, 1, 0, 0);
  floor[3] = glm::vec4(0, -0.5f, 2, 1);
  add(list, glowing(square(2), glm::vec3(1), floor));
  return list;
}

}  // namespace

TEST_CASE("darkens surfaces near other surfaces, and nothing else") {
  const RenderList list = corner();
  Drawing drawing;
  drawing.options.width = drawing.options.height = 256;
  drawing.options.occlusion = Occlusion::always;
  for (const int samples : {1, 2, 3, 4}) {  // in software, 4 are pixels, but 3 are not
    CAPTURE(samples);
    drawing.options.samples = samples;
    const Image image = drawing.draw(list, camera_at({0, 1, 8}));
    const auto gray = [&](std::uint32_t x, std::uint32_t y) { return pixel(image, x, y).x; };
    CHECK(gray(128, 104) > 250);  // the wall far above the floor
    std::uint32_t darkest = 104;
    for (std::uint32_t y = 104; y < 256; ++y)
      if (gray(128, y) > 0 && (gray(128, darkest) == 0 || gray(128, y) < gray(128, darkest))) darkest = y;
    CHECK(gray(128, darkest) < 250);
    CHECK(gray(128, darkest) > 60);
    CHECK(darkest > 170);
    CHECK(darkest < 200);
    CHECK(gray(0, 0) == 0);  // background
  }
}

TEST_CASE("darkens a corner equally with any number of samples, on average over places in the pixel") {
  const RenderList list = corner();
  Drawing drawing;
  drawing.options.width = drawing.options.height = 256;
  drawing.options.occlusion = Occlusion::always;
  std::vector<double> means, spreads;
  for (const int samples : {1, 2, 3}) {
    drawing.options.samples = samples;
    double total = 0, least = 1e9, most = 0;
    constexpr int kPlaces = 12;  // one pixel of the floor's edge
    for (int place = 0; place < kPlaces; ++place) {
      const Image image = drawing.draw(list, camera_at({0, 1 + 0.0026f * static_cast<float>(place), 8}));
      double sum = 0;
      for (std::uint32_t y = 150; y < 220; ++y) sum += static_cast<double>(255 - pixel(image, 128, y).x);
      total += sum / kPlaces;
      least = std::min(least, sum);
      most = std::max(most, sum);
    }
    means.push_back(total);
    spreads.push_back(most - least);
  }
  INFO(means[0] << ' ' << means[1] << ' ' << means[2] << "; " << spreads[0] << ' ' << spreads[1] << ' ' << spreads[2]);
  CHECK(means[0] > 50);
  CHECK(means[1] == Approx(means[0]).epsilon(0.25));
  CHECK(means[2] == Approx(means[0]).epsilon(0.25));
  CHECK(spreads[2] < spreads[0]);
}

TEST_CASE("does not darken a single face, at any angle") {
  RenderList list;
  const float turn = GENERATE(0.0f, 0.7f, 1.3f);
  glm::mat4 turned(1.0f);
  turned[0] = glm::vec4(std::cos(turn), 0, -std::sin(turn), 0);
  turned[2] = glm::vec4(std::sin(turn), 0, std::cos(turn), 0);
  add(list, glowing(square(3), glm::vec3(1), turned));
  Drawing drawing;
  const Image plain = drawing.draw(list);
  drawing.options.occlusion = Occlusion::always;
  CHECK(drawing.draw(list).pixels == plain.pixels);
}

TEST_CASE("omits ambient occlusion in software drivers, in wireframes and if it is off") {
  const RenderList list = corner();
  Drawing drawing;
  const Image plain = drawing.draw(list);
  drawing.options.occlusion = Occlusion::hardware;
  CHECK(drawing.draw(list).pixels == plain.pixels);
  drawing.options.display = DisplayMode::wireframe;
  const Image wires = drawing.draw(list);
  drawing.options.occlusion = Occlusion::always;
  CHECK(drawing.draw(list).pixels == wires.pixels);
}

TEST_CASE("shines from the direction of the headlight") {
  RenderList list;
  add(list, unlit(square(1)));
  list.items.front().material.lit = true;
  Drawing drawing;
  const float ahead = pixel(drawing.draw(list), 32, 32).x;
  drawing.options.headlight_towards = glm::normalize(glm::vec3(1, 0, 1));
  const float aside = pixel(drawing.draw(list), 32, 32).x;
  CHECK(aside == Approx(ahead * std::sqrt(0.5f)).margin(2));
}

}  // namespace gs::render::occlusion_pass_test
