#include "app/commands/common/value_sample.h"

#include "tests/qnv/volume_sources.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace gs::app::value_sample_test {

TEST_CASE("spreads the rows of chunks, and visits each slice once") {
  CHECK(spread_slices(8, 2) == std::vector<std::uint32_t>{0, 1, 4, 5, 2, 3, 6, 7});
  CHECK(spread_slices(5, 2) == std::vector<std::uint32_t>{0, 1, 4, 2, 3});
  CHECK(spread_slices(0, 0).empty());
  for (const std::uint32_t slices : {1u, 7u, 64u, 100u})
    for (const std::uint32_t chunk : {0u, 1u, 3u, 64u, 1000u}) {
      std::vector<std::uint32_t> all = spread_slices(slices, chunk);
      REQUIRE(all.size() == slices);
      std::ranges::sort(all);
      for (std::uint32_t z = 0; z < slices; ++z) CHECK(all[z] == z);
    }
}

TEST_CASE("samples the values of a volume until the deadline") {
  qnv::VolumeLayout layout;
  layout.dimensions = {2, 2, 3};
  layout.type = qnv::VoxelType::u8;
  layout.missing = 9;
  const qnv::VolumeSource volume =
      test::volume_of(std::move(layout), std::vector<std::uint8_t>{1, 2, 9, 4, 5, 6, 7, 8, 9, 10, 11, 12});
  const auto now = std::chrono::steady_clock::now();
  const ValueSample all = sample_values(volume, {now + std::chrono::hours(1)});
  CHECK(all.least == 1);
  CHECK(all.most == 12);
  CHECK(all.missing == 2);
  CHECK(all.voxels == 12);
  CHECK(sample_values(volume, {now - std::chrono::hours(1)}).voxels == 0);
}

}  // namespace gs::app::value_sample_test
