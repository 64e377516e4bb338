#include "qnv/mesh/triangle_pipeline.h"

#include <algorithm>
#include <system_error>
#include <utility>

namespace gs::qnv {
namespace {

constexpr std::size_t kMaxWaiting = 32;  // maximum number of waiting batches
constexpr std::size_t kMaxTogether = 4'096;  // maximum triangles per batch

}  // namespace

TrianglePipeline::TrianglePipeline(Work work, unsigned threads) : work_(std::move(work)) {
  if (threads == 1 || (threads == 0 && std::thread::hardware_concurrency() <= 1)) return;
  try {
    thread_ = std::thread([this] { run(); });
  } catch (const std::system_error&) {
    // The system has no further thread. The caller's thread then does the work.
  }
}

void TrianglePipeline::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [&] { return ended_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    std::vector<Triangle> batch = std::move(waiting_.front());
    waiting_.pop_front();
    const bool wanted = !failed_;
    lock.unlock();
    std::exception_ptr failure;
    try {
      if (wanted) work_(batch);
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    if (failure) {
      failure_ = failure;
      failed_ = true;
    }
    used_.push_back(std::move(batch));
    changed_.notify_all();
  }
}

bool TrianglePipeline::put(std::span<const Triangle> triangles) {
  if (!thread_.joinable()) {
    work_(triangles);
    return true;
  }
  while (!triangles.empty()) {
    const auto some = triangles.first(std::min(triangles.size(), kMaxTogether));
    triangles = triangles.subspan(some.size());
    std::vector<Triangle> batch;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] { return failed_ || waiting_.size() < kMaxWaiting; });
      if (failed_) return false;
      if (!used_.empty()) {
        batch = std::move(used_.back());
        used_.pop_back();
      }
    }
    batch.assign(some.begin(), some.end());
    const std::lock_guard lock(mutex_);
    waiting_.push_back(std::move(batch));
    changed_.notify_all();
  }
  return true;
}

void TrianglePipeline::finish() {
  stop();
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
}

void TrianglePipeline::stop() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
    changed_.notify_all();
  }
  thread_.join();
}

}  // namespace gs::qnv
