#pragma once

#include "tests/app/program.h"

#include <catch2/catch.hpp>

#include <sys/wait.h>

#include <array>
#include <cstddef>
#include <cstdio>
#include <string>

namespace gs::app {

/// Exit status of a run, and its output.
struct Run {
  int status;
  std::string output;  // stdout and stderr
};

/// Runs a shell line. Returns the output, except redirected output.
inline Run run_shell(const std::string& line) {
  // AddressSanitizer would print suppressed leaks at the end.
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

/// Runs the program through the shell.
inline Run run(const std::string& arguments) { return run_shell(program() + " " + arguments); }

inline std::string quoted(const std::string& path) { return "'" + path + "'"; }

}  // namespace gs::app
