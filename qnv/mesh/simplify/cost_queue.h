#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace gs::qnv::displaced {

/// Edge that may collapse.
struct Candidate {
  std::uint32_t u, v, stamp;  // `stamp` is the sum of both vertices' stamps when the candidate was made
};

/// Bucket queue of candidates, cheapest first. Costs within a 32nd of an octave count as equal; of these, the first in
/// is the first out. Push and pop take constant time. A heap of millions would wait for memory at every step.
class CostQueue {
 public:
  /// `cost` must be finite and not negative.
  void push(double cost, const Candidate& candidate) {
    const std::size_t slot = std::bit_cast<std::uint32_t>(static_cast<float>(cost)) >> kShift;
    slots_[slot].waiting.push_back(candidate);
    first_ = std::min(first_, slot);
  }
  /// Returns false if the queue is empty.
  bool pop(Candidate& candidate) {
    for (; first_ < slots_.size(); ++first_) {
      Slot& slot = slots_[first_];
      if (slot.next < slot.waiting.size()) {
        candidate = slot.waiting[slot.next++];
        return true;
      }
      slot.waiting = {};
      slot.next = 0;
    }
    return false;
  }

 private:
  // The bits of floats >= 0 sort like the numbers. The shift keeps five bits of the fraction.
  static constexpr std::uint32_t kShift = 18, kSlots = 0x7f80'0000u >> kShift;
  struct Slot {
    std::vector<Candidate> waiting;
    std::size_t next = 0;
  };
  std::vector<Slot> slots_{kSlots + 1};
  std::size_t first_ = kSlots + 1;
};

}  // namespace gs::qnv::displaced
