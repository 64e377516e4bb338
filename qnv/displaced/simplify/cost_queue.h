#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace gs::qnv::displaced {

/// An edge that may collapse.
struct Candidate {
  std::uint32_t u, v, stamp;  // the sum of both stamps when it was made
};

/// Candidates, the cheapest first, as far as a 32nd of an octave tells costs apart; of those that cost the same, those
/// that came first. Both ways take the same time however many there are, which a heap of millions does not: it waits
/// for memory at every step.
class CostQueue {
 public:
  /// `cost`: not negative, and finite.
  void push(double cost, const Candidate& candidate) {
    const std::size_t slot = std::bit_cast<std::uint32_t>(static_cast<float>(cost)) >> kShift;
    slots_[slot].waiting.push_back(candidate);
    first_ = std::min(first_, slot);
  }
  /// False where there is none.
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
  // Numbers in the order of their bits: five of the fraction are left.
  static constexpr std::uint32_t kShift = 18, kSlots = 0x7f80'0000u >> kShift;
  struct Slot {
    std::vector<Candidate> waiting;
    std::size_t next = 0;
  };
  std::vector<Slot> slots_{kSlots + 1};
  std::size_t first_ = kSlots + 1;
};

}  // namespace gs::qnv::displaced
