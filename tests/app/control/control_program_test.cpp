// Tests of the program under external control: the examples of docs/control.md, without a window.
#include "tests/app/program.h"
#include "tests/app/run_program.h"
#include "tests/app/scratch_folder.h"

#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace gs::app::control_program_test {
namespace {

namespace fs = std::filesystem;

const std::string kExamples = GHOSTSPACE_TESTS "/../docs/examples/control/";

bool has(const std::string& name) {
  const bool found = run_shell("command -v " + name).status == 0;
  if (!found) WARN(name << " is not installed; skipped");
  return found;
}

/// Runs a shell line while the program listens at ./socket, and returns the output of the line. ./token holds the
/// token. Then ends the program; its output is in ./log.
Run with_program(const ScratchFolder& folder, const std::string& line, const std::string& arguments) {
  return run_shell(
      "cd " + quoted(folder.path("")) + "; " + program() + " --backend osmesa --control socket " +
      "--control-token token " + arguments + " > log 2>&1 & pid=$!; cd " + quoted(folder.path("")) +
      "; i=0; while [ ! -S socket ] || [ ! -f token ]; do sleep 0.05; i=$((i + 1)); [ $i -lt 1200 ] || break; "
      "done; " +
      line + "; kill $pid; wait $pid; echo \"status $?\"");
}

std::string world() { return "#VRML V2.0 utf8\nDEF Ground Shape { geometry Box { size 10 0.1 10 } }\n"; }

}  // namespace

TEST_CASE("runs the Python example of docs/control.md, and ends on request") {
  if (!has("python3")) return;
  const ScratchFolder folder;
  (void)folder.write("world.wrl", world());
  const Run run = with_program(
      folder, "timeout 120 python3 " + quoted(kExamples + "ghostspace_control.py") + " socket token picture.png",
      "world.wrl");
  INFO(run.output << folder.read("log"));
  CHECK(run.output.find("browser: GhostSpace ") == 0);
  CHECK(run.output.find("interface: True\nticks: 3\n") != std::string::npos);
  CHECK(run.output.find("translation: [0.9, 0, 0]\nscale: [2, 2, 2]\nviewer: [2, 2, 14]\n") != std::string::npos);
  CHECK(run.output.find("problem: parameter 'node': unknown node 'None'; expected a DEF name or Type#number\n") !=
        std::string::npos);
  CHECK(run.output.find("status 0\n") != std::string::npos);
  CHECK(folder.read("picture.png").substr(1, 3) == "PNG");
  CHECK(folder.read("log") == "ghostspace: control at socket\n");
  CHECK_FALSE(fs::exists(folder.path("socket")));
}

TEST_CASE("runs the JavaScript example of docs/control.md") {
  if (!has("node")) return;
  const ScratchFolder folder;
  (void)folder.write("world.wrl", world());
  const Run run =
      with_program(folder, "timeout 120 node " + quoted(kExamples + "control.js") + " socket token", "world.wrl");
  INFO(run.output << folder.read("log"));
  CHECK(run.output.find("browser: GhostSpace\ntranslation: [5,0,0]\nseen: 5\nproblem: parameter 'node': ") == 0);
}

TEST_CASE("ends for a client, prints the token, and reports wrong options in one line") {
  const ScratchFolder folder;
  (void)folder.write("world.wrl", world());
  const std::string at = "cd " + quoted(folder.path("")) + "; ";
  const Run none = run_shell(at + program() + " --backend osmesa --control socket none.wrl");
  CHECK(none.status == 1);
  CHECK(none.output.find("none.wrl") != std::string::npos);
  CHECK(none.output.find("ghostspace: error: no world to control; expected a file\n") != std::string::npos);
  CHECK(none.output.find("ghostspace: control token ") != std::string::npos);
  const Run there = run_shell(at + program() + " --backend osmesa --control world.wrl world.wrl");
  CHECK(there.status == 1);
  CHECK(there.output.find("world.wrl already exists and is not a socket; it is not replaced\n") != std::string::npos);
  CHECK(folder.read("world.wrl") == world());
  const Run token =
      run_shell(at + program() + " --backend osmesa --control socket --control-token world.wrl world.wrl");
  CHECK(token.status == 1);
  CHECK(folder.read("world.wrl") == world());
  CHECK(run_shell(at + program() + " --control 70000 world.wrl").status == 2);
  CHECK(run_shell(at + program() + " --control-token token world.wrl").status == 2);
  CHECK(run_shell(at + program() + " --control socket --snapshot out.png world.wrl").status == 2);
  if (!has("python3")) return;
  const Run quit = with_program(folder,
                                "timeout 60 python3 -c 'import sys; sys.path.insert(0, \"" + kExamples +
                                    "\"); import ghostspace_control as g; c = g.GhostSpace(\"socket\", \"token\"); "
                                    "c.quit()'; wait $pid; echo \"ended $?\"",
                                "world.wrl");
  INFO(quit.output << folder.read("log"));
  CHECK(quit.output.find("ended 0\n") != std::string::npos);
}

TEST_CASE("shows in docs/control.md the files that the tests run") {
  std::ifstream file(GHOSTSPACE_TESTS "/../docs/control.md");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  for (const char* name : {"ghostspace_control.py", "control.js", "control.html"}) {
    CHECK(text.find(std::string("examples/control/") + name) != std::string::npos);
    CHECK(fs::exists(kExamples + name));
  }
}

}  // namespace gs::app::control_program_test
