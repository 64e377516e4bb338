#pragma once

#include "qnv/codecs/lossless/exact_mesh.h"
#include "qnv/codecs/lossless/exact_numbers.h"
#include "qnv/codecs/lossless/gates.h"

#include <glm/common.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace gs::qnv::exact {

/// Returns the integer square root, rounded down.
[[nodiscard]] inline std::int64_t root_of(std::int64_t square) {
  auto root = static_cast<std::int64_t>(std::sqrt(static_cast<double>(square)));
  while (root > 0 && root > square / root) --root;
  while ((root + 1) <= square / (root + 1)) ++root;
  return root;
}

/// Prediction of a corner's texture coordinates from the opposite edge and, if available, the triangle on the other
/// side of that edge. `edge` and `corner` are vectors from the edge's start, on the position lattice: to the edge's end
/// and to the corner. `along` is `edge` in the texture.
struct ExpectedCorner {
  glm::ivec3 edge, corner;
  glm::ivec2 start, along;

  /// Predicts a texture that continues across the edge if both triangles are unfolded into a plane. `beyond` and
  /// `beyond_at` are the third corner of the other triangle, on the position lattice and in the texture.
  [[nodiscard]] glm::ivec2 folded(const glm::ivec3& beyond, const glm::ivec2& beyond_at) const {
    const std::int64_t square = dot(edge, edge);
    if (square == 0) return start;
    const auto [here, there] = heights(cross(edge, corner), cross(edge, beyond));
    const std::int64_t part = dot(corner, edge), beyond_part = dot(beyond, edge);
    glm::ivec2 at(0);
    for (int axis = 0; axis < 2; ++axis) {
      std::int64_t c = start[axis] + rounded(part * along[axis], square);
      if (there != 0) {
        const std::int64_t off = beyond_at[axis] - start[axis] - rounded(beyond_part * along[axis], square);
        c -= rounded(here * std::clamp(off, -kMaxOff, kMaxOff), there);
      }
      at[axis] = static_cast<int>(std::clamp(c, -kMaxOff, kMaxOff));
    }
    return at;
  }
  /// Predicts a texture that keeps the angles of the surface. `turn` is 1, or -1 if the texture is mirrored.
  [[nodiscard]] glm::ivec2 turned(int turn) const {
    const std::int64_t square = dot(edge, edge);
    if (square == 0) return start;
    const Long3 area = cross(edge, corner);
    const int shift = shift_of(area, area);
    const Long3 less = shifted(area, shift);
    const std::int64_t height = root_of(dot(less, less)) << shift, part = dot(corner, edge);
    const glm::ivec2 across(-along.y * turn, along.x * turn);
    glm::ivec2 at(0);
    for (int axis = 0; axis < 2; ++axis)
      at[axis] = static_cast<int>(
          std::clamp(start[axis] + rounded(part * along[axis] + height * across[axis], square), -kMaxOff, kMaxOff));
    return at;
  }

 private:
  static constexpr std::int64_t kMaxOff = std::int64_t{1} << 24;
  static std::int64_t rounded(std::int64_t a, std::int64_t by) { return floor_divide(2 * a + by, 2 * by); }
  static int shift_of(const Long3& a, const Long3& b) {
    std::uint64_t most = 0;
    for (const Long3* v : {&a, &b})
      for (const std::int64_t c : *v) most = std::max(most, static_cast<std::uint64_t>(c < 0 ? -c : c));
    return std::max(0, static_cast<int>(std::bit_width(most)) - 30);
  }
  static Long3 shifted(const Long3& v, int by) { return {v[0] >> by, v[1] >> by, v[2] >> by}; }
  static std::array<std::int64_t, 2> heights(const Long3& a, const Long3& b) {
    const int shift = shift_of(a, b);
    const Long3 c = shifted(a, shift), d = shifted(b, shift);
    return {root_of(dot(c, c)), root_of(dot(d, d))};
  }
};

/// Coder of the texture coordinates of a growing mesh (mesh_growth.h), triangle by triangle. Most corners have the
/// coordinates of adjacent triangles. The same code encodes and decodes; FORMAT.md, "Corners", defines it.
template <class Coder>
class CornerGrowth {
 public:
  explicit CornerGrowth(const TextureLattice& lattice)
      : top_(lattice.top()), models_(lattice.bits > 0 ? std::make_unique<Models>() : nullptr) {}

