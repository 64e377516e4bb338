#include "qnv/sampling/volume/gradients.h"
#include "qnv/sampling/volume/gradient_row.h"

#include "tests/qnv/volume_sources.h"

#include <catch2/catch.hpp>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <random>
#include <tuple>

using namespace gs;

using namespace gs::qnv;
using namespace gs::test;

namespace {

Volume encoded(const VolumeSource& source, GradientOptions options = {.fraction = 1}) {
  auto result = gradient_vectors(source, options);
  if (const auto* problem = std::get_if<VolumeError>(&result)) FAIL(problem->message);
  return std::get<Volume>(std::move(result));
}

std::string problem_of(const VolumeSource& source, const GradientOptions& options = {}) {
  const auto result = gradient_vectors(source, options);
  const auto* problem = std::get_if<VolumeError>(&result);
  return problem ? problem->message : "";
}

VolumeSource noise(std::uint32_t n, unsigned gap_percent, int levels) {
  std::mt19937 random(7);
  return volume_of(oblique(n, n + 3, n - 2), [&](auto...) {
    const auto value = static_cast<float>(random() % static_cast<unsigned>(levels));
    return random() % 100 < gap_percent ? kNaN : value;
  });
}

bool same_vectors(const Volume& a, const Volume& b) {
  return a.positions == b.positions && a.normals == b.normals && a.weights == b.weights && a.classes == b.classes &&
         a.description == b.description;
}

}  // namespace

TEST_CASE("computes the same gradient of a linear ramp everywhere, for any axes") {
  const VolumeLayout layout = oblique(7, 6, 5);
  const glm::vec3 slope(0.3f, -1.2f, 0.7f);
  const VolumeSource source = volume_of(layout, [&](auto x, auto y, auto z) {
    return glm::dot(slope, place_of(layout, static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)));
  });
  const Volume geometry = encoded(source);
  REQUIRE(geometry.size() == 7 * 6 * 5);
  for (std::size_t i = 0; i < geometry.size(); ++i) {
    CHECK(geometry.weights[i] == Approx(glm::length(slope)).epsilon(1e-4));
    CHECK(glm::distance(geometry.normals[i], glm::normalize(slope)) < 1e-4f);
  }
  CHECK(geometry.description.total == Approx(210 * glm::length(slope)).epsilon(1e-4));
  CHECK(geometry.description.spacing == Approx(glm::length(layout.axes[0])));
}

TEST_CASE("computes the vectors around a single voxel as differences by hand do") {
  VolumeLayout layout;
  layout.dimensions = {5, 1, 1};
  layout.axes[0].x = 2;
  layout.metadata = {{"title", "row"}};
  const Volume geometry = encoded(volume_of<std::uint8_t>(layout, {0, 0, 8, 4, 4}));
  // Differences: (0-0)/2, (8-0)/4, (4-0)/4, (4-8)/4, (4-4)/2.
  REQUIRE(geometry.size() == 3);
  CHECK(geometry.weights == std::vector<float>{2, 1, 1});
  CHECK(geometry.positions == std::vector<glm::vec3>{{2, 0, 0}, {4, 0, 0}, {6, 0, 0}});
  CHECK(geometry.normals == std::vector<glm::vec3>{{1, 0, 0}, {1, 0, 0}, {-1, 0, 0}});
  CHECK(geometry.classes == std::vector<std::uint8_t>{0, 255, 128});
  CHECK(geometry.description.value_range == std::pair<float, float>{0, 8});
  CHECK(geometry.description.total == 4);
  CHECK(geometry.description.box == Box{{0, 0, 0}, {8, 0, 0}});
  CHECK(geometry.description.metadata == layout.metadata);
}

