#pragma once

#include "base/noncopyable.h"
#include "qnv/base/geometry.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
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

/// Vectors that are sorted together with others: by depth along the view axis, or by distance from the eye.
struct SortPart {
  std::shared_ptr<const qnv::VectorArrays> vectors;
  std::size_t count = 0;  // number of vectors, from index `first` on
  glm::vec4 row{0};       // depth along the view axis is dot(row, (position, 1))
  bool by_distance =
      false;  // instead, the depth is the squared distance: dot(position - eye, metric * (position - eye))
  glm::vec3 eye{0};
  glm::mat3 metric{1};
  std::size_t first = 0;

  [[nodiscard]] float depth_of(const glm::vec3& position) const;
};

/// Sorts vectors by depth on its own thread, for the successive views of one viewport. Call all
/// functions on one thread.
class DepthSorter : NonCopyable {
 public:
  struct Order {
    /// Indexes of vectors over all parts, farthest first. At equal depth, later vectors come first. Valid until the
    /// next call of `order`. Empty if memory is exhausted.
    std::span<const std::uint32_t> far_first;
    bool exact = false;        // sorted for this view; otherwise for an earlier view
    std::uint64_t number = 0;  // unique serial number of the order
  };

  ~DepthSorter();

  /// Returns the newest order that is ready, and requests the order for `parts`. Waits if the newest order is older
  /// than the previous request, has other vectors, or was made for a direction that differs by more than kMaxTurn. If
  /// the same view is requested repeatedly, the exact order is finally returned. The order by distance also remains
  /// exact while the view turns about the eye.
  Order order(std::span<const SortPart> parts);

  /// Difference of two views of the same vectors. `near`: one order can replace the other for a moment.
  enum class Likeness { same, near, far };
  /// View for which vectors were sorted. Does not keep the vectors.
  struct Seen {
    std::weak_ptr<const qnv::VectorArrays> vectors;
    SortPart part;  // without its vectors
  };
  static std::vector<Seen> seen_of(std::span<const SortPart> parts);
  static Likeness likeness(std::span<const Seen> seen, std::span<const SortPart> parts);

  static constexpr float kMaxTurn = 0.1f;  // radians; for distances, the move of the eye divided by its distance

 private:
  struct Sorted {
    std::uint64_t number = 0;
    std::vector<Seen> of;
    std::vector<std::uint32_t> far_first;
  };

  void run(const std::stop_token& stop);

  std::mutex mutex_;
  std::condition_variable_any changed_;
  // The following members are guarded by the mutex.
  std::vector<SortPart> wanted_;  // next request
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
