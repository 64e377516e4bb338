#pragma once

#include "qnv/codecs/lossless/corner_growth.h"
#include "qnv/codecs/lossless/exact_mesh.h"
#include "qnv/codecs/lossless/exact_numbers.h"
#include "qnv/codecs/lossless/gates.h"
#include "qnv/codecs/lossless/tail_header.h"

#include <glm/common.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace gs::qnv::exact {

/// Coder of a mesh, triangle by triangle, at the narrowest gap first (after P. Alliez, C. Gotsman, M. Desbrun,
/// Near-optimal connectivity encoding, 2001; H. Lee, P. Alliez, M. Desbrun, Angle-Analyzer, 2002). Angles, distances
/// and triangle counts of the grown part predict each decision. The same code encodes and decodes; FORMAT.md, "Exact
/// tail", defines every step. `Guide` provides the mesh to an encoder; a decoder does not use it.
template <class Coder, class Guide>
class MeshGrowth {
 public:
  /// Reserves memory for at most `room` triangles.
  MeshGrowth(Coder& coder, const TailHeader& header, Guide& guide, std::size_t room)
      : decisions_(coder),
        header_(header),
        guide_(guide),
        models_(std::make_unique<Models>()),
        corners_(header.texture) {
    const std::size_t vertices = std::min<std::size_t>(header.vertices, room);
    gates_.reserve(std::min<std::size_t>(header.triangles, room));
    places_.reserve(vertices);
    marks_.reserve(vertices);
    if (header.colored) colors_.reserve(vertices);
    if (header.cell_bits > 0) ranks_.assign(std::size_t{1} << 3 * header.cell_bits, kNoRank);
  }
  enum class Growth { growing, whole, wrong };  // wrong: the decisions do not describe a mesh
  /// Grows the mesh step by step. Before each step, calls `more` with the maximum bytes of the step; stops if it
  /// returns false.
  template <class More>
  Growth run(const More& more);
  bool run() {
    return run([](std::size_t) { return true; }) == Growth::whole;
  }

  [[nodiscard]] std::vector<std::uint32_t> twins() const { return gates_.twins(); }
  [[nodiscard]] const std::vector<displaced::Corners>& triangles() const { return gates_.triangles(); }
  [[nodiscard]] const std::vector<glm::ivec3>& places() const { return places_; }
  [[nodiscard]] std::vector<displaced::Corners> take_triangles() { return gates_.take_triangles(); }
  [[nodiscard]] const std::vector<glm::ivec3>& colors() const { return colors_; }
  [[nodiscard]] const std::vector<CornerCoordinates>& coordinates() const { return corners_.coordinates(); }

 private:
  static constexpr bool kWrites = Decisions<Coder>::kWrites;
  static constexpr std::size_t kRanks = 40, kGaps = 33, kTurns = 10;
  static constexpr std::uint8_t kNoRank = 255;
  // Maximum bytes of a step, of a component's first triangle, and of corners. A decision takes at most 10 bits; a
  // number takes at most 24 decisions and 42 bits. A vertex has three numbers, and three more for its colour. A
  // component's first triangle has three vertices. Two triangles have six corners with two numbers each.
  static constexpr std::size_t kStepBytes = 288, kComponentBytes = 704, kCornersBytes = 448;

  /// Prediction errors of a vertex, and its number of triangles.
  struct Mark {
    std::uint16_t along = 8, across = 8, color = 8;
    std::uint8_t triangles = 0;
  };
  struct Models {
    // Contexts of the first pair: the gap, the number of triangles at the gap's vertex, and whether the gap's edges
    // differ in length. Contexts of the second pair: the gap, and the numbers of triangles at its two ends.
    std::array<std::array<std::array<TwoRates, 2>, kTurns>, kGaps> closes, twice;
    std::array<std::array<std::array<TwoRates, kTurns>, kTurns>, kGaps / 2 + 1> closes_ends, twice_ends;
    std::array<std::array<TwoRates, kTurns>, kGaps> fresh;
    std::array<TwoRates, 2> left, rim;
    std::array<Lengths, 2> starts;
    Digits start_digits;
    // First index: one or two new triangles. Second index: the prediction errors at nearby vertices.
    std::array<std::array<std::array<Lengths, 8>, kRanks>, 2> along, across;
    std::array<std::array<std::array<Lengths, 16>, kGaps>, 2> along_gap, across_fold;
    std::array<Digits, 2> along_digits, across_digits;
    std::array<std::array<Lengths, 16>, 3> colors;
    std::array<std::array<Lengths, 10>, 3> colors_before;
    std::array<Digits, 3> color_digits;
    std::array<std::array<TwoRates, GateQueue::kRanks>, GateQueue::kRanks> ranks;  // indexed by the previous rank
  };
  /// Surroundings of a new vertex.
  struct Site {
    std::uint32_t a, b, o, r, o2;
    std::uint32_t side, behind, before;  // the gate, the next side and the previous side in the chain
    std::uint32_t gap = 0;
    bool closes = false;  // the next side is open
    bool two = false;
  };

