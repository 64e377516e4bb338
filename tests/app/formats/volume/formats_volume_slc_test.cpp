#include "tests/app/volume_files.h"

namespace gs::app::slc_test {

using namespace gs::test;

// Returns 3 x 2 x 2 voxels of kValues, and an icon of 2 x 1.
std::string slc(int compression, const std::string& slices) {
  return "11111\n3 2 2 8\n1.0 2.0 3.0\n2 5 0 " + std::to_string(compression) + "\n2 1 X" + "rgbrgb" + slices;
}
std::string raw_slice(std::size_t z) {
  std::string bytes;
  for (std::size_t i = 0; i < 6; ++i) bytes += static_cast<char>(kValues[6 * z + i]);
  return bytes;
}
// Literal bytes, with the last two as runs of one.
std::string packed_slice(std::size_t z) {
  const std::string raw = raw_slice(z);
  std::string packed = std::string(1, static_cast<char>(128 | 4)) + raw.substr(0, 4);
  packed += std::string(1, '\x01') + raw[4] + std::string(1, '\x01') + raw[5] + std::string(1, '\0');
  return std::to_string(packed.size()) + " X" + packed;
}

TEST_CASE("SLC: reads plain and run-length encoded slices") {
  const ScratchFolder folder;
  for (const std::string& text : {slc(0, raw_slice(0) + raw_slice(1)), slc(1, packed_slice(0) + packed_slice(1))}) {
    const qnv::VolumeSource source = opened(folder.write("x.data", text));
    CHECK(source.layout.dimensions == std::array<std::uint32_t, 3>{3, 2, 2});
    CHECK(source.layout.axes[1] == glm::vec3(0, 2, 0));
    CHECK(source.layout.axes[2] == glm::vec3(0, 0, 3));
    check_values(source);
  }
}

TEST_CASE("SLC: reads runs of one value") {
  const ScratchFolder folder;
  const std::string run("\x06\x07\x00", 3);
  const qnv::VolumeSource source = opened(folder.write("a.slc", slc(1, "3 X" + run + "3 X" + run)));
  std::vector<std::byte> slice(6);
  REQUIRE(source.read(1, slice));
  CHECK(slice == std::vector<std::byte>(6, std::byte{7}));
}

TEST_CASE("SLC: reports errors") {
  const ScratchFolder folder;
  const std::string whole = slc(1, packed_slice(0) + packed_slice(1));
  for (std::size_t length = 5; length + 1 < whole.size(); ++length)
    CHECK_FALSE(problem_of(folder.write("a.slc", whole.substr(0, length))).empty());
  const std::string long_run("\x07\x07\x00", 3), short_run("\x05\x07\x00", 3), cut_run("\x86\x07\x00", 3);
  for (const std::string& one : {long_run, short_run, cut_run})
    CHECK(problem_of(folder.write("a.slc", slc(1, "3 X" + one + "3 X" + one))).find("slice 1 of 2 is damaged") !=
          std::string::npos);
  CHECK(problem_of(folder.write("a.slc", slc(2, ""))).find("compression") != std::string::npos);
  CHECK(problem_of(folder.write("a.slc", "11111\n3 2 2 16\n1 1 1\n2 5 0 0\n0 0 X")).find("8") != std::string::npos);
  CHECK_FALSE(
      problem_of(folder.write("a.slc", "11111\n4294967295 4294967295 4294967295 8\n1 1 1\n2 5 0 1\n0 0 X")).empty());
}

TEST_CASE("takes the title of a NRRD file from its content unless that is a history") {
  const ScratchFolder folder;
  const auto metadata = [&](const std::string& content) {
    return opened(folder.write("a.nrrd", "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 3 2 2\nencoding: raw\ncontent: " +
                                             content + "\n\n" + raw_slice(0) + raw_slice(1)))
        .layout.metadata;
  };
  const auto has = [](const auto& pairs, const std::string& key, const std::string& value) {
    return std::any_of(pairs.begin(), pairs.end(),
                       [&](const auto& pair) { return pair.first == key && pair.second == value; });
  };
  CHECK(has(metadata("A tooth"), "title", "A tooth"));
  CHECK_FALSE(has(metadata("crop(tooth,[51,153])"), "title", "crop(tooth,[51,153])"));
  CHECK(has(metadata("crop(tooth,[51,153])"), "content", "crop(tooth,[51,153])"));
}

}  // namespace gs::app::slc_test
