#include "app/base/exit_status.h"
#include "tests/app/run_program.h"
#include "tests/app/scratch_folder.h"

#include <catch2/catch.hpp>

#include <string>

namespace gs::app::snapshot_test {
namespace {

const std::string kFaults = R"(#VRML V2.0 utf8
DEF Broken Script { url "javascript:
  function initialize() { print('not an error'); missing.value = 1; }" }
Shape { geometry Box { } }
)";

}  // namespace

TEST_CASE("prints errors of Scripts with --snapshot and animate, and counts them") {
  const ScratchFolder folder;
  const std::string file = folder.write("world.wrl", kFaults), picture = folder.path("out.png");
  const Run drawn = run("--snapshot " + quoted(picture) + " --size 32x32 --stats - " + quoted(file));
  CHECK(drawn.status == kDone);
  CHECK(drawn.output.find("world.wrl:3:50: error: Script Broken: ") != std::string::npos);
  CHECK(drawn.output.find("\"errors\": 1") != std::string::npos);
  CHECK(drawn.output.find("not an error") == std::string::npos);

  const Run moved = run("animate --turntable --frames 2 --size 32x32 " + quoted(file) + " " +
                        quoted(folder.path("out.%02d.png")));
  CHECK(moved.output.find("world.wrl:3:50: error: Script Broken: ") != std::string::npos);
}

}  // namespace gs::app::snapshot_test
