#include "net/files/temporary_file.h"
#include "net/files/atomic_file.h"

#include <catch2/catch.hpp>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace gs::net {
namespace temporary_file_test {

std::filesystem::path fresh_folder() {
  std::string name = (std::filesystem::temp_directory_path() / "temporary_file_test-XXXXXX").string();
  REQUIRE(::mkdtemp(name.data()));
  return name;
}

std::vector<std::byte> bytes_of(const std::string& text) {
  const auto all = std::as_bytes(std::span(text));
  return {all.begin(), all.end()};
}

std::string text_in(const std::filesystem::path& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::size_t files_in(const std::filesystem::path& folder) {
  const auto all = std::filesystem::directory_iterator(folder);
  return static_cast<std::size_t>(std::distance(begin(all), end(all)));
}

TEST_CASE("temporary file: Bytes are read back at any offset, and the folder stays empty") {
  const auto folder = fresh_folder();
  {
    auto made = TemporaryFile::create(folder.string());
    REQUIRE(std::holds_alternative<TemporaryFile>(made));
    auto& file = std::get<TemporaryFile>(made);
    CHECK(file.append(bytes_of("one, ")));
    CHECK(file.append(bytes_of("two")));
    CHECK(file.size() == 8);
    std::vector<std::byte> back(3);
    CHECK(file.read(5, back));
    CHECK(back == bytes_of("two"));
    CHECK_FALSE(file.read(6, back));
    CHECK_FALSE(file.read(~std::uint64_t{0}, back));
    CHECK(files_in(folder) == 0);
  }
  const auto missing = TemporaryFile::create((folder / "missing").string());
  REQUIRE(std::holds_alternative<FileError>(missing));
  CHECK(std::get<FileError>(missing).message ==
        "cannot create a temporary file in " + (folder / "missing").string() + ": No such file or directory");
  std::filesystem::remove_all(folder);
}

TEST_CASE("atomic file: Pieces replace the file at the end only") {
  const auto folder = fresh_folder();
  const std::string path = (folder / "out").string();
  std::ofstream(path) << "old";
  {
    auto begun = AtomicFile::begin(path);
    REQUIRE(std::holds_alternative<AtomicFile>(begun));
    CHECK(std::get<AtomicFile>(begun).write(bytes_of("lost")));
  }
  CHECK(text_in(path) == "old");
  CHECK(files_in(folder) == 1);
  auto begun = AtomicFile::begin(path);
  REQUIRE(std::holds_alternative<AtomicFile>(begun));
  auto& file = std::get<AtomicFile>(begun);
  CHECK(file.write(bytes_of("abc")));
  CHECK(file.rewrite_front(bytes_of("x")));
  CHECK(file.write(bytes_of("def")));
  CHECK(text_in(path) == "old");
  CHECK_FALSE(file.commit());
  CHECK(text_in(path) == "xbcdef");
  CHECK(files_in(folder) == 1);
  std::filesystem::remove_all(folder);
}

}  // namespace temporary_file_test
}  // namespace gs::net