  [[nodiscard]] bool wanted() const { return models_ != nullptr; }
  [[nodiscard]] const std::vector<CornerCoordinates>& coordinates() const { return coordinates_; }
  /// Codes the corners of the next triangle. An encoder passes their coordinates in `is`; a decoder ignores `is`.
  /// Returns false if the decisions are invalid.
  bool triangle(Decisions<Coder>& decisions, const Gates& gates, const std::vector<glm::ivec3>& places,
                const CornerCoordinates& is);

 private:
  static constexpr std::size_t kRanks = 16;
  enum Situation : std::size_t { folded, turned, beside, alone, kSituations };
  struct Models {
    // Contexts: how many corners of the triangle differ so far; whether the vertex has several coordinates; how many
    // adjacent coordinates exist.
    std::array<std::array<std::array<TwoRates, 2>, 2>, 3> same;
    TwoRates other, again;
    std::array<std::array<Lengths, kRanks>, kSituations> sizes;
    std::array<std::array<Lengths, 18>, kSituations> sizes_before;
    std::array<Digits, kSituations> digits;
  };
  /// State of a vertex.
  struct Vertex {
    glm::ivec2 last{0};  // coordinates that were coded last for this vertex
    std::uint16_t off = 8;
    bool placed = false, several = false;
  };
  using Found = std::array<std::optional<glm::ivec2>, 3>;

  [[nodiscard]] std::optional<glm::ivec2> at_end(const Gates& gates, std::uint32_t side) const;
  [[nodiscard]] std::optional<glm::ivec2> at_start(const Gates& gates, std::uint32_t side) const;
  [[nodiscard]] bool joined(const Gates& gates, std::uint32_t side) const {
    return gates.state(side) == Gates::State::joined && gates.next(side) / 3 < coordinates_.size();
  }
  [[nodiscard]] glm::ivec2 expected(const Gates& gates, const std::vector<glm::ivec3>& places, std::uint32_t corner,
                                    const Found& found, Situation& situation) const;
  bool place(Decisions<Coder>& decisions, const Gates& gates, const std::vector<glm::ivec3>& places,
             std::uint32_t corner, const glm::ivec2& is, Found& found);

  int top_;
  std::unique_ptr<Models> models_;
  std::vector<CornerCoordinates> coordinates_;
  std::vector<Vertex> vertices_;
  glm::ivec2 last_{0};  // coordinates that were coded last
  int turn_ = 1;
};

/// Returns the texture coordinates at the start of a side, in the triangle on its other side.
template <class Coder>
std::optional<glm::ivec2> CornerGrowth<Coder>::at_start(const Gates& gates, std::uint32_t side) const {
  if (!joined(gates, side)) return {};
  const std::uint32_t other = gates.next(side);
  return coordinates_[other / 3][(other % 3 + 1) % 3];
}
template <class Coder>
std::optional<glm::ivec2> CornerGrowth<Coder>::at_end(const Gates& gates, std::uint32_t side) const {
  if (!joined(gates, side)) return {};
  const std::uint32_t other = gates.next(side);
  return coordinates_[other / 3][other % 3];
}

