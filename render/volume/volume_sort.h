#pragma once

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

/// Returns a sort key that ascends from the farthest depth to the nearest; +0 and -0 are equal, NaN comes last.
[[nodiscard]] std::uint32_t far_first_key(float depth);

/// Sorts key << 32 | value by the key, ascending and stable (radix sort, 11 bits per pass). `other` is working memory
/// of any size.
void sort_by_key(std::vector<std::uint64_t>& entries, std::vector<std::uint64_t>& other);

/// Volume to sort together with others.
struct VolumeSortPart {
  std::shared_ptr<const qnv::Volume> volume;
  std::size_t count = 0;  // length of the prefix
  glm::vec4 row{0};       // depth along the view axis = dot(row, (position, 1))
};

/// Sorts the vectors of volumes by depth on its own thread, view after view, for one viewport. Call all methods from
/// one thread.
class VolumeSorter {
 public:
  struct Order {
    /// Indices of vectors across all parts, farthest first; at equal depth the later one first. Valid until the next
    /// call of `order`. Empty if memory is exhausted.
    std::span<const std::uint32_t> far_first;
    bool exact = false;        // exact for this view; otherwise made for the previous one
    std::uint64_t number = 0;  // unique per order
  };

  VolumeSorter() = default;
  ~VolumeSorter();
  VolumeSorter(const VolumeSorter&) = delete;
  VolumeSorter& operator=(const VolumeSorter&) = delete;

  /// Returns the newest available order while the one for `parts` is being made. Waits if that order is older than the
  /// previous request, contains other vectors, or differs in direction by more than kMaxTurn. Repeated requests for
  /// the same view eventually return the exact order.
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
  // Guarded by the mutex.
  std::vector<VolumeSortPart> wanted_;  // next request
  std::shared_ptr<Sorted> newest_, spare_;
  bool waiting_ = false;  // wanted_ must be sorted
  // Used only by the owner's thread.
  std::uint64_t asked_ = 0;
  std::vector<Seen> asked_for_;
  std::shared_ptr<Sorted> in_use_;
  // The last member, so that the thread ends before the others are destroyed.
  std::jthread thread_;
};

}  // namespace gs::render
