#include "net/files/unfinished_file.h"

#include "net/files/file.h"
#include "net/files/temporary_folder.h"

#include <catch2/catch.hpp>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

namespace {

namespace fs = std::filesystem;
using namespace gs::net;

LockedFolder outer_folder() {
  auto folder = LockedFolder::make(fs::temp_directory_path().string(), "unfinished-test");
  REQUIRE(std::holds_alternative<LockedFolder>(folder));
  return std::move(std::get<LockedFolder>(folder));
}

std::vector<std::string> entries(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename().string());
  return names;
}

void put_text(const fs::path& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }
std::string text_in(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::optional<gs::net::FileError> write_text(const fs::path& path, const std::string& text) {
  return write_file_atomically(path.string(), std::as_bytes(std::span(text)));
}

}  // namespace

TEST_CASE("removes the unfinished file of a killed process and no file of a living one") {
  const LockedFolder outer = outer_folder();
  int ready[2];
  REQUIRE(::pipe(ready) == 0);
  const pid_t child = ::fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    const UnfinishedFile file = create_unfinished_file(outer.path() + "/");
    (void)!::write(ready[1], file.file ? "x" : "-", 1);
    for (;;) ::pause();
  }
  char byte = 0;
  REQUIRE(::read(ready[0], &byte, 1) == 1);
  REQUIRE(byte == 'x');
  const UnfinishedFile own = create_unfinished_file(outer.path() + "/");
  REQUIRE(own.file);
  CHECK(remove_unfinished_files(outer.path()) == 0);
  CHECK(entries(outer.path()).size() == 2);
  ::kill(child, SIGKILL);
  REQUIRE(::waitpid(child, nullptr, 0) == child);
  ::close(ready[0]);
  ::close(ready[1]);
  CHECK(remove_unfinished_files(outer.path()) == 1);
  CHECK(fs::path(own.path).filename() == entries(outer.path()).at(0));
}

TEST_CASE("removes a leftover of a reused process number") {
  const LockedFolder outer = outer_folder();
  const fs::path leftover = fs::path(outer.path()) / (".ghostspace-" + std::to_string(::getpid()) + "-4000000000");
  put_text(leftover, "left");
  CHECK(remove_unfinished_files(outer.path()) == 1);
  CHECK_FALSE(fs::exists(leftover));
}

TEST_CASE("keeps a file unless it is certainly an unfinished file of this user") {
  const LockedFolder outer = outer_folder();
  const fs::path folder = outer.path();
  for (const char* name : {".ghostspace-1", ".ghostspace-", ".ghostspace--1", ".ghostspace-1-", ".ghostspace-a-1",
                           ".ghostspace-1-1.png", ".ghostspace-1-1-1", ".ghostspace-01-1", ".ghostspace-1-01",
                           "x.ghostspace-1-1", "ghostspace-1-1", ".ghostspace-12345678901-1", ".ghostspace-1- 1"})
    put_text(folder / name, "x");
  fs::create_directory(folder / ".ghostspace-2-0");
  put_text(folder / "target", "x");
  fs::create_symlink("target", folder / ".ghostspace-2-1");
  fs::create_hard_link(folder / "target", folder / ".ghostspace-2-2");
  REQUIRE(::mkfifo((folder / ".ghostspace-2-3").c_str(), 0600) == 0);
  const std::size_t before = entries(folder).size();
  put_text(folder / ".ghostspace-2-4", "x");
  if (::geteuid() == 0) {
    put_text(folder / ".ghostspace-2-5", "x");
    REQUIRE(::chown((folder / ".ghostspace-2-5").c_str(), 12345, 12345) == 0);
  }
  CHECK(remove_unfinished_files(outer.path()) == 1);
  CHECK_FALSE(fs::exists(folder / ".ghostspace-2-4"));
  CHECK(entries(folder).size() == before + (::geteuid() == 0 ? 1 : 0));
  CHECK(text_in(folder / "target") == "x");
  CHECK(remove_unfinished_files((folder / "nowhere").string()) == 0);
  fs::remove(folder / ".ghostspace-2-0");
  fs::remove(folder / ".ghostspace-2-1");
  fs::remove(folder / ".ghostspace-2-3");
}

TEST_CASE("writes files while another thread removes unfinished ones") {
  const LockedFolder outer = outer_folder();
  const fs::path folder = outer.path();
  constexpr int kRounds = 200;
  std::jthread cleaner([&](const std::stop_token& stop) {
    while (!stop.stop_requested()) (void)remove_unfinished_files(outer.path());
  });
  std::vector<std::string> problems;
  for (int i = 0; i < kRounds; ++i)
    if (const auto problem = write_text(folder / "out", std::to_string(i))) problems.push_back(problem->message);
  cleaner.request_stop();
  cleaner.join();
  CHECK(problems.empty());
  CHECK(text_in(folder / "out") == std::to_string(kRounds - 1));
  CHECK(entries(folder).size() == 1);
}