  /// Codes the texture coordinates of new triangles.
  bool corners();
  [[nodiscard]] std::size_t corners_bytes() const { return corners_.wanted() ? kCornersBytes : 0; }
  [[nodiscard]] int top() const { return (1 << header_.bits) - 1; }
  [[nodiscard]] std::size_t turns(std::uint32_t v) const { return std::min<std::size_t>(marks_[v].triangles, 9); }
  [[nodiscard]] std::uint32_t gap_behind(std::uint32_t side) const;
  void wait(std::uint32_t side) {
    if (gates_.open(side)) queue_.push(side, gates_.next(side), gap_behind(side), rank_at(gates_.to(side)));
  }
  std::uint32_t rank_at(std::uint32_t vertex);
  bool add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t half, std::uint32_t& side);
  bool add_vertex(const glm::ivec3& place, const glm::ivec3& color, Mark mark);
  bool component();
  bool beside(const GateQueue::Gate& gate);
  bool close(const Site& site, std::uint32_t half);
  bool fresh(Site& site, std::uint32_t half, std::array<std::size_t, 4> context);
  bool attach_left(const Site& site, std::uint32_t half);
  bool attach_far(const Site& site, std::uint32_t half);
  bool vertex(const Site& site);
  [[nodiscard]] glm::ivec3 expected(const Site& site, std::array<glm::ivec3, kNear>& near,
                                    std::size_t& situation) const;
  glm::ivec3 color(const glm::ivec3& expected, std::uint32_t activity, std::uint16_t& told);

  Decisions<Coder> decisions_;
  const TailHeader& header_;
  Guide& guide_;
  std::unique_ptr<Models> models_;
  Gates gates_;
  GateQueue queue_;
  std::vector<glm::ivec3> places_, colors_;
  std::vector<Mark> marks_;
  std::vector<std::uint8_t> ranks_;  // rank of each cell
  CornerGrowth<Coder> corners_;
  std::uint32_t last_rank_ = 0;
  bool in_component_ = false;
};

template <class Coder, class Guide>
template <class More>
typename MeshGrowth<Coder, Guide>::Growth MeshGrowth<Coder, Guide>::run(const More& more) {
  while (in_component_ || gates_.triangles().size() < header_.triangles) {
    if (!in_component_) {
      if (!more(kComponentBytes + corners_bytes())) return Growth::growing;
      if (!component() || !corners()) return Growth::wrong;
      in_component_ = true;
    }
    while (in_component_) {
      if (!more(kStepBytes + corners_bytes())) return Growth::growing;
      const auto gate = queue_.pop(gates_);
      in_component_ = gate.has_value();
      if (gate && (!beside(*gate) || !corners() || !decisions_.good())) return Growth::wrong;
    }
  }
  if (!more(kStepBytes)) return Growth::growing;
  const bool good =
      places_.size() == header_.vertices && decisions_.bits(kEndMark, 16) == kEndMark && decisions_.good();
  return good ? Growth::whole : Growth::wrong;
}

template <class Coder, class Guide>
bool MeshGrowth<Coder, Guide>::corners() {
  if (!corners_.wanted()) return true;
  while (corners_.coordinates().size() < gates_.triangles().size()) {
    CornerCoordinates is{};
    if constexpr (kWrites) is = guide_.coordinates(static_cast<std::uint32_t>(corners_.coordinates().size()));
    if (!corners_.triangle(decisions_, gates_, places_, is)) return false;
  }
  return true;
}

