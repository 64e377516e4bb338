#include "qnv/codecs/values/arrays/array_volume.h"
#include "qnv/sampling/volume/gradients.h"
#include "qnv/sampling/volume/volume_slices.h"
#include "qnv/sampling/volume/volume_values.h"
#include "tests/qnv/volume_sources.h"

#include <catch2/catch.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

namespace gs::qnv {
namespace array_volume_test {

using values::Extent;

constexpr Extent kSize{150, 140, 130};

/// Voxels that the functions of a source read.
struct ReadCount {
  std::atomic<std::uint64_t> voxels{0}, boxes{0};
};

float value_at(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  const float dx = static_cast<float>(x) - 75, dy = static_cast<float>(y) - 70, dz = static_cast<float>(z) - 65;
  return 1000 - 10 * std::sqrt(dx * dx + dy * dy + dz * dz) + static_cast<float>((x * 7 + y * 13 + z * 5) % 11);
}

/// Makes a source of a size that counts what is read of it. With `chunk`, its voxels are stored in such chunks.
VolumeSource counted(const Extent& size, const std::shared_ptr<ReadCount>& count, Extent chunk = {}) {
  VolumeLayout layout;
  layout.dimensions = size;
  VolumeSource source = test::volume_of(layout, value_at);
  source.chunk = chunk;
  source.read_box = [read = source.read, size, count](const VoxelBox& box, std::span<std::byte> to) {
    if (!lies_in(box, size) || to.size() != voxel_count(box) * sizeof(float)) return false;
    count->voxels += voxel_count(box);
    ++count->boxes;
    std::byte* next = to.data();
    for (std::uint32_t z = 0; z < box.size[2]; ++z)
      for (std::uint32_t y = 0; y < box.size[1]; ++y)
        for (std::uint32_t x = 0; x < box.size[0]; ++x, next += sizeof(float)) {
          const float value = value_at(box.first[0] + x * box.step[0], box.first[1] + y * box.step[1],
                                       box.first[2] + z * box.step[2]);
          std::memcpy(next, &value, sizeof(value));
        }
    return true;
  };
  return source;
}

BrickLimits limits_of(std::size_t base_vectors, std::size_t bytes = std::size_t{256} << 20) {
  BrickLimits limits;
  limits.base_vectors = base_vectors;
  limits.brick_bytes = bytes;
  return limits;
}

/// View from outside in which each voxel is larger than a pixel.
LodView close_view() {
  LodView view;
  view.eye = glm::vec3(75, 70, -200);
  view.pixels = 1e6f;
  return view;
}

std::shared_ptr<const Volume> shown_in(ArrayVolume& array, const LodView& view) {
  bool pending = false;
  return array.cut(view, pending);
}

}  // namespace array_volume_test
using namespace array_volume_test;

TEST_CASE("shows the voxels of an array and their gradients, when all bricks fit into memory") {
  const auto count = std::make_shared<ReadCount>();
  const Extent chunk = GENERATE(Extent{}, Extent{64, 64, 64}, Extent{50, 30, 20});
  const VolumeSource source = counted(kSize, count, chunk);
  ArrayVolume array(source, limits_of(4000));
  REQUIRE(array.read_overview(std::chrono::minutes(1), {}));
  REQUIRE(array.has_overview());
  const auto volume = shown_in(array, close_view());
  REQUIRE(volume->values);
  std::uint64_t exact = 0;
  for (const ValueBrick& brick : volume->values->bricks) {
    const auto step = static_cast<std::uint32_t>(1u << brick.level);
    for (std::uint32_t z = brick.first[2]; z < brick.first[2] + brick.size[2]; z += 3)
      for (std::uint32_t y = brick.first[1]; y < brick.first[1] + brick.size[1]; ++y)
        for (std::uint32_t x = brick.first[0]; x < brick.first[0] + brick.size[0]; ++x)
          exact += brick.value(x, y, z) == value_at(x * step, y * step, z * step) ? 0 : 1;
  }
  CHECK(exact == 0);
  CHECK(std::ranges::count(volume->values->bricks, 0, &ValueBrick::level) == 27);
  // Gradients of the finest level are those of the whole volume.
  GradientOptions all;
  all.fraction = 1;
  const auto whole = std::get<Volume>(gradient_vectors(source, all));
  const auto voxel_of = [](const glm::vec3& at) {
    return (static_cast<std::size_t>(at.z) * kSize[1] + static_cast<std::size_t>(at.y)) * kSize[0] +
           static_cast<std::size_t>(at.x);
  };
  std::vector<std::size_t> places(values::sample_count(kSize), whole.size());
  for (std::size_t i = 0; i < whole.size(); ++i) places[voxel_of(whole.positions[i])] = i;
  std::size_t fine = 0, wrong = 0;
  for (std::size_t i = 0; i < volume->size(); ++i) {
    if (volume->cells[i].edge != 1) continue;
    ++fine;
    const std::size_t same = places[voxel_of(volume->positions[i])];
    if (same == whole.size() || whole.weights[same] != volume->weights[i] || whole.normals[same] != volume->normals[i])
      ++wrong;
  }
  CHECK(fine == volume->size());
  CHECK(fine > 200'000);
  CHECK(wrong == 0);
}

TEST_CASE("a near view of an array reads little of it") {
  const auto count = std::make_shared<ReadCount>();
  constexpr Extent kLarge{2048, 2048, 2048};
  VolumeSource source;
  source.layout.dimensions = kLarge;
  source.layout.type = VoxelType::f32;
  source.chunk = {64, 64, 64};
  source.read_box = [count](const VoxelBox& box, std::span<std::byte> to) {
    count->voxels += voxel_count(box);
    ++count->boxes;
    std::byte* next = to.data();
    for (std::uint32_t z = 0; z < box.size[2]; ++z)
      for (std::uint32_t y = 0; y < box.size[1]; ++y)
        for (std::uint32_t x = 0; x < box.size[0]; ++x, next += sizeof(float)) {
          const glm::vec3 at(box.first[0] + x * box.step[0], box.first[1] + y * box.step[1],
                             box.first[2] + z * box.step[2]);
          const float value = 1e6f / (100 + glm::length(at - glm::vec3(1050, 1000, 1000)));
          std::memcpy(next, &value, sizeof(value));
        }
    return true;
  };
  ArrayVolume array(std::move(source), limits_of(20'000));
  REQUIRE(array.read_overview(std::chrono::minutes(1), {}));
  const std::uint64_t overview = count->voxels;
  CHECK(overview <= 300'000);
  count->voxels = 0;
  // A narrow view along x, inside of the volume.
  LodView view = close_view();
  view.eye = glm::vec3(1000, 1000, 1000);
  view.planes = {glm::vec4(1, 0, 0, -1000), glm::vec4(-1, 0, 0, 1100), glm::vec4(0, 1, 0, -990),
                 glm::vec4(0, -1, 0, 1010), glm::vec4(0, 0, 1, -990)};
  view.volume.clip = glm::vec4(0, 0, -1, 1010);
  view.pixels = 400;
  const auto volume = shown_in(array, view);
  const std::uint64_t bricks = array.statistics().bricks;
  CHECK(bricks > 4);
  CHECK(array.statistics().finest == 0);
  CHECK(count->voxels <= bricks * 64 * 64 * 64);
  CHECK(count->voxels < std::uint64_t{2048} * 2048 * 2048 / 500);
  SECTION("and the same view again reads nothing") {
    count->voxels = 0;
    LodView other = view;
    other.pixels = 399;
    (void)shown_in(array, other);
    (void)shown_in(array, view);
    CHECK(count->voxels == 0);
  }
}

TEST_CASE("stops reading for the previous view when a view moves") {
  const auto count = std::make_shared<ReadCount>();
  VolumeSource source = counted({512, 512, 512}, count, {64, 64, 64});
  const auto read = source.read_box;
  const auto slow = std::make_shared<std::atomic<bool>>(false);
  source.read_box = [read, slow](const VoxelBox& box, std::span<std::byte> to) {
    if (*slow) std::this_thread::sleep_for(std::chrono::milliseconds(30));
    return read(box, to);
  };
  ArrayVolume array(std::move(source), limits_of(4000));
  REQUIRE(array.read_overview(std::chrono::minutes(1), {}));
  *slow = true;
  const std::uint64_t before = count->boxes;
  LodView view = close_view();
  view.most_decoded = 1;
  bool pending = false;
  REQUIRE(array.cut(view, pending));
  CHECK(pending);
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  // Nothing of the volume is in this view.
  view.planes[0] = glm::vec4(1, 0, 0, -1e6f);
  for (int i = 0; i < 100 && pending; ++i) {
    pending = false;
    (void)array.cut(view, pending);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  CHECK_FALSE(pending);
  CHECK(count->boxes < before + 50);
  CHECK(array.statistics().bricks < 100);
}

TEST_CASE("shows more of the overview of an array before its bricks") {
  const auto count = std::make_shared<ReadCount>();
  ArrayVolume array(counted({512, 512, 512}, count), limits_of(4000));
  LodView view = close_view();
  view.most_decoded = 1;
  for (int part = 1; part <= 3; ++part) {
    int blocks = 0;
    const std::uint64_t revision = array.revision();
    REQUIRE(array.read_overview(std::chrono::minutes(1), [&] { return blocks++ >= 1; }));
    CHECK_FALSE(array.has_overview());
    CHECK(array.revision() > revision);
    bool pending = false;
    CHECK(array.cut(view, pending) == array.overview());
    CHECK_FALSE(pending);
    CHECK(array.statistics().bricks == 0);
  }
  bool pending = false;
  SECTION("but points of a view come first") {
    view.volume.points[0] = glm::vec3(100, 20, 30);
    (void)array.cut(view, pending);
    CHECK(pending);
  }
  SECTION("until it has no large gaps") {
    REQUIRE(array.read_overview(std::chrono::minutes(1), {}));
    (void)array.cut(view, pending);
    CHECK(pending);
  }
}

TEST_CASE("the place under the pointer gets the finest voxels of an array, also from far away") {
  const auto count = std::make_shared<ReadCount>();
  ArrayVolume array(counted(kSize, count), limits_of(4000));
  REQUIRE(array.read_overview(std::chrono::minutes(1), {}));
  LodView view = close_view();
  view.eye = glm::vec3(75, 70, -1e5f);
  view.pixels = 100;
  CHECK(shown_in(array, view)->values->bricks.empty());
  view.volume.points[1] = glm::vec3(100, 20, 30);
  const auto volume = shown_in(array, view);
  REQUIRE(volume->values->bricks.size() == 3);
  const ValueBrick& finest = volume->values->bricks.front();
  CHECK(finest.level == 0);
  CHECK(finest.core_first == std::array<std::uint32_t, 3>{64, 0, 0});
  CHECK(finest.value(100, 20, 30) == value_at(100, 20, 30));
  CHECK(finest.error_of(100, 20, 30) == 0.0f);
  view.volume.points[1] = glm::vec3(1000, 20, 30);
  CHECK(shown_in(array, view)->values->bricks.empty());
}

TEST_CASE("arrays of any size suit bricks, but no labels, colours and small volumes") {
  VolumeSource source;
  source.layout.dimensions = {4096, 4096, 4096};
  CHECK(ArrayVolume::suits(source, 4000));
  source.layout.labels = true;
  CHECK_FALSE(ArrayVolume::suits(source, 4000));
  source.layout.labels = false;
  source.layout.colors = true;
  CHECK_FALSE(ArrayVolume::suits(source, 4000));
  source.layout.colors = false;
  source.layout.dimensions = {0xffffffffu, 1, 1};
  CHECK_FALSE(ArrayVolume::suits(source, 4000));
  source.layout.dimensions = {0, 1000, 1000};
  CHECK_FALSE(ArrayVolume::suits(source, 4000));
  source.layout.dimensions = {20, 20, 20};
  CHECK_FALSE(ArrayVolume::suits(source, 4000));
}

TEST_CASE("bricks of an array stay within their memory") {
  const auto count = std::make_shared<ReadCount>();
  const std::size_t bytes = std::size_t{12} << 20;
  ArrayVolume array(counted({300, 300, 300}, count), limits_of(4000, bytes));
  REQUIRE(array.read_overview(std::chrono::minutes(1), {}));
  for (const float x : {0.0f, 100.0f, 200.0f, 300.0f}) {
    LodView view = close_view();
    view.eye = glm::vec3(x, 150, -100);
    (void)shown_in(array, view);
    CHECK(array.statistics().bricks > 0);
    CHECK(array.statistics().bytes <= bytes);
  }
}

TEST_CASE("fills the gaps of a partial overview of an array") {
  const auto count = std::make_shared<ReadCount>();
  const Extent chunk = GENERATE(Extent{}, Extent{16, 16, 16});
  values::ArrayLevels levels(counted(kSize, count, chunk), 2);
  values::ArrayOverview overview(levels);
  int blocks = 0;
  const int most = chunk == Extent{} ? 12 : 150;
  REQUIRE(overview.read([&] { return blocks++ >= most; }));
  CHECK_FALSE(overview.complete());
  CHECK(overview.progress() > 0);
  const std::vector<float> part = overview.samples();
  CHECK(std::ranges::none_of(part, [](float value) { return value != value; }));
  REQUIRE(overview.read([] { return false; }));
  CHECK(overview.complete());
  const std::vector<float> all = overview.samples();
  double error = 0;
  for (std::size_t i = 0; i < all.size(); ++i) error += static_cast<double>(std::abs(all[i] - part[i]));
  CHECK(error / static_cast<double>(all.size()) < 250);
  const Extent extent = levels.layouts().back().dimensions;
  CHECK(all[(std::size_t{5} * extent[1] + 7) * extent[0] + 9] == value_at(36, 28, 20));
  CHECK(overview.level() == (chunk == Extent{} ? 2 : 1));
  SECTION("and another array takes the whole one") {
    values::ArrayOverview other(levels);
    const std::uint64_t read = count->voxels;
    CHECK_FALSE(other.restore({1, 2, 3}));
    CHECK(other.restore(overview.kept()));
    CHECK(other.complete());
    CHECK(other.samples() == all);
    CHECK(count->voxels == read);
  }
}

TEST_CASE("levels of an array use the versions of the file that have halves of its voxels") {
  const auto count = std::make_shared<ReadCount>(), halves = std::make_shared<ReadCount>(),
             thirds = std::make_shared<ReadCount>();
  VolumeSource source = counted({100, 81, 60}, count);
  VolumeSource third = counted({33, 27, 20}, thirds), half = counted({50, 40, 60}, halves);
  for (auto& axis : third.layout.axes) axis *= 3.0f;
  half.layout.axes[0] *= 2.0f;
  half.layout.axes[1] *= 2.0f;
  half.layout.origin = glm::dvec3(0.5, 0.5, 0);
  VolumeSource hostile = counted({25, 20, 15}, thirds);
  hostile.layout.axes[0] *= std::numeric_limits<float>::infinity();
  VolumeSource small = counted({1, 1, 1}, thirds);
  for (auto& axis : small.layout.axes) axis *= 4.0f;
  source.coarser = {hostile, small, third, half};
  values::ArrayLevels levels(std::move(source), 2);
  std::vector<float> values;
  REQUIRE(levels.read(1, {{0, 0, 0}, {50, 41, 30}}, values));
  CHECK(count->voxels == 0);
  CHECK(thirds->voxels == 0);
  CHECK(halves->voxels == 50 * 40 * 30);
  CHECK(values[0] == value_at(0, 0, 0));
  CHECK(values[1] == value_at(1, 0, 0));                                         // a voxel of the version
  CHECK(values[std::size_t{50} * 41] == value_at(0, 0, 2));                      // every second slice of it
  CHECK(values[std::size_t{50} * 40 + 3] == values[std::size_t{50} * 39 + 3]);   // the last row is repeated
  CHECK(levels.layouts()[1].origin == glm::dvec3(0.5, 0.5, 0));
  CHECK(levels.layouts()[1].axes[2] == glm::vec3(0, 0, 2));
  REQUIRE(levels.read(2, {{0, 0, 0}, {25, 21, 15}}, values));
  CHECK(thirds->voxels == 0);
}

TEST_CASE("keeps the overview of an array when its bricks cannot be read") {
  const auto count = std::make_shared<ReadCount>();
  VolumeSource source = counted({200, 200, 200}, count);
  const auto read = source.read_box;
  const auto broken = std::make_shared<std::atomic<bool>>(false);
  source.read_box = [read, broken](const VoxelBox& box, std::span<std::byte> to) { return !*broken && read(box, to); };
  ArrayVolume array(std::move(source), limits_of(4000));
  REQUIRE(array.read_overview(std::chrono::minutes(1), {}));
  *broken = true;
  const auto volume = shown_in(array, close_view());
  CHECK_FALSE(volume->empty());
  CHECK(volume->values->bricks.empty());
  CHECK_FALSE(array.trouble().empty());
}

}  // namespace gs::qnv
