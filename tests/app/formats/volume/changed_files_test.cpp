// Tests of files that change while they are read.
#include "app/formats/volume/volume.h"
#include "app/loading/world_loading.h"
#include "net/files/file.h"
#include "tests/app/scratch_folder.h"
#include "tests/watched.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

using namespace gs;
using namespace gs::app;

TEST_CASE("stops returning slices of a volume that was truncated after opening") {
  const ScratchFolder folder;
  static_assert(128 * 128 * 128 >= net::MappedFile::kMappedSize);
  const std::string path = folder.write("v.raw", std::string(std::size_t{128} * 128 * 128, '\7'));
  RawVolume raw;
  raw.dimensions = {128, 128, 128};
  const auto opened = open_volume(path, raw);
  REQUIRE(std::holds_alternative<qnv::VolumeSource>(opened));
  const auto& volume = std::get<qnv::VolumeSource>(opened);
  std::vector<std::byte> slice(std::size_t{128} * 128);
  REQUIRE(volume.read(100, slice));
  CHECK(slice.front() == std::byte{7});
  std::filesystem::resize_file(path, 5000);
  CHECK_FALSE(volume.read(100, slice));
  CHECK_FALSE(volume.read(0, slice));
}

TEST_CASE("reports a world that is truncated during reading, and shows its beginning") {
  const ScratchFolder folder;
  std::string text = "#VRML V2.0 utf8\nShape { geometry Box { } }\n";
  while (text.size() < (std::size_t{12} << 20) / watched_step(3)) text += "Group { children Group { } }\n";
  const std::string path = folder.write("w.wrl", text);
  WorldLoading loading(path, {});
  (void)loading.step(std::chrono::milliseconds(0));
  REQUIRE_FALSE(loading.done());
  std::filesystem::resize_file(path, 100);
  while (!loading.done()) (void)loading.step(std::chrono::milliseconds(10));
  const auto& entries = loading.diagnostics().entries();
  CHECK(std::any_of(entries.begin(), entries.end(), [](const Diagnostic& one) {
    return one.text().find("error: the file changed while it was read") != std::string::npos;
  }));
  CHECK_FALSE(loading.collect({0, 0, 10}).items.empty());
}
