#include "net/files/part_files.h"

#include "net/files/file.h"

#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>
#include <string>

namespace gs::net {
namespace part_files_test {

std::vector<std::byte> bytes_of(std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

PartFiles made(const std::string& folder, std::uint32_t number) {
  auto files = PartFiles::create(folder, number);
  REQUIRE(std::holds_alternative<PartFiles>(files));
  return std::get<PartFiles>(std::move(files));
}

std::string new_folder() {
  std::string name = std::filesystem::temp_directory_path() / "ghostspace-parts-XXXXXX";
  REQUIRE(::mkdtemp(name.data()) != nullptr);
  return name;
}

TEST_CASE("part files: Each process reads the bytes of all, and finished work of earlier runs") {
  const std::string top = new_folder(), folder = top + "/out.parts";
  REQUIRE_FALSE(prepare_part_folder(folder, "task", false));
  {
    PartFiles one = made(folder, 1), two = made(folder, 2);
    const std::uint64_t first = one.size(), second = two.size();
    CHECK(first != second);
    REQUIRE(one.append(bytes_of("abc")));
    REQUIRE(two.append(bytes_of("defgh")));
    std::vector<std::byte> got(3);
    CHECK(one.read(second + 1, got));
    CHECK(got == bytes_of("efg"));
    CHECK(two.read(first, got));
    CHECK(got == bytes_of("abc"));
    CHECK_FALSE(two.read(first + 1, got));
    CHECK_FALSE(two.read(std::uint64_t{9} << PartFiles::kPartBits, got));
    REQUIRE(one.finish("a", first, bytes_of("result of a")));
    REQUIRE(one.append(bytes_of("more")));
    REQUIRE(one.finish("b", first + 3, bytes_of("")));
    REQUIRE(two.finish("c", second + 2, bytes_of("c")));
    CHECK_FALSE(one.finished("a"));
  }
  CHECK(free_part_number(folder) == 3);
  REQUIRE_FALSE(prepare_part_folder(folder, "task", true));
  {
    const PartFiles later = made(folder, 3);
    CHECK(later.finished("a") == bytes_of("result of a"));
    CHECK(later.finished("b") == bytes_of(""));
    CHECK(later.finished("c") == bytes_of("c"));
    CHECK_FALSE(later.finished("d"));
  }
  remove_part_folder(folder);
  CHECK_FALSE(std::filesystem::exists(folder));
  std::filesystem::remove_all(top);
}

TEST_CASE("part files: Damaged bytes and truncated lists are not taken for finished work") {
  const std::string top = new_folder(), folder = top + "/out.parts";
  REQUIRE_FALSE(prepare_part_folder(folder, "task", false));
  {
    PartFiles one = made(folder, 1);
    for (const std::string_view work : {"a", "b", "c"}) {
      const std::uint64_t first = one.size();
      REQUIRE(one.append(bytes_of("bytes of work")));
      REQUIRE(one.finish(work, first, bytes_of("result")));
    }
  }
  {
    std::fstream data(folder + "/1.data", std::ios::in | std::ios::out | std::ios::binary);
    data.seekp(15);
    data.put('X');
  }
  const auto size = std::filesystem::file_size(folder + "/1.done");
  std::filesystem::resize_file(folder + "/1.done", size - 1);
  {
    const PartFiles later = made(folder, 2);
    CHECK(later.finished("a"));
    CHECK_FALSE(later.finished("b"));
    CHECK_FALSE(later.finished("c"));
  }
  for (std::size_t at = 0; at + 1 < size; at += 7) {
    std::fstream list(folder + "/1.done", std::ios::in | std::ios::out | std::ios::binary);
    list.seekp(static_cast<std::streamoff>(at));
    list.put('\xff');
    list.close();
    std::filesystem::remove(folder + "/2.data");
    std::filesystem::remove(folder + "/2.done");
    const PartFiles later = made(folder, 2);
    CHECK_FALSE(later.finished("c"));
  }
  std::filesystem::remove_all(top);
}

TEST_CASE("part files: Only the same task is resumed, and foreign files stay") {
  const std::string top = new_folder(), folder = top + "/out.parts";
  REQUIRE_FALSE(prepare_part_folder(folder, "task", true));
  REQUIRE_FALSE(prepare_part_folder(folder, "task", true));
  auto other = prepare_part_folder(folder, "another", true);
  REQUIRE(other);
  CHECK_THAT(other->message, Catch::Contains("another input or other options"));
  std::ofstream(folder + "/letter.txt") << "mine";
  CHECK(prepare_part_folder(folder, "task", false));
  CHECK(std::filesystem::exists(folder + "/letter.txt"));
  std::filesystem::remove_all(top);
}

TEST_CASE("part files: A folder of a run that ended before its key was complete is used again") {
  const std::string top = new_folder(), folder = top + "/out.parts";
  for (const bool resume : {false, true}) {
    std::filesystem::create_directory(folder);
    REQUIRE_FALSE(prepare_part_folder(folder, "task", resume));
    remove_part_folder(folder);
    std::filesystem::create_directory(folder);
    std::ofstream(folder + "/.ghostspace-key") << "ta";
    REQUIRE_FALSE(prepare_part_folder(folder, "task", resume));
    CHECK_FALSE(std::filesystem::exists(folder + "/.ghostspace-key"));
    CHECK_FALSE(prepare_part_folder(folder, "task", true));
    CHECK(prepare_part_folder(folder, "another", true));
    remove_part_folder(folder);
    CHECK_FALSE(std::filesystem::exists(folder));
  }
  std::filesystem::remove_all(top);
}

TEST_CASE("part files: The task may have many input files") {
  const std::string top = new_folder(), folder = top + "/out.parts", task(300'000, 'x');
  REQUIRE_FALSE(prepare_part_folder(folder, task, false));
  CHECK_FALSE(prepare_part_folder(folder, task, true));
  CHECK(prepare_part_folder(folder, task + "y", true));
  CHECK_FALSE(prepare_part_folder(folder, task, false));
  remove_part_folder(folder);
  CHECK_FALSE(std::filesystem::exists(folder));
  std::filesystem::remove_all(top);
}

}  // namespace part_files_test
}  // namespace gs::net
