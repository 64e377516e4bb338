#include "tests/app/gzip_bomb.h"
#include "tests/app/run_program.h"
#include "tests/app/scratch_folder.h"
#include "tests/watched.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

namespace gs::limits_program_test {
// Runs the program on files that request far more memory than their size, with default limits, and measures the peak
// memory. Sanitizers need more memory, so with them only the answer counts.
namespace {

using namespace app;

constexpr std::uint64_t kMax = std::uint64_t{2} << 30;
const std::string kHeader = "#VRML V2.0 utf8\nShape { geometry Box { } }\n";

/// Runs a command that writes measurements, and reads them.
Run measured(const ScratchFolder& folder, const std::string& command, const std::string& file) {
  const std::string stats = folder.path("stats.json");
  std::filesystem::remove(stats);
  Run result = run(command + " --timeout 300 --stats " + quoted(stats) + " " + quoted(file));
  INFO(result.output);
  const auto json = nlohmann::json::parse(folder.read("stats.json"), nullptr, false);
  REQUIRE(json.is_object());
  if (!watched()) CHECK(json["peak_rss_bytes"].get<std::uint64_t>() < kMax);
  return result;
}

}  // namespace

TEST_CASE("keeps gigabyte worlds and multiplying PROTO and USE below two gigabytes", "[gigabytes]") {
  const ScratchFolder folder;
  const std::size_t large = !watched() ? std::size_t{600} << 20 : std::size_t{80} << 20;
  SECTION("nodes") {
    const Run nodes =
        measured(folder, "check", folder.write("nodes.wrz", gzip_bomb(kHeader, "Group{}", large / watched_step(8))));
    if (!watched()) CHECK(nodes.output.find("more than the limit for nodes and numbers") != std::string::npos);
  }
  SECTION("numbers") {
    const Run numbers = measured(
        folder, "check",
        folder.write("numbers.wrz", gzip_bomb(kHeader + "Shape { geometry PointSet { coord Coordinate { point [ ", "0 ",
                                              large / watched_step(8))));
    if (!watched()) CHECK(numbers.output.find("unpacks to more than 250 times its size") != std::string::npos);
  }
  SECTION("a ratio that no honest file has") {
    const Run blanks =
        measured(folder, "check", folder.write("blanks.wrz", gzip_bomb(kHeader, std::string(4096, ' '), large)));
    CHECK(blanks.output.find("unpacks to more than 250 times its size") != std::string::npos);
  }
  SECTION("PROTO") {
    std::string text = kHeader + "PROTO P0 [ ] { Shape { geometry Sphere { } } }\n";
    for (int i = 1; i <= 24; ++i) {
      const std::string inner = "P" + std::to_string(i - 1) + " { } ";
      text += "PROTO P" + std::to_string(i) + " [ ] { Group { children [ " + inner + inner + "] } }\n";
    }
    const Run result = measured(folder, "check", folder.write("proto.wrl", text + "P24 { }\n"));
    CHECK(result.status == 1);
    CHECK(result.output.find("more than the limit for PROTO instances, 512 MiB") != std::string::npos);
  }
}

TEST_CASE("prints deep scenes without a text larger than they are") {
  const ScratchFolder folder;
  std::string text = "#VRML V2.0 utf8\n", end;
  for (int i = 0; i < 900; ++i) {
    text += "Group { children [ ";
    end += "] } ";
  }
  for (int i = 0; i < 2000; ++i) text += "Shape { } ";
  const Run result = run("print " + quoted(folder.write("deep.wrl", text + end)));
  CHECK(result.status == 0);
  CHECK(result.output.size() < 1'000'000);
  // The printed world prints equal text again.
  const Run again = run("print " + quoted(folder.write("again.wrl", result.output)));
  CHECK(again.output == result.output);
}

TEST_CASE("--memory takes a size, and lowers and raises the limits") {
  const ScratchFolder folder;
  std::string text = kHeader;
  for (int i = 0; i < 100'000; ++i) text += "Group { } ";
  const std::string file = quoted(folder.write("groups.wrl", text));
  CHECK(run("check " + file).status == 0);
  const Run small = run("check --memory 16M " + file);
  CHECK(small.status == 1);
  CHECK(small.output.find("more than the limit for nodes and numbers, 8 MiB of one world (--memory raises it)") !=
        std::string::npos);
  CHECK(run("check --memory 1G " + file).status == 0);
  for (const char* wrong : {"1", "16", "x", "16Q", "-16M", "99999999999999999G"})
    CHECK(run("check --memory " + std::string(wrong) + " " + file).status == 2);
}

}  // namespace gs::limits_program_test
