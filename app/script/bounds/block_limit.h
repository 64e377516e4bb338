#pragma once

#include <cstddef>

namespace gs::app::script {

/// Limit on the size of each memory block that SpiderMonkey allocates on this thread, while this object exists. Larger
/// requests fail, and the program gets an out-of-memory exception. SpiderMonkey has no such limit itself: one operator
/// may otherwise flatten a string of 2^30 characters, which takes 2 GB and several seconds. Blocks of exactly 32 or
/// 64 MiB, the stacks of regular expressions, are always granted.
class BlockLimit {
 public:
  explicit BlockLimit(std::size_t bytes);
  ~BlockLimit();
  BlockLimit(const BlockLimit&) = delete;
  BlockLimit& operator=(const BlockLimit&) = delete;

  /// Redirects the allocation functions that libmozjs imports. Call it before JS_Init. Returns false if the library
  /// imports none, so that limits have no effect.
  static bool install();

 private:
  std::size_t before_;
};

}  // namespace gs::app::script
