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

TEST_CASE("ends on SIGTERM and SIGINT within a second while a Script hangs") {
  for (const std::string signal : {"TERM", "INT"}) {
    const ScratchFolder folder;
    (void)folder.write("world.wrl", world());
    // A shell ignores SIGINT in background jobs; env restores the default.
    const Run run = run_shell(
        "cd " + quoted(folder.path("")) + "; env --default-signal=INT " + program() +
        " --backend osmesa --control socket --control-token token world.wrl > log 2>&1 & pid=$!; cd " +
        quoted(folder.path("")) + "; sleep 3; kill -" + signal +
        " $pid; (sleep 60; kill -KILL $pid) > /dev/null 2>&1 & killer=$!; from=$(date +%s%N); wait $pid; echo \"status "
        "$?\"; echo \"$((($(date +%s%N) - from) / 1000000)) ms\"; kill $killer");
    INFO(signal << run.output << folder.read("log"));
    CHECK(run.output.find("status 0\n") != std::string::npos);
    const std::size_t end = run.output.find(" ms\n");
    REQUIRE(end != std::string::npos);
    CHECK(std::stoi(run.output.substr(run.output.rfind('\n', end) + 1)) < 2000);  // usually 100; machines may be busy
  }
}

TEST_CASE("goes on without programs when a Script cannot be interrupted") {
  const ScratchFolder folder;
  (void)folder.write("world.wrl", world());
  for (const std::string command : {"--backend osmesa --snapshot out.png world.wrl", "trace world.wrl --until 1"}) {
    const Run run = run_shell("cd " + quoted(folder.path("")) + "; timeout -s KILL 60 " + program() + " " + command);
    INFO(command << ": " << run.output);
    CHECK(run.status == 0);
    CHECK(run.output.find("Script S: the program exceeded the time limit and cannot be interrupted; all programs of "
                          "this world end\n") != std::string::npos);
  }
}

}  // namespace gs::app::overdue_script_program_test
