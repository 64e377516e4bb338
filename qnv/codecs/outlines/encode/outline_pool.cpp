#include "qnv/codecs/outlines/encode/outline_pool.h"

#include "base/finite.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace gs::qnv::outline {
namespace {

constexpr float kMaxTextureCoordinate = 65536;

/// Replaces absurd and non-finite values by 0, because they would spoil the lattice of all other values.
float sane_coordinate(float t) { return t >= -kMaxTextureCoordinate && t <= kMaxTextureCoordinate ? t : 0; }

bool finite_positions(std::span<const glm::vec3> positions) {
  return std::all_of(positions.begin(), positions.end(), [](const glm::vec3& p) { return finite(p); });
}

/// Returns the exponent of the coarsest power-of-two lattice that contains a number.
int lattice_of(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  const std::uint32_t field = bits >> 23 & 255, fraction = bits & 0x7fffff;
  if (field == 0) return fraction == 0 ? 127 : -149 + std::countr_zero(fraction);
  return static_cast<int>(field) - 150 + std::countr_zero(fraction | 0x800000u);
}

double steps(float value, int exponent) { return std::round(std::ldexp(static_cast<double>(value), -exponent)); }

template <std::size_t Axes>
struct Extent {
  std::array<float, Axes> lower, upper;
  int exact = 127;

  Extent() {
    lower.fill(std::numeric_limits<float>::infinity());
    upper.fill(-std::numeric_limits<float>::infinity());
  }
  void add(std::size_t axis, float value) {
    lower[axis] = std::min(lower[axis], value);
    upper[axis] = std::max(upper[axis], value);
    if (exact > -149) exact = std::min(exact, lattice_of(value));
  }
  [[nodiscard]] bool empty() const { return !(lower[0] <= upper[0]); }
  /// Fits a lattice with the step 2^exponent, or a coarser step, to the values. No lattice coordinate exceeds `most`.
  /// Returns false if the model is too far from the origin.
  [[nodiscard]] bool fit(int exponent, double most, OutlineLattice<Axes>& lattice) const {
    exponent = std::max({exponent, exact, -149});
    const auto fits = [&](std::size_t axis) {
      return steps(upper[axis], exponent) - steps(lower[axis], exponent) <= most;
    };
    for (std::size_t axis = 0; axis < Axes; ++axis)
      while (exponent < 127 && !fits(axis)) ++exponent;
    lattice.exponent = exponent;
    for (std::size_t axis = 0; axis < Axes; ++axis) {
      const double origin = steps(lower[axis], exponent), size = steps(upper[axis], exponent) - origin;
      if (std::abs(origin) > static_cast<double>(kMaxLatticeOrigin) || size > most) return false;
      lattice.origin[axis] = static_cast<std::int64_t>(origin);
      lattice.size[axis] = static_cast<std::uint32_t>(size);
      // Tests both ends, because the nearest lattice point may overflow near the limit of float32.
      if (!std::isfinite(lattice.at(axis, 0)) || !std::isfinite(lattice.at(axis, lattice.size[axis]))) return false;
    }
    return true;
  }
};

template <class Each>
void for_each_polygon(const OutlinePolygons& polygons, const Each& each) {
  for (std::size_t i = 0; i < polygons.size(); ++i) {
    const std::size_t ring = i == 0 ? 0 : polygons.polygon_ends[i - 1], end = polygons.polygon_ends[i];
    const std::size_t first = ring == 0 ? 0 : polygons.ring_ends[ring - 1];
    const std::size_t last = end == 0 ? 0 : polygons.ring_ends[end - 1];
    if (end > ring && finite_positions(std::span(polygons.positions).subspan(first, last - first)))
      each(i, first, last, std::span(polygons.ring_ends).subspan(ring, end - ring));
  }
}

/// Rotates the corners of a triangle so that the closing edge, which is not written, is the longest.
void turn_triangle(std::span<Corner> corners) {
  const auto length = [&](std::size_t from) {
    std::int64_t sum = 0;
    for (std::size_t axis = 0; axis < 3; ++axis)
      sum += std::abs(std::int64_t{corners[from].p[axis]} - corners[(from + 1) % 3].p[axis]);
    return sum;
  };
  std::size_t longest = 2;
  for (std::size_t i = 0; i < 2; ++i)
    if (length(i) > length(longest)) longest = i;
  std::rotate(corners.begin(), corners.begin() + static_cast<std::ptrdiff_t>((longest + 1) % 3), corners.end());
}

class Placer {
 public:
  Placer(const Lattices& lattices, std::size_t most_corners, PolygonPool& pool)
      : lattices_(lattices), most_corners_(most_corners), pool_(pool) {}

