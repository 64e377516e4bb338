#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>

namespace gs::app {

/// Wake-up signal of a thread that reads.
class Waker {
 public:
  void wake();
  void wait(std::chrono::milliseconds time);

 private:
  std::mutex mutex_;
  std::condition_variable something_;
  bool awake_ = false;  // guarded by mutex_
};

}  // namespace gs::app
