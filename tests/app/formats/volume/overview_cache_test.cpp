#include "app/formats/volume/overview_cache.h"
#include "app/formats/datasets/arrays/box_pieces.h"
#include "qnv/sampling/volume/volume_slices.h"
#include "tests/app/scratch_folder.h"

#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace gs::app {
namespace overview_cache_test {

namespace fs = std::filesystem;

std::vector<fs::path> files_in(const std::string& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
  return files;
}

}  // namespace overview_cache_test
using namespace overview_cache_test;

TEST_CASE("keeps overviews of arrays in a folder") {
  const ScratchFolder scratch;
  const std::string folder = scratch.path("overviews");
  const OverviewCache cache(folder, 100'000);
  const std::vector<float> samples(1000, 2.5f), others(5000, 1.0f);
  CHECK_FALSE(cache.find("a"));
  cache.keep("a", samples);
  REQUIRE(cache.find("a"));
  CHECK(*cache.find("a") == samples);
  CHECK_FALSE(cache.find("b"));
  SECTION("a damaged file counts as absent") {
    REQUIRE(files_in(folder).size() == 1);
    const fs::path path = files_in(folder).front();
    SECTION("in its samples") {
      std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
      file.seekp(2000);
      file.put('x');
    }
    SECTION("at its end") { fs::resize_file(path, fs::file_size(path) - 1); }
    SECTION("in its head") {
      std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
      file.seekp(16);
      file.write("\xff\xff\xff\xff\xff\xff\xff\x7f", 8);
    }
    CHECK_FALSE(cache.find("a"));
  }
  SECTION("the oldest files are removed") {
    for (int i = 0; i < 8; ++i) {
      cache.keep("other " + std::to_string(i), others);
      fs::last_write_time(files_in(folder).front(), fs::file_time_type::clock::now());
    }
    std::uintmax_t bytes = 0;
    for (const fs::path& path : files_in(folder)) bytes += fs::file_size(path);
    CHECK(bytes <= 100'000);
    CHECK(cache.find("other 7"));
  }
  SECTION("large overviews are not kept") {
    cache.keep("large", std::vector<float>(10'000));
    CHECK_FALSE(cache.find("large"));
  }
}

TEST_CASE("the key of an overview changes with the file and the part of it") {
  const ScratchFolder scratch;
  const std::string path = scratch.write("a.raw", std::string(std::size_t{2} << 20, 'x'));
  qnv::VolumeLayout layout;
  layout.dimensions = {128, 128, 128};
  const auto key = overview_key(path, {}, layout);
  REQUIRE(key);
  CHECK(overview_key(path, {}, layout) == key);
  VoxelComponent other;
  other.dataset = "other";
  CHECK(overview_key(path, other, layout) != key);
  layout.dimensions[0] = 127;
  CHECK(overview_key(path, {}, layout) != key);
  layout.dimensions[0] = 128;
  scratch.write("a.raw", std::string((std::size_t{2} << 20) + 1, 'x'));
  CHECK(overview_key(path, {}, layout) != key);
  CHECK_FALSE(overview_key(scratch.write("small.hdr", "x"), {}, layout));
  CHECK_FALSE(overview_key(scratch.path("absent"), {}, layout));
  CHECK(overview_folder("/home/x/.cache/ghostspace/http") == "/home/x/.cache/ghostspace/overviews");
  CHECK(overview_folder("").empty());
}

TEST_CASE("pieces of a box have each sample once, and no chunks without samples") {
  const std::array<std::uint32_t, 3> chunk = GENERATE(std::array<std::uint32_t, 3>{0, 0, 0},
                                                      std::array<std::uint32_t, 3>{16, 8, 4},
                                                      std::array<std::uint32_t, 3>{1, 1, 1000});
  const qnv::VoxelBox box = GENERATE(qnv::VoxelBox{{5, 6, 7}, {20, 11, 13}, {1, 1, 1}},
                                     qnv::VoxelBox{{0, 0, 0}, {6, 5, 4}, {33, 17, 20}},
                                     qnv::VoxelBox{{3, 0, 1}, {40, 3, 30}, {2, 9, 1}});
  std::uint64_t samples = 0;
  CHECK(for_each_piece(box, chunk, 2, [&](const BoxPiece& piece) {
    samples += std::uint64_t{piece.samples[0]} * piece.samples[1] * piece.samples[2];
    for (std::size_t a = 0; a < 3; ++a) {
      CHECK(piece.voxels.first[a] == box.first[a] + piece.at[a] * box.step[a]);
      CHECK(piece.voxels.size[a] == (piece.samples[a] - 1) * box.step[a] + 1);
      // A piece of several samples has no gap of a whole chunk, except in rows.
      if (box.step[a] > std::max(chunk[a], 1u) && !(a == 0 && chunk[0] == 0)) CHECK(piece.samples[a] == 1);
    }
    return true;
  }));
  CHECK(samples == qnv::voxel_count(box));
  int calls = 0;
  CHECK_FALSE(for_each_piece(box, chunk, 2, [&](const BoxPiece&) { return ++calls > 100000; }));
  CHECK(calls == 1);
}

}  // namespace gs::app