  bool place(const OutlinePolygons& polygons, std::uint32_t group) {
    order_.clear();
    bool good = true;
    for_each_polygon(polygons, [&](std::size_t i, std::size_t, std::size_t, auto) { order_.push_back(i); });
    std::stable_sort(order_.begin(), order_.end(),
                     [&](std::size_t a, std::size_t b) { return polygons.areas[a] > polygons.areas[b]; });
    for (const std::size_t i : order_) {
      const std::size_t ring = i == 0 ? 0 : polygons.polygon_ends[i - 1];
      const std::size_t first = ring == 0 ? 0 : polygons.ring_ends[ring - 1];
      quantise(polygons, first, std::span(polygons.ring_ends).subspan(ring, polygons.polygon_ends[i] - ring));
      clean(rings_);
      good = append(rings_, group, !polygons.texture_coordinates.empty()) && good;
    }
    return good;
  }

 private:
  void quantise(const OutlinePolygons& polygons, std::size_t first, std::span<const std::uint32_t> ring_ends) {
    rings_.corners.clear();
    rings_.ring_ends.clear();
    const auto coordinate = [](float value, int exponent, std::int64_t origin) {
      return static_cast<std::uint32_t>(static_cast<std::int64_t>(steps(value, exponent)) - origin);
    };
    for (std::size_t i = first; i < ring_ends.back(); ++i) {
      Corner& corner = rings_.corners.emplace_back();
      for (std::size_t axis = 0; axis < 3; ++axis)
        corner.p[axis] = coordinate(polygons.positions[i][static_cast<glm::length_t>(axis)],
                                    lattices_.positions.exponent, lattices_.positions.origin[axis]);
      for (std::size_t axis = 0; axis < 2 && !polygons.texture_coordinates.empty(); ++axis)
        corner.t[axis] = coordinate(sane_coordinate(polygons.texture_coordinates[i][static_cast<glm::length_t>(axis)]),
                                    lattices_.texture_coordinates.exponent, lattices_.texture_coordinates.origin[axis]);
    }
    for (const std::uint32_t end : ring_ends) rings_.ring_ends.push_back(static_cast<std::uint32_t>(end - first));
  }

  bool append(const LatticeRings& rings, std::uint32_t group, bool textured) {
    if (rings.ring_ends.empty()) return true;
    if (rings.corners.size() > most_corners_) {
      Polygon polygon{rings.corners, rings.ring_ends};
      polygon.group = group;
      polygon.textured = textured;
      std::vector<LatticeRings> pieces;
      if (!cut_polygon(polygon, pieces)) return false;
      for (const LatticeRings& piece : pieces)
        if (!append(piece, group, textured)) return false;
      return true;
    }
    const std::size_t first = pool_.rings.corners.size();
    pool_.polygons.push_back({group, textured, first, pool_.rings.ring_ends.size(), rings.ring_ends.size()});
    pool_.rings.corners.insert(pool_.rings.corners.end(), rings.corners.begin(), rings.corners.end());
    for (const std::uint32_t end : rings.ring_ends) pool_.rings.ring_ends.push_back(end);
    if (rings.corners.size() == 3) turn_triangle(std::span(pool_.rings.corners).subspan(first, 3));
    return true;
  }

  const Lattices& lattices_;
  std::size_t most_corners_;
  PolygonPool& pool_;
  LatticeRings rings_;
  std::vector<std::size_t> order_;
};

bool flat_triangle(std::span<const Corner> corners) {
  const auto edge = [&](std::size_t to, std::size_t axis) {
    return std::int64_t{corners[to].p[axis]} - corners[0].p[axis];
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t a = (axis + 1) % 3, b = (axis + 2) % 3;
    if (edge(1, a) * edge(2, b) != edge(1, b) * edge(2, a)) return false;
  }
  return true;
}

}  // namespace

