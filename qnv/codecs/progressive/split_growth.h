#pragma once

#include "qnv/codecs/lossless/exact_numbers.h"
#include "qnv/codecs/progressive/split_mesh.h"

#include <glm/common.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

namespace gs::qnv::progressive {

/// Action that an encoder requests at a vertex.
struct WantedSplit {
  VertexSplit how;
  glm::ivec3 place{0};
};

/// Coder of a mesh that visits its vertices repeatedly. Each pass either splits some vertices, or adds one bit to all
/// positions. The same code encodes and decodes; FORMAT.md, "Splits", defines every step. One thread at a time.
class SplitGrowth {
 public:
  static constexpr std::uint32_t kMaxVertices = 1u << 28;

  /// `mesh` is on a lattice of `bits` bits, which become `finest` bits at the end. `vertices` and `triangles` are the
  /// maximum numbers. If `middles`, a new vertex is predicted at the mean of its neighbours; otherwise at the vertex
  /// that is split.
  SplitGrowth(SplitMesh mesh, int bits, int finest, std::size_t vertices, std::size_t triangles, bool middles)
      : mesh_(std::move(mesh)),
        bits_(bits),
        finest_(finest),
        most_vertices_(vertices),
        most_triangles_(triangles),
        middles_(middles),
        models_(std::make_unique<Models>()) {
    end_ = at_ = size();
  }

  [[nodiscard]] const SplitMesh& mesh() const { return mesh_; }
  [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(mesh_.places().size()); }
  /// Reports whether the current pass has ended. next() returns the next vertex of the current pass.
  [[nodiscard]] bool between() const { return at_ == end_; }
  [[nodiscard]] std::uint32_t next() const { return at_; }
  [[nodiscard]] int bits() const { return bits_; }
  /// Returns the position of a vertex on the finest lattice. The bits coded so far leave an interval; returns its
  /// middle.
  [[nodiscard]] glm::ivec3 place(std::uint32_t vertex) const {
    const int less = finest_ - bits_ + (refines_ && at_ < end_ && vertex >= at_ ? 1 : 0);
    return mesh_.places()[vertex] << less | (less > 0 ? 1 << (less - 1) : 0);
  }

  /// Codes the next visit. Only an encoder uses `guide`. Returns false if the decisions are invalid.
  template <class Coder, class Guide>
  bool visit(exact::Decisions<Coder>& decisions, Guide& guide);

 private:
  using TwoRates = exact::TwoRates;
  static constexpr std::uint32_t kTurns = 12, kSizes = 32;
  static constexpr std::uint32_t kChoices = 16;
  struct Models {
    std::array<std::array<std::array<TwoRates, 2>, 2>, kTurns> divides;  // contexts: triangles, open or closed ring,
                                                                         // new neighbours
    std::array<std::array<TwoRates, 3>, kSizes> divides_size;
    std::array<TwoRates, 2> one, left;
    std::array<std::array<TwoRates, kChoices>, kChoices + 1> firsts, spans;
    std::array<std::array<TwoRates, 3>, 4> as_old;
    std::array<std::array<TwoRates, 3>, 4> as_left, as_right;
    std::array<std::array<exact::Lengths, 24>, 3> off;
    std::array<exact::Digits, 3> digits;
    std::array<std::array<TwoRates, 3>, 3> low;  // context: the bit of a neighbour
  };

  template <class Coder, class Guide>
  bool divide(exact::Decisions<Coder>& decisions, Guide& guide);
  template <class Coder>
  std::uint32_t choice(exact::Decisions<Coder>& decisions, std::array<std::array<TwoRates, kChoices>, kChoices + 1>& by,
                       std::uint32_t of, std::uint32_t is);
  template <class Coder>
  glm::ivec3 placed(exact::Decisions<Coder>& decisions, const VertexSplit& how, const glm::ivec3& is);