/// Returns the rank of the cell that contains a vertex. Codes the rank when the cell is first used.
template <class Coder, class Guide>
std::uint32_t MeshGrowth<Coder, Guide>::rank_at(std::uint32_t vertex) {
  if (header_.cell_bits == 0) return 0;
  const std::size_t cell = cell_of(places_[vertex], header_.bits, header_.cell_bits);
  if (ranks_[cell] != kNoRank) return ranks_[cell];
  std::uint32_t is = 0, node = 1;
  if constexpr (kWrites) is = guide_.rank(cell);
  for (int bit = 2; bit >= 0; --bit)
    node = 2 * node + (decisions_.bit(models_->ranks[last_rank_][node], (is >> bit & 1) != 0) ? 1 : 0);
  last_rank_ = node - GateQueue::kRanks;
  ranks_[cell] = static_cast<std::uint8_t>(last_rank_);
  return last_rank_;
}

// Returns the width of the gap at b: w = 32 |a - r|^2 / (|a - b|^2 + |r - b|^2). It is 0 if both edges coincide, 32 if
// they are perpendicular, and at most 64. A gap wider than a straight angle has the width 128 - w.
template <class Coder, class Guide>
std::uint32_t MeshGrowth<Coder, Guide>::gap_behind(std::uint32_t side) const {
  const glm::ivec3 a = places_[gates_.from(side)], b = places_[gates_.to(side)], o = places_[gates_.opposite(side)];
  const glm::ivec3 r = places_[gates_.to(gates_.next(side))];
  const glm::ivec3 u = a - b, v = r - b, w = a - r;
  const std::int64_t both = dot(u, u) + dot(v, v);
  const auto narrow = static_cast<std::uint32_t>(both == 0 ? 0 : 32 * dot(w, w) / both);
  const Long3 here = reduced(cross(b - a, o - a), 30), beyond = reduced(cross(u, v), 30);
  return dot(here, beyond) < 0 ? 128 - narrow : narrow;
}

template <class Coder, class Guide>
bool MeshGrowth<Coder, Guide>::add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c,
                                            [[maybe_unused]] std::uint32_t half, std::uint32_t& side) {
  if (a == b || b == c || c == a || gates_.triangles().size() >= header_.triangles) return false;
  side = gates_.add(a, b, c);
  for (const std::uint32_t v : {a, b, c})
    if (marks_[v].triangles < 255) ++marks_[v].triangles;
  if constexpr (kWrites) guide_.added(half);
  return true;
}

template <class Coder, class Guide>
bool MeshGrowth<Coder, Guide>::add_vertex(const glm::ivec3& place, const glm::ivec3& color, Mark mark) {
  for (int axis = 0; axis < 3; ++axis)
    if (place[axis] < 0 || place[axis] > top()) return false;
  if (places_.size() >= header_.vertices) return false;
  places_.push_back(place);
  marks_.push_back(mark);
  if (!header_.colored) return true;
  colors_.push_back(color);
  Rgb8 rgb;
  return color_of(color, rgb);
}

template <class Coder, class Guide>
glm::ivec3 MeshGrowth<Coder, Guide>::color(const glm::ivec3& expected, std::uint32_t activity, std::uint16_t& told) {
  const std::size_t rank = std::min<std::size_t>(grade(activity) / 2, 15);
  glm::ivec3 at = expected, is(0);
  if constexpr (kWrites) is = guide_.color();
  std::size_t before = 0;
  std::uint32_t sum = 0;
  for (int c = 0; c < 3; ++c) {
    const auto channel = static_cast<std::size_t>(c);
    const int off = decisions_.number(models_->colors[channel][rank], models_->colors_before[channel][before],
                                      models_->color_digits[channel], is[c] - at[c]);
    at[c] += off;
    const auto size = static_cast<std::uint32_t>(std::abs(off));
    before = std::min<std::size_t>(static_cast<std::size_t>(std::bit_width(size)), 9);
    sum += size;
  }
  told = static_cast<std::uint16_t>(std::min<std::uint32_t>(4 * sum, 4000));
  return at;
}

