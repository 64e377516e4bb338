#pragma once

#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace gs::app {

/// Messages of connections, from any thread to the reader thread. Holds a bounded number.
class LoadNotices {
 public:
  void add(const std::string& message) {
    constexpr std::size_t kMost = 100;
    const std::lock_guard lock(mutex_);
    if (messages_.size() < kMost) messages_.push_back(message);
  }
  [[nodiscard]] std::vector<std::string> take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(messages_, {});
  }

 private:
  std::mutex mutex_;
  std::vector<std::string> messages_;
};

}  // namespace gs::app
