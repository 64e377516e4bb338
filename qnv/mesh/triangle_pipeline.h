#pragma once

#include "base/noncopyable.h"
#include "qnv/base/triangles.h"

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <span>
#include <thread>
#include <vector>

namespace gs::qnv {

/// Pipeline that passes batches of triangles, in order, to work on a second thread. Meanwhile the caller reads the next
/// triangles. With one thread, or if the system has no other, put() does the work immediately.
class TrianglePipeline : NonCopyable {
 public:
  using Work = std::function<void(std::span<const Triangle>)>;
  /// If `threads` is 0, uses one thread per core.
  TrianglePipeline(Work work, unsigned threads);
  ~TrianglePipeline() { stop(); }

  /// Adds triangles. Blocks while too many batches are waiting. Returns false if the work threw an exception; further
  /// triangles are then useless.
  bool put(std::span<const Triangle> triangles);
  /// Waits until all work is done. Rethrows an exception of the work.
  void finish();

 private:
  void run();
  void stop();

  Work work_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::vector<Triangle>> waiting_, used_;  // `used_` has batches with memory to reuse
  bool ended_ = false, failed_ = false;
  std::exception_ptr failure_;
  std::thread thread_;
};

}  // namespace gs::qnv
