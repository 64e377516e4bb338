#pragma once

#include "base/noncopyable.h"

#include <cstddef>

namespace gs::app::script {

/// Limit on the size of each memory block that SpiderMonkey allocates on this thread. It holds as long as this object
/// exists. A larger allocation fails, and the program gets an out-of-memory exception. SpiderMonkey itself has no such
/// limit: a single operator could flatten a string of 2^30 characters, which takes 2 GB and several seconds. Blocks of
/// exactly 32 or 64 MiB, which are stacks of regular expressions, are always allowed.
class BlockLimit : NonCopyable {
 public:
  explicit BlockLimit(std::size_t bytes);
  ~BlockLimit();

  /// Redirects the allocation functions that libmozjs imports to limited ones. Call before JS_Init(). Returns false if
  /// the library imports none of them; then limits have no effect.
  static bool install();

 private:
  std::size_t before_;
};

}  // namespace gs::app::script