template <class Coder, class Guide>
bool MeshGrowth<Coder, Guide>::component() {
  std::uint32_t half = 0;
  if constexpr (kWrites) half = guide_.start();
  const auto first = static_cast<std::uint32_t>(places_.size());
  for (std::size_t k = 0; k < 3; ++k) {
    glm::ivec3 is(0), at = places_.empty() ? glm::ivec3((top() + 1) / 2) : places_.back();
    if constexpr (kWrites) is = guide_.fresh(half, k);
    Lengths& lengths = models_->starts[k == 0 ? 0 : 1];
    for (int axis = 0; axis < 3; ++axis)
      at[axis] += decisions_.number(lengths, lengths, models_->start_digits, is[axis] - at[axis]);
    Mark mark;
    glm::ivec3 tint(0);
    if (header_.colored) tint = color(colors_.empty() ? glm::ivec3(128, 0, 0) : colors_.back(), 24, mark.color);
    if (!add_vertex(at, tint, mark)) return false;
  }
  std::uint32_t side = 0;
  if (!add_triangle(first, first + 1, first + 2, half, side)) return false;
  for (std::uint32_t k = 0; k < 3; ++k) gates_.link(side + k, side + (k + 1) % 3);
  for (std::uint32_t k = 0; k < 3; ++k) wait(side + k);
  return true;
}

template <class Coder, class Guide>
bool MeshGrowth<Coder, Guide>::beside(const GateQueue::Gate& gate) {
  Site s{};
  s.side = gate.side;
  s.gap = gate.gap;
  s.behind = gates_.next(s.side);
  s.before = gates_.before(s.side);
  s.a = gates_.from(s.side);
  s.b = gates_.to(s.side);
  s.o = gates_.opposite(s.side);
  s.r = gates_.to(s.behind);
  s.o2 = gates_.opposite(s.behind);
  s.closes = gates_.open(s.behind);
  if (s.r == s.a) return false;
  // `half` is the other side of the gate's edge; `beyond` is the index of the opposite vertex there. kNone if missing.
  std::uint32_t half = Gates::kNone, beyond = Gates::kNone;
  bool is_fresh = false;
  if constexpr (kWrites) {
    half = guide_.beyond(s.side);
    if (half != Gates::kNone) {
      beyond = guide_.apex(half);
      is_fresh = beyond == Gates::kNone;
    }
  }
  const glm::ivec3 u = places_[s.a] - places_[s.b], v = places_[s.r] - places_[s.b];
  const std::int64_t uu = dot(u, u), vv = dot(v, v);
  const std::array<std::size_t, 4> context{s.gap / 4, turns(s.b), uu > 2 * vv || vv > 2 * uu ? 1u : 0u, 0};
  if (s.closes && decisions_.bit(models_->closes[context[0]][context[1]][context[2]],
                                 models_->closes_ends[s.gap / 8][turns(s.a)][turns(s.r)],
                                 !is_fresh && half != Gates::kNone && beyond == s.r))
    return close(s, half);
  if (decisions_.bit(models_->fresh[context[0]][s.closes ? context[1] : 0], is_fresh)) return fresh(s, half, context);
  if (gates_.open(s.before) &&
      decisions_.bit(models_->left[s.closes ? 1 : 0], half != Gates::kNone && beyond == gates_.from(s.before)))
    return attach_left(s, half);
  if (decisions_.bit(models_->rim[gates_.state(s.behind) == Gates::State::rim ? 1 : 0], half == Gates::kNone)) {
    gates_.close(s.side);
    return true;
  }
  return attach_far(s, half);
}

template <class Coder, class Guide>
bool MeshGrowth<Coder, Guide>::close(const Site& s, std::uint32_t half) {
  std::uint32_t side = 0;
  if (!add_triangle(s.b, s.a, s.r, half, side)) return false;
  const std::uint32_t after = gates_.next(s.behind);
  gates_.join(s.side, side);
  gates_.join(s.behind, side + 2);
  if (after == s.before && gates_.open(s.before)) {
    gates_.join(s.before, side + 1);
    return true;
  }
  gates_.link(s.before, side + 1);
  gates_.link(side + 1, after);
  wait(s.before);
  wait(side + 1);
  return true;
}

template <class Coder, class Guide>
bool MeshGrowth<Coder, Guide>::attach_left(const Site& s, std::uint32_t half) {
  std::uint32_t side = 0;
  if (!add_triangle(s.b, s.a, gates_.from(s.before), half, side)) return false;
  const std::uint32_t first = gates_.before(s.before);
  gates_.join(s.side, side);
  gates_.join(s.before, side + 1);
  gates_.link(first, side + 2);
  gates_.link(side + 2, s.behind);
  wait(first);
  wait(side + 2);
  return true;
}

