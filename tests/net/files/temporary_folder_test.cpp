#include "net/files/temporary_folder.h"

#include <catch2/catch.hpp>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

namespace {

namespace fs = std::filesystem;
using gs::net::LockedFolder;
using gs::net::remove_abandoned_folders;

LockedFolder work_folder(const fs::path& parent) {
  auto folder = LockedFolder::make(parent.string(), "work");
  REQUIRE(std::holds_alternative<LockedFolder>(folder));
  return std::move(std::get<LockedFolder>(folder));
}

std::size_t count_of_entries(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

void put_x(const fs::path& path) { std::ofstream(path) << "x"; }

}  // namespace

TEST_CASE("removes a temporary folder with its owner, and those of killed processes at the next start") {
  const LockedFolder outer = work_folder(fs::temp_directory_path());
  const fs::path parent = outer.path();
  {
    LockedFolder one = work_folder(parent), two = work_folder(parent);
    put_x(one.path() + "/a");
    CHECK(fs::status(one.path()).permissions() == fs::perms::owner_all);
    CHECK(count_of_entries(parent) == 2);
    CHECK(remove_abandoned_folders(parent.string(), "work") == 0);
    one = std::move(two);
    CHECK(count_of_entries(parent) == 1);
    put_x(one.path() + "/b");
  }
  CHECK(count_of_entries(parent) == 0);
  int ready[2];
  REQUIRE(::pipe(ready) == 0);
  const pid_t child = ::fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    auto folder = LockedFolder::make(parent.string(), "work");
    put_x(std::get<LockedFolder>(folder).path() + "/left");
    (void)!::write(ready[1], "x", 1);
    for (;;) ::pause();
  }
  char byte = 0;
  REQUIRE(::read(ready[0], &byte, 1) == 1);
  CHECK(remove_abandoned_folders(parent.string(), "work") == 0);
  CHECK(count_of_entries(parent) == 1);
  ::kill(child, SIGKILL);
  REQUIRE(::waitpid(child, nullptr, 0) == child);
  ::close(ready[0]);
  ::close(ready[1]);
  CHECK(remove_abandoned_folders(parent.string(), "work") == 1);
  CHECK(count_of_entries(parent) == 0);
}

TEST_CASE("removes only folders that are certainly abandoned ones of this program") {
  const LockedFolder outer = work_folder(fs::temp_directory_path());
  const fs::path parent = outer.path();
  const auto folder = [&](const char* name, fs::perms rights = fs::perms::owner_all) {
    fs::create_directory(parent / name);
    fs::permissions(parent / name, rights);
    put_x(parent / name / "file");
  };
  folder("work");
  folder("work-");
  folder("work-abc");
  folder("work-abcdefg");
  folder("work-abc.ef");
  folder("other-abcdef");
  folder("xwork-abcdef");
  folder("work-shared", fs::perms::all);
  folder("work-group1", fs::perms::owner_all | fs::perms::group_read);
  put_x(parent / "work-file00");
  fs::create_directory_symlink("work", parent / "work-link00");
  folder("work-nested");
  folder("work-nestee");
  fs::create_directory(parent / "work-nestee" / "inner");
  folder("work-linked");
  fs::create_symlink("/etc/passwd", parent / "work-linked" / "link");
  const std::size_t before = count_of_entries(parent);
  CHECK(remove_abandoned_folders(parent.string(), "work") == 1);
  CHECK_FALSE(fs::exists(parent / "work-nested"));
  CHECK(count_of_entries(parent) == before - 1);
  CHECK(fs::exists(parent / "work" / "file"));
  CHECK(fs::exists(parent / "work-nestee" / "file"));
  CHECK(remove_abandoned_folders((parent / "nowhere").string(), "work") == 0);
  CHECK(std::holds_alternative<std::string>(LockedFolder::make((parent / "nowhere").string(), "work")));
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(parent)) fs::remove_all(entry.path(), error);
}
