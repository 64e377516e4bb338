#pragma once

#include "qnv/codecs/shared/chunk_requests.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

namespace gs::app {

/// Views of a geometry without chunks, by which a reader chooses files. Any thread.
class ViewNotes final : public qnv::ChunkRequests {
 public:
  bool set_directory(std::span<const std::byte>) override { return false; }
  void note(const qnv::LodView& view) override {
    const std::lock_guard lock(mutex_);
    std::erase_if(views_, [&](const qnv::LodView& one) { return one.viewport == view.viewport; });
    if (views_.size() >= kMostViews) views_.erase(views_.begin());
    views_.push_back(view);
  }
  void forget(std::uint32_t viewport) override {
    const std::lock_guard lock(mutex_);
    std::erase_if(views_, [&](const qnv::LodView& one) { return one.viewport == viewport; });
  }
  [[nodiscard]] std::vector<qnv::LodView> views() const override {
    const std::lock_guard lock(mutex_);
    // Sorts by viewport, so that equal views compare equal.
    std::vector<qnv::LodView> sorted = views_;
    std::ranges::sort(sorted, {}, &qnv::LodView::viewport);
    return sorted;
  }
  [[nodiscard]] const Box& box() const override { return box_; }
  [[nodiscard]] std::uint64_t directory() const override { return 0; }
  [[nodiscard]] bool in_stream_order() const override { return false; }
  [[nodiscard]] std::vector<qnv::ChunkRange> wanted() const override { return {}; }

 private:
  static constexpr std::size_t kMostViews = 16;

  const Box box_{};  // unknown
  mutable std::mutex mutex_;
  std::vector<qnv::LodView> views_;  // one per viewport, the latest last
};

}  // namespace gs::app