template <class Coder, class Guide>
bool MeshGrowth<Coder, Guide>::attach_far(const Site& s, std::uint32_t half) {
  std::uint32_t there = 0;
  if constexpr (kWrites) there = guide_.side_at_apex(half, gates_);
  there = decisions_.bits(there, std::bit_width(gates_.sides()));
  if (there >= gates_.sides() || gates_.state(there) == Gates::State::joined) return false;
  const std::uint32_t into = gates_.before(there);
  std::uint32_t side = 0;
  if (!add_triangle(s.b, s.a, gates_.from(there), half, side)) return false;
  gates_.join(s.side, side);
  gates_.link(s.before, side + 1);
  gates_.link(side + 1, there);
  gates_.link(into, side + 2);
  gates_.link(side + 2, s.behind);
  for (const std::uint32_t waiting : {s.before, side + 1, into, side + 2}) wait(waiting);
  return true;
}

template <class Coder, class Guide>
bool MeshGrowth<Coder, Guide>::fresh(Site& s, std::uint32_t half, std::array<std::size_t, 4> context) {
  std::uint32_t second = Gates::kNone;
  if (s.closes) {
    if constexpr (kWrites) second = guide_.beside_fresh(half, s.r);
    s.two = decisions_.bit(models_->twice[context[0]][context[1]][context[2]],
                           models_->twice_ends[s.gap / 8][turns(s.a)][turns(s.r)], second != Gates::kNone);
  }
  if constexpr (kWrites) (void)guide_.fresh(half, 2);
  const auto x = static_cast<std::uint32_t>(places_.size());
  if (!vertex(s)) return false;
  std::uint32_t side = 0, other = 0;
  if (!add_triangle(s.b, s.a, x, half, side)) return false;
  gates_.join(s.side, side);
  gates_.link(s.before, side + 1);
  if (s.two) {
    const std::uint32_t after = gates_.next(s.behind);
    if (!add_triangle(s.b, x, s.r, second, other)) return false;
    gates_.join(side + 2, other);
    gates_.join(s.behind, other + 2);
    gates_.link(side + 1, other + 1);
    gates_.link(other + 1, after);
    wait(s.before);
    wait(side + 1);
    wait(other + 1);
  } else {
    gates_.link(side + 1, side + 2);
    gates_.link(side + 2, s.behind);
    wait(s.before);
    wait(side + 1);
    wait(side + 2);
  }
  return true;
}

template <class Coder, class Guide>
glm::ivec3 MeshGrowth<Coder, Guide>::expected(const Site& s, std::array<glm::ivec3, kNear>& near,
                                              std::size_t& situation) const {
  const std::uint32_t after = gates_.next(s.behind);
  const std::array<std::uint32_t, kNear> vertices{
      s.a, s.o, s.r, s.o2, gates_.from(s.before), gates_.to(after), gates_.opposite(s.before), gates_.opposite(after)};
  situation = s.two ? (s.gap < 48 ? 0 : 1) : !s.closes ? 5 : s.gap < 48 ? 2 : s.gap < 64 ? 3 : 4;
  std::array<std::int64_t, 3> sum{};
  for (std::size_t i = 0; i < kNear; ++i) {
    near[i] = places_[vertices[i]] - places_[s.b];
    for (int axis = 0; axis < 3; ++axis)
      sum[static_cast<std::size_t>(axis)] += std::int64_t{header_.weights[situation][i]} * near[i][axis];
  }
  glm::ivec3 at(0);
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t moved = (sum[static_cast<std::size_t>(axis)] + (1 << (kWeightBits - 1))) >> kWeightBits;
    at[axis] = static_cast<int>(std::clamp<std::int64_t>(places_[s.b][axis] + moved, 0, top()));
  }
  return at;
}

