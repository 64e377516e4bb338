#include "qnv/codecs/displaced/tessellation/patch_mesh.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace gs::qnv {
namespace {

/// Returns how far a new vertex of a level has moved to its own position, from 0 to 1.
float part_of_way(float detail, int level) { return std::clamp(detail - static_cast<float>(level - 1), 0.0f, 1.0f); }

using Float4 = float __attribute__((vector_size(16)));
using Int4 = std::int32_t __attribute__((vector_size(16)));

/// Positions and normals of four vertices, one array per coordinate.
struct FourVertices {
  Float4 x, y, z;
  Int4 normal;
};

void transpose(std::array<Float4, 4>& v) {
  const Float4 a = __builtin_shufflevector(v[0], v[1], 0, 4, 1, 5), b = __builtin_shufflevector(v[2], v[3], 0, 4, 1, 5),
               c = __builtin_shufflevector(v[0], v[1], 2, 6, 3, 7), d = __builtin_shufflevector(v[2], v[3], 2, 6, 3, 7);
  v = {__builtin_shufflevector(a, b, 0, 1, 4, 5), __builtin_shufflevector(a, b, 2, 3, 6, 7),
       __builtin_shufflevector(c, d, 0, 1, 4, 5), __builtin_shufflevector(c, d, 2, 3, 6, 7)};
}

/// Packs one component of four directions like pack_direction().
Int4 packed_part(const Float4& v, float most, std::uint32_t mask, int shift) {
  const Float4 one = 1.0f - Float4{}, limited = (v < -one) ? -one : (v > one) ? one : v, scaled = limited * most;
  // Rounds halves away from zero.
  const Float4 half = scaled < 0.0f ? -0.5f * one : 0.5f * one;
  return (__builtin_convertvector(scaled + half, Int4) & static_cast<std::int32_t>(mask)) << shift;
}

/// Moves each new vertex to a point on the line from the midpoint of its parents (`part` = 0) to its final position
/// (`part` = 1).
void slide(std::span<const PatchTable::Middle> middles, float part, PatchVertex* vertices) {
  static_assert(sizeof(PatchVertex) == 16);
  for (std::size_t i = 0; i < middles.size(); i += 4) {
    // Pads a group of four with the last vertex; the loop then writes it several times with the same value.
    std::array<const PatchTable::Middle*, 4> m;
    for (std::size_t lane = 0; lane < 4; ++lane) m[lane] = &middles[std::min(i + lane, middles.size() - 1)];
    const auto load = [&](auto number_of) {
      std::array<Float4, 4> rows;
      for (std::size_t lane = 0; lane < 4; ++lane)
        std::memcpy(&rows[lane], vertices + number_of(*m[lane]), sizeof(PatchVertex));
      transpose(rows);
      return FourVertices{rows[0], rows[1], rows[2], std::bit_cast<Int4>(rows[3])};
    };
    const FourVertices a = load([](const PatchTable::Middle&of) { return of.parents[0]; }),
                       b = load([](const PatchTable::Middle&of) { return of.parents[1]; }),
                       own = load([](const PatchTable::Middle&of) { return of.number; });
    const auto between = [&](const Float4& from, const Float4& to, const Float4& there) {
      const Float4 middle = (from + to) * 0.5f;
      return middle + (there - middle) * part;
    };
    const auto normal = [&](int left, int right, float step) {
      const auto of = [&](const FourVertices& v) {
        return __builtin_convertvector(v.normal << left >> right, Float4) * step;
      };
      return between(of(a), of(b), of(own));
    };
    const Int4 direction = packed_part(normal(21, 21, 1 / 1023.0f), 1023, 0x7ffu, 0) |
                           packed_part(normal(10, 21, 1 / 1023.0f), 1023, 0x7ffu, 11) |
                           packed_part(normal(0, 22, 1 / 511.0f), 511, 0x3ffu, 22);
    std::array<Float4, 4> rows{between(a.x, b.x, own.x), between(a.y, b.y, own.y), between(a.z, b.z, own.z),
                               std::bit_cast<Float4>(direction)};
    transpose(rows);
    for (std::size_t lane = 0; lane < 4; ++lane)
      std::memcpy(static_cast<void*>(vertices + m[lane]->number), &rows[lane], sizeof(PatchVertex));
  }
}

Rgb8 slid(const Rgb8& a, const Rgb8& b, const Rgb8& own, float part) {
  const auto channel = [&](std::uint8_t from, std::uint8_t to, std::uint8_t there) {
    const float middle = (static_cast<float>(from) + static_cast<float>(to)) * 0.5f;
    return static_cast<std::uint8_t>(middle + (static_cast<float>(there) - middle) * part + 0.5f);
  };
  return {channel(a.r, b.r, own.r), channel(a.g, b.g, own.g), channel(a.b, b.b, own.b)};
}

}  // namespace