  SplitMesh mesh_;
  int bits_, finest_;
  std::size_t most_vertices_, most_triangles_;
  std::uint32_t at_ = 0, end_ = 0;  // range of the pass; vertices from end_ on are new in it
  bool refines_ = false, middles_;
  VertexRing ring_;
  std::unique_ptr<Models> models_;
};

template <class Coder, class Guide>
bool SplitGrowth::visit(exact::Decisions<Coder>& decisions, Guide& guide) {
  constexpr bool kWrites = exact::Decisions<Coder>::kWrites;
  if (at_ == end_) {
    bool refine = false;
    if constexpr (kWrites) refine = guide.refines();
    refines_ = decisions.bits(refine ? 1 : 0, 1) != 0;
    if (refines_ && bits_ == finest_) return false;
    bits_ += refines_ ? 1 : 0;
    at_ = 0;
    end_ = size();
    if (end_ == 0) return false;
  }
  if (refines_) {
    mesh_.ring(at_, ring_);
    glm::ivec3& place = mesh_.places()[at_];
    for (int axis = 0; axis < 3; ++axis) {
      // If a coordinate equalled a neighbour's in the previous pass, it usually still does.
      std::size_t beside = 2;
      for (const std::uint32_t n : ring_.neighbours)
        if (beside == 2 && n < at_ && mesh_.places()[n][axis] >> 1 == place[axis])
          beside = static_cast<std::size_t>(mesh_.places()[n][axis] & 1);
      bool bit = false;
      if constexpr (kWrites) bit = guide.low_bit(at_, axis, bits_);
      place[axis] =
          2 * place[axis] + (decisions.bit(models_->low[static_cast<std::size_t>(axis)][beside], bit) ? 1 : 0);
    }
  } else if (!divide(decisions, guide)) {
    return false;
  }
  ++at_;
  return decisions.good();
}

template <class Coder, class Guide>
bool SplitGrowth::divide(exact::Decisions<Coder>& decisions, Guide& guide) {
  constexpr bool kWrites = exact::Decisions<Coder>::kWrites;
  mesh_.ring(at_, ring_);
  const auto count = static_cast<std::uint32_t>(ring_.corners.size());
  if (count == 0) return true;
  const std::size_t open = ring_.open ? 1 : 0;
  std::size_t fresh = 0;
  std::int64_t reach = 0;
  for (const std::uint32_t n : ring_.neighbours) {
    fresh += n >= end_ ? 1 : 0;
    const glm::ivec3 to = mesh_.places()[n] - mesh_.places()[at_];
    reach = std::max(reach, exact::dot(to, to));
  }
  const auto reach_bits = static_cast<std::size_t>(std::bit_width(static_cast<std::uint64_t>(reach)));
  const std::size_t level = std::min<std::size_t>(
      static_cast<std::size_t>(std::max(0, 2 * (finest_ - bits_) + static_cast<int>(reach_bits))), kSizes - 1);
  const std::optional<WantedSplit> wanted = [&]() -> std::optional<WantedSplit> {
    if constexpr (kWrites)
      return guide.split(at_, ring_);
    else
      return {};
  }();
  Models& m = *models_;
  if (!decisions.bit(m.divides[std::min(count, kTurns - 1)][open][std::min<std::size_t>(fresh, 1)],
                     m.divides_size[level][std::min<std::size_t>(fresh, 2)], wanted.has_value()))
    return true;
  VertexSplit how = wanted ? wanted->how : VertexSplit{};
  if (!ring_.open) {
    how.first = choice(decisions, m.firsts, count, how.first);
    how.last = how.first + 1 + choice(decisions, m.spans, count - 1, how.last - how.first - 1);
  } else if (decisions.bit(m.one[0], how.left && how.right)) {
    how.left = how.right = true;
    how.first = choice(decisions, m.firsts, count, how.first);
    how.last = how.first + 1 + choice(decisions, m.spans, count - how.first, how.last - how.first - 1);
  } else {
    how.left = decisions.bit(m.one[1], how.left);
    how.right = !how.left;
    const std::uint32_t end = choice(decisions, m.firsts, count + 1, how.left ? how.first : how.last);
    how.first = how.left ? end : 0;
    how.last = how.left ? count : end;
  }
  if (how.last - how.first > count || (!ring_.open && (count < 2 || how.last - how.first >= count)) ||
      (ring_.open && how.last > count) || size() >= most_vertices_ ||
      mesh_.triangles().size() + (how.left ? 1 : 0) + (how.right ? 1 : 0) > most_triangles_)
    return false;
  const glm::ivec3 place = placed(decisions, how, wanted ? wanted->place : glm::ivec3(0));
  for (int axis = 0; axis < 3; ++axis)
    if (place[axis] < 0 || place[axis] >= 1 << bits_) return false;
  mesh_.split(at_, ring_, how, place);
  if constexpr (kWrites) guide.divided(at_, size() - 1);
  return true;
}

// Codes a choice among the numbers below `of`.
template <class Coder>
std::uint32_t SplitGrowth::choice(exact::Decisions<Coder>& decisions,
                                  std::array<std::array<TwoRates, kChoices>, kChoices + 1>& by, std::uint32_t of,
                                  std::uint32_t is) {
  if (of < 2) return 0;
  int bits = std::bit_width(of - 1);
  if (of > kChoices) return decisions.bits(is, bits);
  std::uint32_t node = 1;
  while (bits-- > 0) node = 2 * node + (decisions.bit(by[of][node], (is >> bits & 1) != 0) ? 1 : 0);
  return node - (1u << std::bit_width(of - 1));
}

template <class Coder>
glm::ivec3 SplitGrowth::placed(exact::Decisions<Coder>& decisions, const VertexSplit& how, const glm::ivec3& is) {
  Models& m = *models_;
  const auto size = static_cast<std::uint32_t>(ring_.neighbours.size());
  const glm::ivec3 old = mesh_.places()[at_];
  const glm::ivec3 left = how.left ? mesh_.places()[ring_.neighbours[how.first % size]] : old;
  const glm::ivec3 right = how.right ? mesh_.places()[ring_.neighbours[how.last % size]] : old;
  glm::ivec3 place(0);
  glm::ivec3 expected = old;
  if (middles_) {
    int count = 1;
    for (std::uint32_t k = how.first; k <= how.last; ++k, ++count)
      expected += mesh_.places()[ring_.neighbours[k % size]];
    for (int axis = 0; axis < 3; ++axis) expected[axis] /= count;
  }
  std::size_t same = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    int at = old[axis];
    if (decisions.bit(m.as_old[same][a], is[axis] == at)) {
      ++same;
    } else if (left[axis] != old[axis] && decisions.bit(m.as_left[same][a], is[axis] == left[axis])) {
      at = left[axis];
    } else if (right[axis] != old[axis] && right[axis] != left[axis] &&
               decisions.bit(m.as_right[same][a], is[axis] == right[axis])) {
      at = right[axis];
    } else {
      const auto reach = static_cast<std::uint32_t>(std::max(std::abs(left[axis] - at), std::abs(right[axis] - at)));
      exact::Lengths& lengths = m.off[same][static_cast<std::size_t>(std::bit_width(reach))];
      at = expected[axis] + decisions.number(lengths, lengths, m.digits[a], is[axis] - expected[axis]);
    }
    place[axis] = at;
  }
  return place;
}

}  // namespace gs::qnv::progressive
