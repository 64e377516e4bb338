#pragma once

#include <cstdlib>
#include <string>

namespace gs::app {

/// The path of the program that is tested as a whole.
inline const std::string& program() {
  static const std::string path = [] {
    const char* of_variant = std::getenv("GHOSTSPACE_PROGRAM");
    return std::string(of_variant ? of_variant : GHOSTSPACE_BINARY);
  }();
  return path;
}

}  // namespace gs::app