TEST_CASE("omits vectors at missing voxels, and takes one-sided differences beside them") {
  VolumeLayout layout;
  layout.dimensions = {7, 1, 1};
  const auto along_x = [&](std::vector<float> values) {
    VolumeLayout f32 = layout;
    f32.type = VoxelType::f32;
    return encoded(volume_of(f32, std::move(values)));
  };
  const Volume geometry = along_x({1, 3, kNaN, 5, kNaN, 8, 9});
  // Voxel 1 has 3 - 1 at the border, voxel 3 has 3 - 1, voxel 5 has no neighbours. Voxels 8 and 9 have 9 - 8.
  REQUIRE(geometry.size() == 4);
  CHECK(geometry.weights == std::vector<float>{2, 2, 1, 1});
  CHECK(geometry.positions[0].x == 0);
  CHECK(geometry.positions[1].x == 1);
  CHECK(geometry.positions[2].x == 5);
  CHECK(geometry.description.value_range == std::pair<float, float>{1, 9});

  layout.missing = 255;
  const Volume masked = encoded(volume_of<std::uint8_t>(layout, {1, 1, 255, 1, 1, 2, 255}));
  REQUIRE(masked.size() == 2);
  CHECK(masked.weights == std::vector<float>{1, 0.5f});
  CHECK(masked.description.value_range.second == 2);
}

TEST_CASE("points the gradients of a ball to its centre, for any axes") {
  VolumeLayout layout = oblique(40, 30, 20);
  const glm::vec3 centre = place_of(layout, 19.5f, 14.5f, 9.5f);
  const VolumeSource source = volume_of(layout, [&](auto x, auto y, auto z) {
    return 100 -
           glm::distance(centre, place_of(layout, static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)));
  });
  const Volume geometry = encoded(source);
  REQUIRE(geometry.size() == 40 * 30 * 20);
  std::size_t far_away = 0;
  for (std::size_t i = 0; i < geometry.size(); ++i) {
    const float distance = glm::distance(centre, geometry.positions[i]);
    if (distance < 5) continue;  // skips points where the distance changes too fast for a voxel
    ++far_away;
    REQUIRE(geometry.weights[i] == Approx(1).margin(0.05));
    REQUIRE(glm::dot(geometry.normals[i], (centre - geometry.positions[i]) / distance) > 0.99f);
  }
  CHECK(far_away > 10000);
}

TEST_CASE("sorts vectors by length, equal ones by voxel") {
  const Volume geometry = encoded(noise(20, 0, 3));
  const VolumeLayout layout = oblique(20, 23, 18);
  std::map<std::tuple<float, float, float>, std::size_t> voxels;
  std::size_t index = 0;
  for (std::uint32_t z = 0; z < 18; ++z)
    for (std::uint32_t y = 0; y < 23; ++y)
      for (std::uint32_t x = 0; x < 20; ++x) {
        const glm::vec3 p = voxel_position(layout, x, y, z);
        voxels[{p.x, p.y, p.z}] = index++;
      }
  const auto voxel = [&](std::size_t i) {
    return voxels.at({geometry.positions[i].x, geometry.positions[i].y, geometry.positions[i].z});
  };
  std::size_t ties = 0;
  for (std::size_t i = 1; i < geometry.size(); ++i) {
    REQUIRE(geometry.weights[i - 1] >= geometry.weights[i]);
    if (geometry.weights[i - 1] != geometry.weights[i]) continue;
    ++ties;
    REQUIRE(voxel(i - 1) < voxel(i));
  }
  CHECK(ties > 1000);
  CHECK(geometry.weights.back() > 0);
  double sum = 0;
  for (const float weight : geometry.weights) sum += static_cast<double>(weight);
  CHECK(geometry.description.total == Approx(sum).epsilon(1e-12));
  for (const glm::vec3& p : geometry.positions) {
    REQUIRE(glm::all(glm::greaterThanEqual(p, geometry.description.box.lower)));
    REQUIRE(glm::all(glm::lessThanEqual(p, geometry.description.box.upper)));
  }
}

