// Tests of the program with a Script inside one engine operator that takes hours and cannot be interrupted.
#include "tests/app/program.h"
#include "tests/app/run_program.h"
#include "tests/app/scratch_folder.h"

#include <catch2/catch.hpp>

#include <string>

namespace gs::app::overdue_script_program_test {
namespace {

std::string world() {
  return "#VRML V2.0 utf8\nDEF S Script { url \"javascript: function initialize() { print(+('0.' + '1'.repeat(1 << "
         "23)));"
         " }\" }\n";
}

}  // namespace

TEST_CASE("ends on SIGTERM and SIGINT while a Script is overdue") {
  for (const std::string signal : {"TERM", "INT"}) {
    const ScratchFolder folder;
    (void)folder.write("world.wrl", world());
    // A shell ignores SIGINT in background jobs; env restores the default.
    const Run run =
        run_shell("cd " + quoted(folder.path("")) + "; env --default-signal=INT " + program() +
                  " --backend osmesa --control socket --control-token token world.wrl > log 2>&1 & pid=$!; cd " +
                  quoted(folder.path("")) + "; sleep 8; kill -" + signal +
                  " $pid; (sleep 60; kill -KILL $pid) > /dev/null 2>&1 & "
                  "killer=$!; wait $pid; echo \"status $?\"; kill $killer");
    INFO(signal << run.output << folder.read("log"));
    CHECK(run.output.find("status 1\n") != std::string::npos);
    CHECK(folder.read("log").find(
              "Script S: the program exceeded the time limit; it cannot be interrupted, so GhostSpace exits\n") !=
          std::string::npos);
  }
}

TEST_CASE("ends a command without a window when a Script is overdue") {
  const ScratchFolder folder;
  (void)folder.write("world.wrl", world());
  for (const std::string command : {"--backend osmesa --snapshot out.png world.wrl", "trace world.wrl --until 1"}) {
    const Run run = run_shell("cd " + quoted(folder.path("")) + "; timeout -s KILL 60 " + program() + " " + command);
    INFO(command << ": " << run.output);
    CHECK(run.status == 1);
    CHECK(run.output.find(
              "Script S: the program exceeded the time limit; it cannot be interrupted, so the command exits\n") !=
          std::string::npos);
  }
}

}  // namespace gs::app::overdue_script_program_test
