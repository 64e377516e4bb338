#pragma once

#include "qnv/mesh/manifold.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace gs::qnv::exact {

/// Triangles of a growing mesh, and their sides: side 3 t + k leads from corner k of triangle t to the next corner.
/// Sides without an adjacent triangle form closed chains. If a side ends at vertex b, a gap without triangles follows
/// at b. The next side of the chain is the first side that leaves b after the gap.
class Gates {
 public:
  enum class State : std::uint8_t { open, rim, joined };
  static constexpr std::uint32_t kNone = 0xffffffff;

  void reserve(std::size_t triangles) {
    triangles_.reserve(triangles);
    next_.reserve(3 * triangles);
    before_.reserve(3 * triangles);
    states_.reserve(3 * triangles);
  }
  [[nodiscard]] const std::vector<displaced::Corners>& triangles() const { return triangles_; }
  [[nodiscard]] std::vector<displaced::Corners> take_triangles() { return std::move(triangles_); }
  [[nodiscard]] std::uint32_t sides() const { return static_cast<std::uint32_t>(states_.size()); }

  [[nodiscard]] std::uint32_t from(std::uint32_t side) const { return triangles_[side / 3][side % 3]; }
  [[nodiscard]] std::uint32_t to(std::uint32_t side) const { return triangles_[side / 3][(side % 3 + 1) % 3]; }
  [[nodiscard]] std::uint32_t opposite(std::uint32_t side) const { return triangles_[side / 3][(side % 3 + 2) % 3]; }
  [[nodiscard]] State state(std::uint32_t side) const { return states_[side]; }
  [[nodiscard]] bool open(std::uint32_t side) const { return states_[side] == State::open; }
  /// Returns the next side of the chain. For a side of two triangles, returns the same edge's side in the other
  /// triangle.
  [[nodiscard]] std::uint32_t next(std::uint32_t side) const { return next_[side]; }
  [[nodiscard]] std::uint32_t before(std::uint32_t side) const { return before_[side]; }

  /// Adds a triangle, and returns its first side. Its sides are open and do not belong to a chain yet.
  std::uint32_t add(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    const std::uint32_t side = sides();
    triangles_.push_back({a, b, c});
    next_.insert(next_.end(), 3, kNone);
    before_.insert(before_.end(), 3, kNone);
    states_.insert(states_.end(), 3, State::open);
    return side;
  }
  void link(std::uint32_t side, std::uint32_t behind) {
    next_[side] = behind;
    before_[behind] = side;
  }
  void join(std::uint32_t side, std::uint32_t other) {
    states_[side] = states_[other] = State::joined;
    next_[side] = other;
    next_[other] = side;
  }
  /// Returns for each side the same edge's side in the other triangle; kNone if there is no other triangle.
  [[nodiscard]] std::vector<std::uint32_t> twins() const {
    std::vector<std::uint32_t> twins(sides(), kNone);
    for (std::uint32_t side = 0; side < sides(); ++side)
      if (states_[side] == State::joined) twins[side] = next_[side];
    return twins;
  }
  void close(std::uint32_t side) { states_[side] = State::rim; }

 private:
  std::vector<displaced::Corners> triangles_;
  std::vector<std::uint32_t> next_, before_;
  std::vector<State> states_;
};

/// Queue of open sides. Order: lowest rank of the side's end, then narrowest gap after the side, then first in. Skips a
/// side if it is no longer open, or if its next side has changed.
class GateQueue {
 public:
  static constexpr std::uint32_t kGrades = 129, kRanks = 8;
  struct Gate {
    std::uint32_t side = 0, gap = 0;
  };

  void push(std::uint32_t side, std::uint32_t behind, std::uint32_t gap, std::uint32_t rank) {
    const std::uint32_t at = rank * kGrades + gap;
    queues_[at].waiting.emplace_back(side, behind);
    least_ = std::min(least_, at);
  }
  std::optional<Gate> pop(const Gates& gates) {
    for (; least_ < queues_.size(); ++least_) {
      Queue& queue = queues_[least_];
      while (queue.first < queue.waiting.size()) {
        const auto [side, behind] = queue.waiting[queue.first++];
        if (gates.open(side) && gates.next(side) == behind) return Gate{side, least_ % kGrades};
      }
      queue.waiting.clear();
      queue.first = 0;
    }
    return {};
  }

 private:
  struct Queue {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> waiting;  // side, next side
    std::size_t first = 0;
  };
  std::array<Queue, kGrades * kRanks> queues_;
  std::uint32_t least_ = kGrades * kRanks;
};

}  // namespace gs::qnv::exact
