#pragma once

#include "qnv/base/cloud.h"

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

/// Ascending for depths from the farthest to the nearest; +0 and -0 are one depth, what is no number comes last.
[[nodiscard]] std::uint32_t far_first_key(float depth);

/// Sorts key << 32 | value by the key, ascending; entries of one key stay in their order (radix sort, 11 bits at a
/// time). `other` is room to work in, of any size.
void sort_by_key(std::vector<std::uint64_t>& entries, std::vector<std::uint64_t>& other);

/// One volume to be sorted with others.
struct VolumeSortPart {
  std::shared_ptr<const qnv::Cloud> cloud;
  std::size_t count = 0;  // the first so many vectors
  glm::vec4 row{0};       // depth along the view axis = dot(row, (position, 1))
};

/// Sorts the vectors of volumes by depth on a thread of its own, view after view, for one viewport. All methods belong
/// to one thread.
class VolumeSorter {
 public:
  struct Order {
    /// The farthest first; of the same depth the later one. Vectors are numbered through all parts. Valid until the
    /// next call of `order`. Empty when there is no memory.
    std::span<const std::uint32_t> far_first;
    bool exact = false;        // for this very view; otherwise for the one asked for before it
    std::uint64_t number = 0;  // that of another order is another
  };

  VolumeSorter() = default;
  ~VolumeSorter();
  VolumeSorter(const VolumeSorter&) = delete;
  VolumeSorter& operator=(const VolumeSorter&) = delete;

  /// The newest order there is, while the one for `parts` is being made. Waits where that would be older than the view
  /// asked for last, of other vectors, or one that saw them from a direction more than kMostTurn away. Asked again
  /// for the same view, it gives the exact order in the end.
  Order order(std::span<const VolumeSortPart> parts);

  static constexpr float kMostTurn = 0.1f;  // radians

 private:
  struct Seen {
    std::weak_ptr<const qnv::Cloud> cloud;
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
  // Under the mutex.
  std::vector<VolumeSortPart> wanted_;  // not begun
  std::shared_ptr<Sorted> newest_, spare_;
  bool waiting_ = false;  // wanted_ is to be sorted
  // The owner's.
  std::uint64_t asked_ = 0;
  std::vector<Seen> asked_for_;
  std::shared_ptr<Sorted> in_use_;
  // The last member: it ends before the others go.
  std::jthread thread_;
};

}  // namespace gs::render
