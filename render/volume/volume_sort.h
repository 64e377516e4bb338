#pragma once

#include "base/noncopyable.h"
#include "qnv/base/geometry.h"

#include <glm/vec4.hpp>

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <thread>
#include <vector>

namespace gs::render {

/// Returns a sort key that increases from the farthest to the nearest depth. +0 and -0 have equal keys. NaN has the
/// highest key.
[[nodiscard]] std::uint32_t far_first_key(float depth);

/// Sorts entries (key << 32 | value) by key, ascending and stable. Radix sort, 11 bits per pass. `other` is working
/// memory of any size.
void sort_by_key(std::vector<std::uint64_t>& entries, std::vector<std::uint64_t>& other);

/// Volume that is sorted together with others.
struct VolumeSortPart {
  std::shared_ptr<const qnv::Volume> volume;
  std::size_t count = 0;  // number of vectors, from index 0 on
  glm::vec4 row{0};  // depth along the view axis is dot(row, (position, 1))
};

/// Sorts the vectors of volumes by depth on its own thread, for the successive views of one viewport. Call all
/// functions on one thread.
class VolumeSorter : NonCopyable {
 public:
  struct Order {
    /// Indexes of vectors over all parts, farthest first. At equal depth, later vectors come first. Valid until the
    /// next call of `order`. Empty if memory is exhausted.
    std::span<const std::uint32_t> far_first;
    bool exact = false;  // sorted for this view; otherwise for an earlier view
    std::uint64_t number = 0;  // unique serial number of the order
  };

  ~VolumeSorter();

  /// Returns the newest order that is ready, and requests the order for `parts`. Waits if the newest order is older
  /// than the previous request, has other vectors, or was made for a direction that differs by more than kMaxTurn. If
  /// the same view is requested repeatedly, the exact order is finally returned.
  Order order(std::span<const VolumeSortPart> parts);

  static constexpr float kMaxTurn = 0.1f;  // radians

 private:
  struct Seen {
    std::weak_ptr<const qnv::Volume> volume;
    std::size_t count = 0;
    glm::vec4 row{0};
  };
  struct Sorted {
    std::uint64_t number = 0;
    std::vector<Seen> of;
    std::vector<std::uint32_t> far_first;
  };

  enum class Likeness { same, near, far };

  static std::vector<Seen> seen_of(std::span<const VolumeSortPart> parts);
  static Likeness likeness(std::span<const Seen> seen, std::span<const VolumeSortPart> parts);
  void run(const std::stop_token& stop);

  std::mutex mutex_;
  std::condition_variable_any changed_;
  // The following members are guarded by the mutex.
  std::vector<VolumeSortPart> wanted_;  // next request
  std::shared_ptr<Sorted> newest_, spare_;
  bool waiting_ = false;  // a request is waiting
  // The following members are only for the owner's thread.
  std::uint64_t asked_ = 0;
  std::vector<Seen> asked_for_;
  std::shared_ptr<Sorted> in_use_;
  // Last member, so that the thread ends before the other members are destroyed.
  std::jthread thread_;
};

}  // namespace gs::render
