#include "app/view/values/color_maps.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include <cmath>
#include <string>

namespace gs::app::color_maps_test {
namespace {

/// Returns the luminance in linear light (sRGB, IEC 61966-2-1).
double luminance(const glm::vec3& color) {
  const auto linear = [](double c) { return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4); };
  return 0.2126 * linear(static_cast<double>(color.r)) + 0.7152 * linear(static_cast<double>(color.g)) +
         0.0722 * linear(static_cast<double>(color.b));
}

void check_bytes(const char* name, float place, const glm::vec3& expected, float tolerance) {
  const ColorMap* map = find_color_map(name);
  REQUIRE(map);
  const glm::vec3 color = color_at(*map, place) * 255.0f;
  INFO(name << " at " << place << ": " << color.r << " " << color.g << " " << color.b);
  CHECK(glm::length(color - expected) < tolerance);
}

}  // namespace

TEST_CASE("uses the published colours of colour maps") {
  // These colours are from matplotlib's tables. The polynomials match them within some hundredths.
  check_bytes("viridis", 0, {68, 1, 84}, 8);
  check_bytes("viridis", 0.5f, {33, 145, 140}, 8);
  check_bytes("viridis", 1, {253, 231, 37}, 8);
  check_bytes("inferno", 0, {0, 0, 4}, 8);
  check_bytes("inferno", 1, {252, 255, 164}, 8);
  check_bytes("magma", 0.5f, {183, 55, 121}, 8);
  check_bytes("magma", 1, {252, 253, 191}, 8);
  check_bytes("cividis", 0, {0, 34, 78}, 8);
  check_bytes("cividis", 1, {254, 232, 56}, 16);
  // Moreland 2009, table of the diverging map.
  check_bytes("coolwarm", 0, {59, 76, 192}, 2);
  check_bytes("coolwarm", 0.5f, {221, 221, 221}, 2);
  check_bytes("coolwarm", 1, {180, 4, 38}, 2);
  check_bytes("coolwarm", 0.25f, {141, 176, 254}, 3);
  check_bytes("grey", 0.2f, {51, 51, 51}, 1);
}

TEST_CASE("raises the luminance of sequential maps throughout, and of diverging maps to the middle") {
  for (const ColorMap& map : color_maps()) {
    if (map.name == "turbo") continue;  // a rainbow, which is not monotonic by design
    INFO(map.name);
    for (int i = 1; i <= 255; ++i) {
      const double before = luminance(color_at(map, static_cast<float>(i - 1) / 255)),
                   now = luminance(color_at(map, static_cast<float>(i) / 255));
      if (map.diverging && i > 128) {
        CHECK(now < before);
      } else if (!map.diverging || i < 127) {
        CHECK(now > before);
      }
    }
  }
}

TEST_CASE("clamps invalid positions to the ends, and rejects unknown map names") {
  const ColorMap* map = find_color_map("viridis");
  REQUIRE(map);
  CHECK(color_at(*map, -3) == color_at(*map, 0));
  CHECK(color_at(*map, 7) == color_at(*map, 1));
  CHECK(color_at(*map, std::nanf("")) == color_at(*map, 0));
  CHECK(find_color_map("jet") == nullptr);
  CHECK(color_map_names() == "grey, viridis, cividis, inferno, magma, turbo, coolwarm");
}

TEST_CASE("applies the colours of a map to a transfer function, and keeps its opacities") {
  const Transfer transfer{{0.1f, {9, 9, 9}, 0}, {0.45f, {9, 9, 9}, 0.8f}, {0.9f, {9, 9, 9}, 0.2f}};
  const ColorMap* map = find_color_map("magma");
  REQUIRE(map);
  const Transfer mapped = recolored(transfer, *map);
  CHECK(mapped.size() <= kMaxTransferPoints);
  for (int i = 0; i <= 100; ++i) {
    const float place = static_cast<float>(i) / 100;
    CHECK(transfer_at(mapped, place).opacity == Approx(transfer_at(transfer, place).opacity).margin(0.02));
  }
  for (const qnv::TransferPoint& point : mapped) {
    const glm::vec3 color = color_at(*map, point.value) * 255.0f;
    CHECK(glm::length(glm::vec3(point.color.r, point.color.g, point.color.b) - color) < 1);
  }
  const Transfer ends = mapped_transfer(*find_color_map("coolwarm"), OpacityRamp::ends);
  CHECK(transfer_at(ends, 0.5f).opacity == 0);
  CHECK(transfer_at(ends, 0).opacity == Approx(0.9f));
  CHECK(transfer_at(mapped_transfer(*map, OpacityRamp::linear), 0.5f).opacity == Approx(0.45f));
}

}  // namespace gs::app::color_maps_test
