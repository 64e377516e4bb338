#pragma once

#include "tests/app/program.h"

#include <catch2/catch.hpp>

#include <sys/wait.h>

#include <array>
#include <cstddef>
#include <cstdio>
#include <string>

namespace gs::app {

/// How a run of the program ended, and all that it printed.
struct Run {
  int status;
  std::string output;  // stdout and stderr
};

/// Runs a line of the shell; what its parts print elsewhere is not told.
inline Run run_shell(const std::string& line) {
  // Under AddressSanitizer the program would tell at its end which known leaks it passed over.
  FILE* pipe = popen(("export LSAN_OPTIONS=print_suppressions=0; { " + line + "; } 2>&1").c_str(), "r");
  REQUIRE(pipe);
  Run result{0, {}};
  std::array<char, 4096> buffer;
  while (const std::size_t count = fread(buffer.data(), 1, buffer.size(), pipe))
    result.output.append(buffer.data(), count);
  const int status = pclose(pipe);
  result.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return result;
}

/// Runs the program as a user does, through the shell.
inline Run run(const std::string& arguments) { return run_shell(program() + " " + arguments); }

inline std::string quoted(const std::string& path) { return "'" + path + "'"; }

}  // namespace gs::app
