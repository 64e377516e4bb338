#pragma once

#include <cstdlib>
#include <string>

namespace gs::app {

/// Returns the path of the tested program.
inline const std::string& program() {
  static const std::string path = [] {
    const char* of_variant = std::getenv("GHOSTSPACE_PROGRAM");
    return std::string(of_variant ? of_variant : GHOSTSPACE_BINARY);
  }();
  return path;
}

}  // namespace gs::app
