#pragma once

#include <cstdint>
#include <cstdio>
#include <stdexcept>
#include <string>

namespace gs::simulation {

/// Invariant that a session violated.
struct Violation : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Throws a Violation unless `holds`.
inline void require(bool holds, const std::string& what) {
  if (!holds) throw Violation(what);
}

/// Log of what happened in a session, as a hash. Two runs of one seed must have equal hashes.
class Trace {
 public:
  /// Prints the lines, too, if `prints`.
  explicit Trace(bool prints = false) : prints_(prints) {}

  /// Adds a line. `at` is in microseconds of simulated time.
  void note(std::int64_t at, const std::string& line) {
    add(std::to_string(at));
    add(line);
    if (prints_) std::printf("%12.6f %s\n", static_cast<double>(at) / 1e6, line.c_str());
  }
  [[nodiscard]] std::uint64_t hash() const { return hash_; }

 private:
  void add(const std::string& text) {
    for (const char c : text + '\n') hash_ = (hash_ ^ static_cast<unsigned char>(c)) * 0x100000001b3;  // FNV-1a
  }
  std::uint64_t hash_ = 0xcbf29ce484222325;
  bool prints_;
};

}  // namespace gs::simulation