TEST_CASE("encodes fewer vectors as the beginning of more") {
  const VolumeSource source = noise(24, 5, 100);
  const Volume all = encoded(source);
  const std::uint64_t voxels = 24 * 27 * 22;
  for (const GradientOptions& options :
       {GradientOptions{.fraction = 0.09}, GradientOptions{.fraction = 0.5},
        GradientOptions{.fraction = 1, .vectors = 77}, GradientOptions{.fraction = 1, .vectors = 0},
        GradientOptions{.fraction = 0}}) {
    const Volume some = encoded(source, options);
    const auto expected = std::min<std::uint64_t>(
        {options.vectors, static_cast<std::uint64_t>(std::lround(options.fraction * static_cast<double>(voxels))),
         all.size()});
    REQUIRE(some.size() == expected);
    CHECK(std::equal(some.positions.begin(), some.positions.end(), all.positions.begin()));
    CHECK(std::equal(some.weights.begin(), some.weights.end(), all.weights.begin()));
    CHECK(std::equal(some.normals.begin(), some.normals.end(), all.normals.begin()));
    CHECK(std::equal(some.classes.begin(), some.classes.end(), all.classes.begin()));
    CHECK(some.description == all.description);
  }
}

TEST_CASE("cuts more equal lengths than one sort holds at the right voxel") {
  // A ramp of 1.3 million voxels. All gradients are equal except in one plane.
  VolumeLayout layout;
  layout.dimensions = {128, 128, 80};
  std::vector<std::uint16_t> values;
  for (std::uint32_t z = 0; z < 80; ++z)
    for (std::uint32_t i = 0; i < 128 * 128; ++i)
      values.push_back(static_cast<std::uint16_t>(z * 4 + (z >= 40 ? 4 : 0)));
  layout.type = VoxelType::u16;
  const VolumeSource source = volume_of(layout, std::move(values));
  const Volume geometry = encoded(source, {.fraction = 1, .vectors = 40000, .threads = 3});
  REQUIRE(geometry.size() == 40000);
  const std::size_t steep = 2 * 128 * 128;  // slices 39 and 40: (z + 1) * 4 + 4 - (z - 1) * 4, halved
  CHECK(geometry.weights[steep - 1] == 6);
  CHECK(geometry.positions[0] == glm::vec3(0, 0, 39));
  CHECK(geometry.weights[steep] == 4);
  for (std::size_t i = steep; i < geometry.size(); ++i) {
    const std::size_t voxel = i - steep;
    REQUIRE(geometry.positions[i] == glm::vec3(voxel % 128, voxel / 128 % 128, voxel / (128 * 128)));
  }
  CHECK(same_vectors(geometry, encoded(source, {.fraction = 1, .vectors = 40000, .threads = 1})));
}

TEST_CASE("encodes a volume to the same bits on any number of threads") {
  for (const unsigned gaps : {0u, 20u}) {
    const VolumeSource source = noise(70, gaps, 50);
    const Volume one = encoded(source, {.fraction = 0.3, .threads = 1});
    for (const unsigned threads : {2u, 3u, 8u})
      CHECK(same_vectors(one, encoded(source, {.fraction = 0.3, .threads = threads})));
  }
}

TEST_CASE("computes the lengths of a row to the same bits on both paths") {
  if (!has_avx2()) {
    WARN("this processor has no AVX2");
    return;
  }
  std::mt19937 random(3);
  const glm::dmat3 to_world(glm::dvec3(0.3, 1.5, -2), glm::dvec3(1, 0.1, 0.7), glm::dvec3(-0.4, 0.2, 3));
  for (std::uint32_t count = 1; count < 40; ++count)
    for (const bool gaps : {false, true}) {
      std::vector<std::vector<float>> rows(5, std::vector<float>(count));
      for (auto& row : rows)
        for (float& value : row) {
          value = static_cast<float>(random()) * 1e-3f;
          if (random() % 50 == 0) value *= 1e31f;
          if (gaps && random() % 4 == 0) value = kNaN;
        }
      GradientRow row;
      row.here = rows[0].data();
      row.before = {rows[1].data(), rows[2].data()};
      row.after = {rows[3].data(), rows[4].data()};
      row.factor = {0.5, 1};
      row.count = count;
      std::vector<float> portable(count), fast(count);
      magnitudes_portable(row, to_world, gaps, portable.data());
      magnitudes_avx2(row, to_world, gaps, fast.data());
      REQUIRE(std::memcmp(portable.data(), fast.data(), count * sizeof(float)) == 0);
      for (const float length : fast) REQUIRE((length >= 0 && std::isfinite(length)));
    }
}

