#include "app/formats/volume/held_values.h"

#include "app/formats/volume/coarser_volume.h"
#include "qnv/sampling/volume/volume_slices.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace gs::app::held_values_test {
namespace {

/// Volume in which voxel (x, y, z) has the value x + 10 y + 100 z. Counts the slices that are read.
qnv::VolumeSource numbered(std::array<std::uint32_t, 3> size, const std::shared_ptr<std::vector<std::uint32_t>>& read) {
  qnv::VolumeSource source;
  source.layout.dimensions = size;
  source.layout.type = qnv::VoxelType::u16;
  source.layout.slope = 2;
  source.read = [size, read](std::uint32_t z, std::span<std::byte> to) {
    read->push_back(z);
    std::size_t at = 0;
    for (std::uint32_t y = 0; y < size[1]; ++y)
      for (std::uint32_t x = 0; x < size[0]; ++x) {
        const std::uint32_t value = x + 10 * y + 100 * z;
        to[at++] = static_cast<std::byte>(value & 255);
        to[at++] = static_cast<std::byte>(value >> 8);
      }
    return z < size[2];
  };
  return source;
}

std::vector<float> slice_of(const qnv::VolumeSource& source, std::uint32_t z) {
  std::vector<float> values(qnv::slice_voxels(source.layout));
  std::vector<std::byte> scratch;
  REQUIRE(qnv::read_slice(source, z, scratch, values));
  return values;
}

TEST_CASE("held values: Values in memory are those of the source, which is read once") {
  const auto read = std::make_shared<std::vector<std::uint32_t>>();
  const qnv::VolumeSource source = numbered({7, 5, 6}, read);
  const Progress progress;
  const auto values = hold_values(source, own_budget(), progress);
  REQUIRE(values);
  CHECK(read->size() == 6);
  CHECK(values->exact);
  CHECK(values->range == std::pair<float, float>(0.0f, 2.0f * 546));
  for (const std::uint32_t z : {5u, 0u, 3u})
    CHECK(slice_of(values->source, z).back() == 2.0f * static_cast<float>(46 + 100 * z));
  std::vector<std::byte> slice(70);
  CHECK_FALSE(values->source.read(6, slice));
}

TEST_CASE("held values: Components stay apart, and a source that fails gives none") {
  const auto read = std::make_shared<std::vector<std::uint32_t>>();
  qnv::VolumeSource source = numbered({3, 3, 3}, read);
  source.components = {numbered({3, 3, 3}, read), numbered({3, 3, 3}, read)};
  source.components[1].layout.slope = 5;
  const Progress progress;
  const auto values = hold_values(source, own_budget(), progress);
  REQUIRE(values);
  REQUIRE(values->components.size() == 2);
  CHECK(values->components[1]->range.second == 5.0f * 222);
  qnv::VolumeSource failing = source;
  failing.components[1].read = [](std::uint32_t, std::span<std::byte>) { return false; };
  CHECK_FALSE(hold_values(failing, own_budget(), progress));
  Progress cancelled;
  cancelled.cancelled = true;
  CHECK_FALSE(hold_values(source, own_budget(), cancelled));
  Limits limits;
  limits.memory = 1 << 20;
  CHECK_FALSE(hold_values(numbered({1024, 1024, 64}, read), std::make_shared<Budget>(limits), progress));
}

TEST_CASE("coarser volume: A thinned volume has every nth voxel at its place and reads only its slices") {
  const auto read = std::make_shared<std::vector<std::uint32_t>>();
  const qnv::VolumeSource coarse = thinned(numbered({7, 5, 6}, read), 3);
  CHECK(coarse.layout.dimensions == std::array<std::uint32_t, 3>{3, 2, 2});
  CHECK(coarse.layout.axes[1] == glm::vec3(0, 3, 0));
  CHECK(slice_of(coarse, 1) == std::vector<float>{600, 606, 612, 660, 666, 672});
  CHECK(*read == std::vector<std::uint32_t>{3});
  qnv::VolumeSource small = numbered({64, 64, 64}, read);
  add_coarser(small);
  CHECK(small.coarser.empty());
  qnv::VolumeSource large = numbered({1024, 512, 300}, read);
  add_coarser(large);
  REQUIRE(large.coarser.size() == 1);
  CHECK(qnv::voxel_count(large.coarser.front().layout) < 3 * kQuickVoxels);
  CHECK(qnv::voxel_count(large.coarser.front().layout) > kQuickVoxels / 3);
}

}  // namespace
}  // namespace gs::app::held_values_test