// Codes two axes relative to their prediction. Then codes the third axis relative to the predicted plane: the axis
// closest to the plane's normal.
template <class Coder, class Guide>
bool MeshGrowth<Coder, Guide>::vertex(const Site& s) {
  std::array<glm::ivec3, kNear> near{};
  std::size_t situation = 0;
  const glm::ivec3 at = expected(s, near, situation);
  const glm::ivec3 a = places_[s.a], b = places_[s.b], o = places_[s.o], r = places_[s.r], o2 = places_[s.o2];
  const Long3 here = cross(b - a, o - a), there = cross(r - b, o2 - b), between = cross(a - b, r - b);
  Long3 sum = here;
  for (std::size_t k = 0; k < 3; ++k) sum[k] += (s.closes ? there[k] : 0) + (s.two ? between[k] : 0);
  const Long3 normal = reduced(sum, 30);
  const auto size = [](std::int64_t c) { return c < 0 ? -c : c; };
  std::size_t steep = 0;
  for (std::size_t k = 1; k < 3; ++k)
    if (size(normal[k]) > size(normal[steep])) steep = k;
  const std::size_t first = (steep + 1) % 3, second = (steep + 2) % 3;

  const std::uint32_t third = s.two ? s.r : s.o;
  const std::uint32_t off_along = (std::uint32_t{marks_[s.a].along} + marks_[s.b].along + marks_[third].along) / 2;
  const std::uint32_t off_across = (std::uint32_t{marks_[s.a].across} + marks_[s.b].across + marks_[third].across) / 2;
  const auto rank = [](std::uint32_t x) { return std::min<std::size_t>(grade(x), kRanks - 1); };
  const auto edges = static_cast<std::uint64_t>(dot(a - b, a - b) + dot(o - b, o - b));
  const std::size_t scale = std::clamp(static_cast<int>(std::bit_width(edges)) / 2 - 2, 0, 7);
  // Fold between the two triangles at the gap: the squared sine of the angle between their planes.
  const Long3 n1 = reduced(here, 14), n2 = reduced(there, 14);
  const std::int64_t squares = dot(n1, n1) * dot(n2, n2), together = dot(n1, n2);
  std::int64_t bend = squares == 0 ? 0 : (squares - together * together) / std::max<std::int64_t>(1, squares >> 16);
  if (together < 0) bend = 131072 - std::min<std::int64_t>(bend, 131072);
  const std::size_t fold = std::min<std::size_t>(grade(static_cast<std::uint64_t>(bend)) / 2, kGaps - 1);

  const std::size_t two = s.two ? 1 : 0;
  Models& m = *models_;
  glm::ivec3 is(0), place = at;
  if constexpr (kWrites) is = guide_.place();
  const int f = static_cast<int>(first), e = static_cast<int>(second), z = static_cast<int>(steep);
  std::size_t rank_along = rank(off_along);
  place[f] += decisions_.number(m.along[two][rank_along][scale], m.along_gap[two][s.gap / 4][rank_along * 2 / 5],
                                m.along_digits[two], is[f] - at[f]);
  const auto off_first = static_cast<std::uint32_t>(std::abs(place[f] - at[f]));
  rank_along = rank((2 * off_along + 12 * off_first) / 3);
  place[e] += decisions_.number(m.along[two][rank_along][scale], m.along_gap[two][s.gap / 4][rank_along * 2 / 5],
                                m.along_digits[two], is[e] - at[e]);
  const std::uint32_t off_both = off_first + static_cast<std::uint32_t>(std::abs(place[e] - at[e]));
  std::int64_t lifted = at[z];
  if (normal[steep] != 0) {
    std::int64_t down = normal[first] * (place[f] - at[f]) + normal[second] * (place[e] - at[e]);
    down = normal[steep] < 0 ? down : -down;
    const std::int64_t by = size(normal[steep]);
    lifted += floor_divide(2 * down + by, 2 * by);
  }
  const int flat = static_cast<int>(std::clamp<std::int64_t>(lifted, 0, top()));
  const std::size_t rank_across = rank(off_across);
  const int off_flat = decisions_.number(
      m.across[two][rank_across][std::min<std::size_t>(static_cast<std::size_t>(std::bit_width(off_both)), 7)],
      m.across_fold[two][fold][rank_across * 2 / 5], m.across_digits[two], is[z] - flat);
  place[z] = flat + off_flat;

  Mark mark;
  mark.along = static_cast<std::uint16_t>(std::min<std::uint32_t>(4 * off_both, 4000));
  mark.across =
      static_cast<std::uint16_t>(std::min<std::uint32_t>(8 * static_cast<std::uint32_t>(std::abs(off_flat)), 4000));
  glm::ivec3 tint(0);
  if (header_.colored) {
    glm::ivec3 mean = colors_[s.a] + colors_[s.b] + (s.two ? colors_[s.r] : glm::ivec3(0));
    for (int c = 0; c < 3; ++c) mean[c] = static_cast<int>(floor_divide(mean[c], s.two ? 3 : 2));
    tint = color(mean, std::uint32_t{marks_[s.a].color} + marks_[s.b].color + marks_[third].color, mark.color);
  }
  if constexpr (kWrites) guide_.learn(situation, near, is - b, off_along + 8);
  return add_vertex(place, tint, mark);
}

}  // namespace gs::qnv::exact