Polygon PolygonPool::view(std::size_t polygon) const {
  const Placed& p = polygons[polygon];
  Polygon view;
  view.ring_ends = std::span(rings.ring_ends).subspan(p.first_ring, p.rings);
  view.corners = std::span(rings.corners).subspan(p.first_corner, view.ring_ends.back());
  view.group = p.group;
  view.textured = p.textured;
  return view;
}

std::optional<Lattices> choose_lattices(const OutlineGroups& groups, int position_bits, int texture_bits) {
  Extent<3> positions;
  Extent<2> coordinates;
  for (const OutlineGroup& group : groups.groups)
    for (const OutlinePolygons* polygons : {&group.outline, &group.inner})
      for_each_polygon(*polygons, [&](std::size_t, std::size_t first, std::size_t last, auto) {
        for (std::size_t i = first; i < last; ++i) {
          for (std::size_t axis = 0; axis < 3; ++axis)
            positions.add(axis, polygons->positions[i][static_cast<glm::length_t>(axis)]);
          for (std::size_t axis = 0; axis < 2 && !polygons->texture_coordinates.empty(); ++axis)
            coordinates.add(axis, sane_coordinate(polygons->texture_coordinates[i][static_cast<glm::length_t>(axis)]));
        }
      });
  Lattices lattices;
  if (positions.empty()) return std::nullopt;
  double side = 0;
  for (std::size_t axis = 0; axis < 3; ++axis)
    side = std::max(side, static_cast<double>(positions.upper[axis]) - static_cast<double>(positions.lower[axis]));
  const int exponent = side > 0 ? std::ilogb(side) - position_bits : 0;
  if (!positions.fit(exponent, std::ldexp(1.0, position_bits) - 1, lattices.positions)) return std::nullopt;
  const double most = std::ldexp(1.0, kMaxLatticeBits) - 1;
  if (!coordinates.empty() && !coordinates.fit(-texture_bits, most, lattices.texture_coordinates)) return std::nullopt;
  return lattices;
}

std::size_t most_corners(const LatticeBits& bits) {
  constexpr std::size_t kRecordBits = std::size_t{60000} * 8;
  // Margin of bits. A code with the order that suits the mean takes, on average, at most three bits more than the
  // largest number has: the length of the code grows logarithmically. Differences need a sign. Differences of w are up
  // to three times as large.
  constexpr int kMore = 4;
  int corner = 3 * (*std::max_element(bits.positions.begin(), bits.positions.end()) + kMore) + 2;
  for (const int width : bits.texture_coordinates) corner += width + kMore;
  return kRecordBits / static_cast<std::size_t>(corner + 2);
}

void clean(LatticeRings& rings) {
  std::size_t to = 0, kept = 0, from = 0;
  // Compacts in place: the write position never overtakes the read position.
  for (std::size_t ring = 0; ring < rings.ring_ends.size(); ++ring) {
    const std::size_t end = rings.ring_ends[ring], begin = to;
    for (; from < end; ++from)
      if (to == begin || rings.corners[to - 1].p != rings.corners[from].p) rings.corners[to++] = rings.corners[from];
    while (to > begin + 1 && rings.corners[to - 1].p == rings.corners[begin].p) --to;
    if (to >= begin + 3) {
      rings.ring_ends[kept++] = static_cast<std::uint32_t>(to);
    } else {
      to = begin;
      if (ring == 0) break;
    }
  }
  if (kept == 1 && to == 3 && flat_triangle(std::span(rings.corners).first(3))) to = kept = 0;
  rings.corners.resize(to);
  rings.ring_ends.resize(kept);
}

bool place_polygons(const OutlineGroups& groups, std::span<const std::uint32_t> order, bool inner,
                    const Lattices& lattices, std::size_t most_corners, PolygonPool& pool) {
  Placer placer(lattices, most_corners, pool);
  for (const std::uint32_t group : order)
    if (!placer.place(inner ? groups.groups[group].inner : groups.groups[group].outline, group)) return false;
  return true;
}

}  // namespace gs::qnv::outline
