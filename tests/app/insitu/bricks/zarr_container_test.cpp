#include "app/insitu/bricks/zarr_container.h"

#include <zstd.h>
#include <catch2/catch.hpp>

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace gs::app::insitu {
namespace zarr_container_test {

TEST_CASE("in situ container: paths name the group, a level or a chunk, with x last") {
  const auto group = parse_zarr_name("heat.000120.zarr/zarr.json");
  REQUIRE(group);
  CHECK(group->container == "heat.000120.zarr");
  CHECK_FALSE(group->level);
  const auto level = parse_zarr_name("a.zarr/3/zarr.json");
  REQUIRE(level);
  CHECK(level->level == 3U);
  CHECK_FALSE(level->chunk);
  const auto chunk = parse_zarr_name("a.zarr/1/c.4.5.6");
  REQUIRE(chunk);
  CHECK(chunk->chunk == Chunk{1, {6, 5, 4}});
}

TEST_CASE("in situ container: other paths are no parts of a container") {
  for (const char* path :
       {"", "zarr.json", "a.zarr", "a.zarr/", "a.zarr/zarr", "a.zarr/1", "a.zarr/1/", "a.zarr/x/zarr.json",
        "a.zarr/1/c", "a.zarr/1/c.1.2", "a.zarr/1/c.1.2.3.4", "a.zarr/1/c.1.-2.3", "a.zarr/1/c.1..3",
        "a.zarr/1/c.1.2.3 ", "a.zarr/99999999999/zarr.json", "a.zarr/-1/c.0.0.0", "a.zarr/.zattrs"}) {
    INFO(path);
    CHECK_FALSE(parse_zarr_name(path));
  }
}

TEST_CASE("in situ container: the metadata name shapes, spacings and units") {
  ZarrGrid grid{"heat \"1\"", "K", {1, 2, 3}, {0.5, 0.25, 2}, {}, 0};
  const Pyramid pyramid({128, 64, 100});
  const std::string group = zarr_group(pyramid, grid), level = zarr_level(pyramid, grid, 1);
  CHECK(group.find("\"multiscales\"") != std::string::npos);
  CHECK(group.find("\"consolidated_metadata\"") != std::string::npos);
  CHECK(group.find("heat \\\"1\\\"") != std::string::npos);
  CHECK(level.find("\"units\": \"K\"") != std::string::npos);
  CHECK(level.find("\"float32\"") != std::string::npos);
  grid.codes = {5, 0.25f};
  const std::string coded = zarr_level(pyramid, grid, 1);
  for (const char* const part : {"\"int16\"", "numcodecs.delta", "\"scale_factor\": 0.25", "\"add_offset\": 5.0"}) {
    INFO(part);
    CHECK(coded.find(part) != std::string::npos);
  }
}

TEST_CASE("in situ container: equal values need few bytes") {
  const GridIndex shape{64, 64, 61};
  const auto read = [](std::uint32_t, std::span<float> values) { std::ranges::fill(values, 1.5f); };
  ZarrGrid grid;
  ChunkEncoder encoder;
  grid.rounding = 0.1f;
  CHECK(encoder.encode(shape, read, grid).size() < 1000);
  grid.codes = rounded_scale({1.5f, 1.5f}, 0.1f);
  CHECK(encoder.encode(shape, read, grid).size() < 1000);
}

TEST_CASE("in situ container: chunks of codes have the same bytes in layers as in one piece") {
  const GridIndex shape{5, 3, 11};
  ZarrGrid grid;
  grid.codes = {0, 0.5f};
  ChunkEncoder encoder;
  std::vector<std::int16_t> codes(165);
  for (std::size_t i = 0; i < codes.size(); ++i) codes[i] = static_cast<std::int16_t>(i * i % 1000);
  const std::string packed = encoder.encode(
      shape,
      [&](std::uint32_t first, std::span<float> values) {
        for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(codes[first * 15 + i]) / 2;
      },
      grid);
  std::vector<std::uint8_t> expected(330), unpacked(330);
  shuffle_differences(codes.data(), codes.size(), 0, expected.data(), expected.data() + 165);
  REQUIRE(ZSTD_decompress(unpacked.data(), unpacked.size(), packed.data(), packed.size()) == unpacked.size());
  CHECK(unpacked == expected);
}

}  // namespace zarr_container_test
}  // namespace gs::app::insitu