TEST_CASE("encodes values at the limits of floats as finite vectors") {
  for (const float scale : {1e-38f, 1e-20f, 1e20f, 3e38f}) {
    VolumeLayout layout;
    layout.dimensions = {3, 3, 3};
    const VolumeSource source = volume_of(layout, [&](auto x, auto y, auto z) {
      return (x + y + z) % 2 == 0 ? scale : -scale / 2 * static_cast<float>(x);
    });
    const Volume geometry = encoded(source);
    REQUIRE_FALSE(geometry.empty());
    for (std::size_t i = 0; i < geometry.size(); ++i) {
      REQUIRE((geometry.weights[i] > 0 && std::isfinite(geometry.weights[i])));
      REQUIRE(glm::length(geometry.normals[i]) == Approx(1));
    }
  }
}

TEST_CASE("reports why a volume cannot be encoded") {
  VolumeLayout layout;
  layout.dimensions = {2, 2, 2};
  const VolumeSource source = volume_of<std::uint8_t>(layout, {1, 2, 3, 4, 5, 6, 7, 8});
  CHECK(problem_of(source).empty());
  CHECK_FALSE(problem_of(source, {.fraction = 1.5}).empty());
  CHECK_FALSE(problem_of(source, {.fraction = std::nan("")}).empty());
  CHECK_FALSE(problem_of(source, {.vectors = std::uint64_t{1} << 40}).empty());
  CHECK_FALSE(problem_of({layout, nullptr}).empty());
  CHECK(problem_of(volume_of<std::uint8_t>(layout, {1, 2, 3, 4})).find("slice") != std::string::npos);
  VolumeLayout flat = layout;
  flat.dimensions[0] = 0;
  CHECK_FALSE(problem_of({flat, source.read}).empty());
  const VolumeSource nothing = volume_of(layout, [](auto...) { return kNaN; });
  CHECK(problem_of(nothing).find("missing") != std::string::npos);

  Progress progress;
  progress.cancelled = true;
  const auto result = gradient_vectors(source, {}, &progress);
  REQUIRE(std::holds_alternative<VolumeError>(result));
  CHECK(std::get<VolumeError>(result).message == "cancelled");
}

TEST_CASE("encodes a volume of one value as a description without vectors") {
  VolumeLayout layout;
  layout.dimensions = {3, 2, 2};
  const Volume geometry = encoded(volume_of<std::uint8_t>(layout, std::vector<std::uint8_t>(12, 9)));
  CHECK(geometry.empty());
  CHECK(geometry.description.total == 0);
  CHECK(geometry.description.value_range == std::pair<float, float>{9, 9});
}

TEST_CASE("makes transfer functions that begin transparent and rise") {
  for (const auto& [least, most] :
       {std::pair{0.0f, 255.0f}, {-1000.0f, 3000.0f}, {-0.6f, 4.0f}, {-5.0f, 1.0f}, {2.0f, 2.0f}}) {
    const std::vector<TransferPoint> points = default_transfer(least, most);
    REQUIRE(points.size() >= 2);
    CHECK(points.front().value == 0);
    CHECK(points.front().opacity == 0);
    CHECK(points.back().value == 1);
    for (std::size_t i = 1; i < points.size(); ++i) {
      CHECK(points[i - 1].value <= points[i].value);
      CHECK(points[i - 1].opacity <= points[i].opacity);
    }
  }
  CHECK(default_transfer(-1000, 3000)[1].value == 0.25f);
}

TEST_CASE("reports progress up to its end") {
  Progress progress;
  VolumeLayout layout;
  layout.dimensions = {4, 4, 9};
  std::vector<std::uint8_t> voxels(144);
  for (std::size_t i = 0; i < voxels.size(); ++i) voxels[i] = static_cast<std::uint8_t>(i);
  const auto result = gradient_vectors(volume_of(layout, voxels), {}, &progress);
  CHECK(std::holds_alternative<Volume>(result));
  CHECK(progress.total == 9);
  CHECK(std::string(progress.stage.load()) == "sorting");
}
