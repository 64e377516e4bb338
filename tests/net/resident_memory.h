#pragma once

#include <cstddef>
#include <fstream>

#include <unistd.h>

namespace gs::net::test {

/// Returns the resident memory of this process in bytes.
inline std::size_t resident() {
  std::ifstream file("/proc/self/statm");
  std::size_t all = 0, now = 0;
  file >> all >> now;
  return now * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

}  // namespace gs::net::test