template <class Coder>
bool CornerGrowth<Coder>::triangle(Decisions<Coder>& decisions, const Gates& gates,
                                   const std::vector<glm::ivec3>& places, const CornerCoordinates& is) {
  const auto t = static_cast<std::uint32_t>(coordinates_.size());
  vertices_.resize(places.size());
  Models& m = *models_;
  Found found;
  std::size_t apart = 0;
  for (std::uint32_t k = 0; k < 3; ++k) {
    Vertex& vertex = vertices_[gates.triangles()[t][k]];
    std::optional<glm::ivec2> first = at_start(gates, 3 * t + k), second = at_end(gates, 3 * t + (k + 2) % 3);
    if (!first) first = second;
    if (first == second) second.reset();
    if (first) {
      if (decisions.bit(m.same[apart][vertex.several ? 1 : 0][second ? 1 : 0], is[k] == *first)) {
        found[k] = first;
        continue;
      }
      ++apart;
      if (second && decisions.bit(m.other, is[k] == *second)) {
        found[k] = second;
        continue;
      }
    }
    const bool known = vertex.placed && vertex.last != first && vertex.last != second;
    if (known && decisions.bit(m.again, is[k] == vertex.last)) found[k] = vertex.last;
  }
  // Codes a corner first if both other corners of the triangle have coordinates.
  const auto count = [&] { return (found[0] ? 1 : 0) + (found[1] ? 1 : 0) + (found[2] ? 1 : 0); };
  while (count() < 3) {
    std::uint32_t k = 0;
    while (found[k]) ++k;
    if (!place(decisions, gates, places, 3 * t + k, is[k], found)) return false;
  }
  const glm::ivec2 u = *found[1] - *found[0], v = *found[2] - *found[0];
  const std::int64_t area = std::int64_t{u.x} * v.y - std::int64_t{u.y} * v.x;
  if (area != 0) turn_ = area > 0 ? 1 : -1;
  coordinates_.push_back({*found[0], *found[1], *found[2]});
  for (std::uint32_t k = 0; k < 3; ++k) {
    Vertex& vertex = vertices_[gates.triangles()[t][k]];
    vertex.several = vertex.several || (vertex.placed && vertex.last != *found[k]);
    vertex.placed = true;
    vertex.last = *found[k];
  }
  return true;
}

template <class Coder>
glm::ivec2 CornerGrowth<Coder>::expected(const Gates& gates, const std::vector<glm::ivec3>& places,
                                         std::uint32_t corner, const Found& found, Situation& situation) const {
  const std::uint32_t t = corner / 3, k = corner % 3, i = (k + 1) % 3, j = (k + 2) % 3;
  situation = alone;
  if (!found[i] && !found[j]) return last_;
  situation = beside;
  if (!found[i] || !found[j]) return found[i] ? *found[i] : *found[j];
  const displaced::Corners& vertices = gates.triangles()[t];
  const glm::ivec3 from = places[vertices[i]];
  const ExpectedCorner at{places[vertices[j]] - from, places[vertices[k]] - from, *found[i], *found[j] - *found[i]};
  const std::uint32_t side = 3 * t + i;
  if (at_start(gates, side) == found[i] && at_end(gates, side) == found[j]) {
    situation = folded;
    const std::uint32_t other = gates.next(side);
    return at.folded(places[gates.opposite(other)] - from, coordinates_[other / 3][(other % 3 + 2) % 3]);
  }
  situation = turned;
  return at.turned(turn_);
}

template <class Coder>
bool CornerGrowth<Coder>::place(Decisions<Coder>& decisions, const Gates& gates, const std::vector<glm::ivec3>& places,
                                std::uint32_t corner, const glm::ivec2& is, Found& found) {
  Situation situation = alone;
  glm::ivec2 at = glm::clamp(expected(gates, places, corner, found, situation), glm::ivec2(0), glm::ivec2(top_));
  const displaced::Corners& of = gates.triangles()[corner / 3];
  const std::uint32_t k = corner % 3;
  const auto off_beside = std::uint32_t{vertices_[of[(k + 1) % 3]].off} + vertices_[of[(k + 2) % 3]].off;
  const std::size_t rank = std::min<std::size_t>(grade(off_beside) / 2, kRanks - 1);
  std::size_t before = 0;
  std::uint32_t sum = 0;
  Models& m = *models_;
  for (int axis = 0; axis < 2; ++axis) {
    const int off = decisions.number(m.sizes[situation][rank], m.sizes_before[situation][before], m.digits[situation],
                                     is[axis] - at[axis]);
    at[axis] += off;
    if (at[axis] < 0 || at[axis] > top_) return false;
    const auto size = static_cast<std::uint32_t>(std::abs(off));
    before = std::min<std::size_t>(static_cast<std::size_t>(std::bit_width(size)) + 1, 17);
    sum += size;
  }
  if (situation == folded || situation == turned)
    vertices_[of[k]].off = static_cast<std::uint16_t>(std::min<std::uint32_t>(4 * sum, 4000));
  found[k] = last_ = at;
  return true;
}

}  // namespace gs::qnv::exact