void PatchMesh::build(const PatchSurface& surface, const PatchCut& cut) {
  const std::size_t patch = cut.patch;
  const int level = cut.level;
  // A patch of level 0 may have the maximum number of vertices on its edges.
  constexpr std::size_t kMaxOnEdges = std::size_t{3} << displaced::kDeepestPatch, kRoom = 8;
  count_ = patch_vertices(level);
  if (vertices_.size() < count_ + kMaxOnEdges + kRoom) vertices_.resize(count_ + kMaxOnEdges + kRoom);
  colors_.resize(surface.colored() ? count_ : 0);
  std::size_t first = 0;
  for (int l = 0; l <= level; ++l) {
    const std::size_t count = new_patch_vertices(l);
    std::copy_n(surface.vertices(patch, l), count, vertices_.begin() + static_cast<std::ptrdiff_t>(first));
    if (surface.colored())
      std::copy_n(surface.colors(patch, l), count, colors_.begin() + static_cast<std::ptrdiff_t>(first));
    first += count;
  }
  // Slides edge vertices level by level, because vertices of the next level are between them.
  for (int l = 1; l <= level; ++l)
    for (std::size_t k = 0; k < 3; ++k) slide_all(patch_table(l).on_edges[k], part_of_way(cut.edge_details[k], l));
  const PatchTable& table = patch_table(level);
  if (level > 0) slide_all(table.inside, part_of_way(cut.detail, level));
  inner_ = table.inner;
  border_ = table.border;
  const int deepest = std::max({cut.edge_levels[0], cut.edge_levels[1], cut.edge_levels[2]});
  if (deepest > level) refine_edges(surface, cut, deepest);
}

void PatchMesh::slide_all(std::span<const PatchTable::Middle> middles, float part) {
  if (part >= 1) return;
  slide(middles, part, vertices_.data());
  if (colors_.empty()) return;
  for (const PatchTable::Middle& m : middles)
    colors_[m.number] = slid(colors_[m.parents[0]], colors_[m.parents[1]], colors_[m.number], part);
}

/// Adds edge vertices of levels finer than the patch's own, and the triangles at these vertices.
void PatchMesh::refine_edges(const PatchSurface& surface, const PatchCut& cut, int deepest) {
  const int level = cut.level;
  for (std::size_t k = 0; k < 3; ++k) edges_[k] = patch_table(level).edges[k];
  for (int l = level + 1; l <= deepest; ++l)
    for (std::size_t k = 0; k < 3; ++k) {
      if (l > cut.edge_levels[k]) continue;
      const std::vector<PatchTable::Number>& own = patch_table(l).edges[k];
      before_ = edges_[k];
      std::vector<PatchTable::Number>& now = edges_[k];
      now.resize(own.size());
      middles_.clear();
      for (std::size_t t = 0; t < now.size(); ++t) {
        if (t % 2 == 0) {
          now[t] = before_[t / 2];
          continue;
        }
        const std::size_t fresh = own[t] - patch_vertices(l - 1);
        now[t] = static_cast<PatchTable::Number>(count_);
        vertices_[count_++] = surface.vertices(cut.patch, l)[fresh];
        if (surface.colored()) colors_.push_back(surface.colors(cut.patch, l)[fresh]);
        middles_.push_back({now[t], {before_[t / 2], before_[t / 2 + 1]}});
      }
      slide_all(middles_, part_of_way(cut.edge_details[k], l));
    }
  split_.clear();
  const PatchTable& table = patch_table(level);
  for (std::size_t i = 0; i < table.border.size(); ++i) {
    std::array<Side, 3> sides;
    for (std::size_t k = 0; k < 3; ++k) {
      const PatchTable::Side& side = table.sides[i][k];
      if (side.edge == PatchTable::Side::kNone) continue;
      const int left = cut.edge_levels[side.edge] - level;
      sides[k] = {left, side.edge, static_cast<std::uint32_t>(side.from) << left};
    }
    split(table.border[i], sides);
  }
  border_ = split_;
}

// Splits a triangle with subdivided sides. The cut runs from the midpoint of the side with the most remaining halvings
// to the opposite corner.
void PatchMesh::split(const Triangle& corners, const std::array<Side, 3>& sides) {
  std::size_t k = 0;
  for (std::size_t other = 1; other < 3; ++other)
    if (sides[other].left > sides[k].left) k = other;
  const Side& side = sides[k];
  if (side.left == 0) {
    split_.push_back(corners);
    return;
  }
  const std::uint32_t half = 1u << (side.left - 1);
  const PatchTable::Number middle = edges_[side.edge][side.from + half];
  const std::size_t next = (k + 1) % 3, last = (k + 2) % 3;
  split({corners[k], middle, corners[last]}, {Side{side.left - 1, side.edge, side.from}, Side{}, sides[last]});
  split({middle, corners[next], corners[last]},
        {Side{side.left - 1, side.edge, side.from + half}, sides[next], Side{}});
}

}  // namespace gs::qnv
