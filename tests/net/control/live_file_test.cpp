#include "net/control/live_file.h"
#include "tests/app/scratch_folder.h"

#include <catch2/catch.hpp>

#include <filesystem>
#include <string>
#include <variant>

namespace gs::net::live_file_test {
namespace {

namespace fs = std::filesystem;

const std::string kToken(32, 'a');

bool is_read(const std::string& path) { return std::holds_alternative<LiveFile>(read_live_file(path)); }

}  // namespace

TEST_CASE("a simulation's file has its address, and only its user may read it") {
  const ScratchFolder folder;
  const std::string path = folder.path("run.live");
  REQUIRE_FALSE(write_live_file(path, {"node17", "*", 8123, kToken}));
  CHECK((fs::status(path).permissions() & fs::perms::all) == (fs::perms::owner_read | fs::perms::owner_write));
  const auto read = read_live_file(path);
  REQUIRE(std::holds_alternative<LiveFile>(read));
  const auto& file = std::get<LiveFile>(read);
  CHECK(file.host == "node17");
  CHECK(file.bind == "*");
  CHECK(file.port == 8123);
  CHECK(file.token == kToken);
  CHECK_FALSE(write_live_file(path, {"node18", "*", 8124, kToken}));
  fs::permissions(path, fs::perms::group_read, fs::perm_options::add);
  CHECK_FALSE(is_read(path));
}

TEST_CASE("other files are no addresses of simulations, and are not overwritten") {
  const ScratchFolder folder;
  const std::string good = "ghostspace live 1\nhost a\nbind b\nport 1\ntoken " + kToken + "\n";
  int number = 0;
  const auto reads = [&](const std::string& text) {
    const std::string path = folder.write(std::to_string(number++) + ".live", text);
    fs::permissions(path, fs::perms::owner_read | fs::perms::owner_write);
    return is_read(path);
  };
  CHECK(reads(good));
  for (std::size_t size = 0; size < good.size(); ++size) CHECK_FALSE(reads(good.substr(0, size)));
  for (const char* text : {"ghostspace live 2\n", "host\n", "\n\n\n\n\n"}) CHECK_FALSE(reads(text));
  CHECK_FALSE(reads("ghostspace live 1\nhost a/b\nbind b\nport 1\ntoken " + kToken + "\n"));
  CHECK_FALSE(reads("ghostspace live 1\nhost a\nbind b\nport 99999\ntoken " + kToken + "\n"));
  CHECK_FALSE(is_read(folder.path("missing.live")));
  const std::string other = folder.write("notes.live", "notes");
  CHECK(write_live_file(other, {"a", "b", 1, kToken}));
  CHECK(folder.read("notes.live") == "notes");
}

TEST_CASE("a server on loopback is reached on its own machine only") {
  CHECK(address_of_live({"a", "127.0.0.1", 80, kToken}, "a") == "127.0.0.1:80");
  CHECK(address_of_live({"a", "127.0.0.1", 80, kToken}, "b").empty());
  CHECK(address_of_live({"a", "*", 80, kToken}, "a") == "127.0.0.1:80");
  CHECK(address_of_live({"a", "*", 80, kToken}, "b") == "a:80");
  CHECK(address_of_live({"a", "10.0.0.7", 80, kToken}, "b") == "10.0.0.7:80");
  CHECK(address_of_live({"a", "::1", 80, kToken}, "a") == "[::1]:80");
  CHECK(address_of_live({"a", "::1", 80, kToken}, "b").empty());
  CHECK(address_of_live({"a", "fd00::7", 80, kToken}, "b") == "[fd00::7]:80");
}

}  // namespace gs::net::live_file_test
