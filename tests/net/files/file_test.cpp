#include "net/files/file.h"
#include "tests/net/load_helpers.h"

#include <catch2/catch.hpp>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string_view>
#include <vector>

#include <sys/stat.h>
#include <unistd.h>

namespace {

namespace fs = std::filesystem;
using namespace gs::net;

/// Temporary folder of one test. Removes files without permissions, too.
class Folder : public gs::net::test::TemporaryFolder {
 public:
  ~Folder() {
    std::error_code error;
    fs::permissions(path(), fs::perms::owner_all, error);
  }
  [[nodiscard]] std::size_t count() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(path()), fs::directory_iterator()));
  }
};

std::span<const std::byte> byte_span_of(std::string_view text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

std::string content(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

void put(const std::string& path, std::string_view text) { std::ofstream(path, std::ios::binary) << text; }

std::string text_of(const MappedFile& file) {
  return {reinterpret_cast<const char*>(file.bytes().data()), file.bytes().size()};
}

std::string message_of(const std::string& path) {
  const auto result = map_file(path);
  REQUIRE(std::holds_alternative<FileError>(result));
  return std::get<FileError>(result).message;
}

TEST_CASE("reads small, large and empty files") {
  const Folder folder;
  const std::string large(MappedFile::kMappedSize + 12345, 'x');
  for (const std::string& text : {std::string(), std::string("#VRML V2.0 utf8"), std::string("a\0b", 3), large}) {
    put(folder / "f", text);
    auto result = map_file(folder / "f");
    REQUIRE(std::holds_alternative<MappedFile>(result));
    MappedFile first = std::get<MappedFile>(std::move(result));
    CHECK(text_of(first) == text);
    MappedFile second = std::move(first);
    CHECK(text_of(second) == text);
    CHECK(first.bytes().empty());
    MappedFile third;
    third = std::move(second);
    CHECK(text_of(third) == text);
  }
}

TEST_CASE("checks the first bytes of a large file before mapping it") {
  const Folder folder;
  put(folder / "large", "abc" + std::string(MappedFile::kMappedSize, 'x'));
  put(folder / "small", "abc");
  std::string seen;
  const auto refuse = [&seen](std::span<const std::byte> first) -> std::optional<std::string> {
    seen.assign(reinterpret_cast<const char*>(first.data()), first.size());
    return "no";
  };
  const auto refused = map_file(folder / "large", refuse);
  REQUIRE(std::holds_alternative<FileError>(refused));
  CHECK(std::get<FileError>(refused).message == "cannot open " + (folder / "large") + ": no");
  CHECK(seen == "abc" + std::string(8189, 'x'));
  const auto accepted =
      map_file(folder / "large", [](std::span<const std::byte>) { return std::optional<std::string>(); });
  CHECK(std::holds_alternative<MappedFile>(accepted));
  CHECK(std::holds_alternative<MappedFile>(map_file(folder / "small", refuse)));
}

TEST_CASE("reads the bytes of a file again after their memory was released") {
  const Folder folder;
  std::string text(MappedFile::kMappedSize + 12345, 'a');
  for (std::size_t i = 0; i < text.size(); ++i) text[i] = static_cast<char>('a' + i % 23);
  for (const std::size_t size : {std::size_t{100}, text.size()}) {
    std::ofstream(folder / "long.txt", std::ios::binary) << text.substr(0, size);
    auto opened = map_file(folder / "long.txt");
    REQUIRE(std::holds_alternative<MappedFile>(opened));
    const MappedFile& file = std::get<MappedFile>(opened);
    for (const std::size_t part : {std::size_t{0}, std::size_t{5000}, size, size + 1'000'000}) {
      file.put_aside(part);
      REQUIRE(file.bytes().size() == size);
      CHECK(std::memcmp(file.bytes().data(), text.data(), size) == 0);
      CHECK_FALSE(file.changed());
    }
  }
}

TEST_CASE("reports why a file cannot be opened") {
  const Folder folder;
  CHECK(message_of(folder / "none") == "cannot open " + (folder / "none") + ": No such file or directory");
  CHECK(message_of(folder.path()) == "cannot open " + folder.path() + ": it is a folder; expected a file");
  REQUIRE(::mkfifo((folder / "pipe").c_str(), 0600) == 0);
  CHECK(message_of(folder / "pipe") == "cannot open " + (folder / "pipe") + ": it is a pipe; expected a regular file");
  CHECK(message_of("/dev/null") == "cannot open /dev/null: it is a device; expected a regular file");
  CHECK(message_of("") == "cannot open a file without a name");
  CHECK(message_of(std::string("a\0b", 3)) == "cannot open a file name with a zero byte");
  put(folder / "f", "x");
  CHECK(message_of(folder / "f" + "/g").find("Not a directory") != std::string::npos);
  if (::geteuid() != 0) {
    fs::permissions(folder / "f", fs::perms::none);
    CHECK(message_of(folder / "f").find("Permission denied") != std::string::npos);
  }
}

TEST_CASE("reads a link to a file as the file") {
  const Folder folder;
  put(folder / "f", "abc");
  fs::create_symlink(folder / "f", folder / "link");
  CHECK(text_of(std::get<MappedFile>(map_file(folder / "link"))) == "abc");
}

TEST_CASE("reads ranges of an open file, and returns fewer bytes at its end") {
  const Folder folder;
  put(folder / "f", "0123456789");
  auto opened = gs::net::open_file(folder / "f");
  REQUIRE(std::holds_alternative<RandomAccessFile>(opened));
  RandomAccessFile first = std::get<RandomAccessFile>(std::move(opened));
  RandomAccessFile file = std::move(first);
  const auto at = [&](std::uint64_t offset, std::size_t size) {
    std::vector<std::byte> to(size, std::byte{'?'});
    const std::size_t count = file.read(offset, to);
    REQUIRE(count <= size);
    return std::string(reinterpret_cast<const char*>(to.data()), count);
  };
  CHECK(file.size() == 10);
  CHECK(at(0, 10) == "0123456789");
  CHECK(at(3, 4) == "3456");
  CHECK(at(8, 100) == "89");
  CHECK(at(10, 1).empty());
  CHECK(at(~std::uint64_t{0}, 5).empty());
  CHECK(at(std::uint64_t{1} << 63, 5).empty());
  CHECK(at(2, 0).empty());
  // A moved-from file is empty.
  std::vector<std::byte> to(4);
  CHECK(first.read(0, to) == 0);
  fs::resize_file(folder / "f", 5);
  CHECK(at(3, 4) == "34");
  CHECK(at(7, 2).empty());
  CHECK(file.size() == 10);
  fs::remove(folder / "f");
  CHECK(at(0, 5) == "01234");
  put(folder / "g", "other");
  auto other = gs::net::open_file(folder / "g");
  file = std::get<RandomAccessFile>(std::move(other));
  CHECK(at(0, 9) == "other");
  put(folder / "empty", "");
  file = std::get<RandomAccessFile>(gs::net::open_file(folder / "empty"));
  CHECK(file.size() == 0);
  CHECK(at(0, 3).empty());
  const auto refused = gs::net::open_file(folder.path());
  REQUIRE(std::holds_alternative<FileError>(refused));
  CHECK(std::get<FileError>(refused).message == "cannot open " + folder.path() + ": it is a folder; expected a file");
}

TEST_CASE("writes a file as a whole") {
  const Folder folder;
  CHECK_FALSE(write_file_atomically(folder / "f", byte_span_of("one")));
  CHECK(content(folder / "f") == "one");
  CHECK_FALSE(write_file_atomically(folder / "f", byte_span_of("two two")));
  CHECK(content(folder / "f") == "two two");
  CHECK_FALSE(write_file_atomically(folder / "empty", {}));
  CHECK(fs::file_size(folder / "empty") == 0);
  CHECK(folder.count() == 2);
}

TEST_CASE("keeps the access rights of a replaced file") {
  const Folder folder;
  put(folder / "f", "old");
  fs::permissions(folder / "f", fs::perms::owner_read | fs::perms::owner_write | fs::perms::group_read);
  CHECK_FALSE(write_file_atomically(folder / "f", byte_span_of("new")));
  CHECK(fs::status(folder / "f").permissions() ==
        (fs::perms::owner_read | fs::perms::owner_write | fs::perms::group_read));
}

TEST_CASE("changes the file behind a link and keeps the link") {
  const Folder folder;
  put(folder / "f", "old");
  fs::create_symlink("f", folder / "link");
  CHECK_FALSE(write_file_atomically(folder / "link", byte_span_of("new")));
  CHECK(content(folder / "f") == "new");
  CHECK(fs::is_symlink(folder / "link"));
  fs::create_symlink("nothing", folder / "dangling");
  const auto error = write_file_atomically(folder / "dangling", byte_span_of("x"));
  REQUIRE(error);
  CHECK(error->message.find("it is a broken link") != std::string::npos);
}

TEST_CASE("replaces regular files only") {
  const Folder folder;
  fs::create_directory(folder / "d");
  REQUIRE(::mkfifo((folder / "pipe").c_str(), 0600) == 0);
  auto error = write_file_atomically(folder / "d", byte_span_of("x"));
  REQUIRE(error);
  CHECK(error->message == "cannot write " + (folder / "d") + ": it is a folder; expected a file");
  error = write_file_atomically(folder / "pipe", byte_span_of("x"));
  REQUIRE(error);
  CHECK(fs::is_fifo(folder / "pipe"));
  REQUIRE(write_file_atomically("/dev/null", byte_span_of("x")));
  REQUIRE(write_file_atomically("", byte_span_of("x")));
  REQUIRE(write_file_atomically(std::string("a\0b", 3), byte_span_of("x")));
  error = write_file_atomically(folder / "none/f", byte_span_of("x"));
  REQUIRE(error);
  CHECK(error->message.find("No such file or directory") != std::string::npos);
  CHECK(folder.count() == 2);
}

TEST_CASE("keeps the old file if writing fails") {
  if (::geteuid() == 0) {
    WARN("skipped: root may write everywhere");
    return;
  }
  const Folder folder;
  put(folder / "f", "old");
  fs::permissions(folder.path(), fs::perms::owner_read | fs::perms::owner_exec);
  CHECK(write_file_atomically(folder / "f", byte_span_of("new")));
  fs::permissions(folder.path(), fs::perms::owner_all);
  CHECK(content(folder / "f") == "old");
  fs::permissions(folder / "f", fs::perms::owner_read);
  CHECK(write_file_atomically(folder / "f", byte_span_of("new")));
  CHECK(content(folder / "f") == "old");
  CHECK(folder.count() == 1);
}

}  // namespace
