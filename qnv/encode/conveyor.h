#pragma once

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

/// Carries triangles to work that another thread does on them, batch by batch in their order, while the next ones are
/// read. On one thread, or where the system has no other, it is done at once.
class Conveyor {
 public:
  using Work = std::function<void(std::span<const Triangle>)>;
  /// `threads`: as of parallel_for.
  Conveyor(Work work, unsigned threads);
  Conveyor(const Conveyor&) = delete;
  Conveyor& operator=(const Conveyor&) = delete;
  ~Conveyor() { stop(); }

  /// Waits while much lies there. False where the work threw something, so that nothing more is of use.
  bool put(std::span<const Triangle> triangles);
  /// Waits until all is done; what the work threw is thrown here.
  void finish();

 private:
  void run();
  void stop();

  Work work_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::vector<Triangle>> waiting_, used_;  // `used_`: whose memory is there to be used again
  bool ended_ = false, failed_ = false;
  std::exception_ptr failure_;
  std::thread thread_;
};

}  // namespace gs::qnv
