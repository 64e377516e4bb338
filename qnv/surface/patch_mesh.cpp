#include "qnv/surface/patch_mesh.h"

#include <glm/geometric.hpp>

#include <algorithm>

namespace gs::qnv {
namespace {

/// Which part of its way to its own place a new vertex of a level has gone.
float part_of_way(float detail, int level) { return std::clamp(detail - static_cast<float>(level - 1), 0.0f, 1.0f); }

/// Between the middle of its parents and its own.
PatchVertex slid(const PatchVertex& a, const PatchVertex& b, const PatchVertex& own, float part) {
  const glm::vec3 middle = (a.position + b.position) * 0.5f;
  const glm::vec3 mean = (unpack_direction(a.normal) + unpack_direction(b.normal)) * 0.5f;
  const glm::vec3 normal = mean + (unpack_direction(own.normal) - mean) * part;
  return {middle + (own.position - middle) * part, pack_direction(normal)};
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
  // A patch of level 0 may have the most vertices on its edges.
  constexpr std::size_t kMostOnEdges = std::size_t{3} << displaced::kDeepestPatch, kRoom = 8;
  count_ = patch_vertices(level);
  if (vertices_.size() < count_ + kMostOnEdges + kRoom) vertices_.resize(count_ + kMostOnEdges + kRoom);
  colors_.resize(surface.colored() ? count_ : 0);
  std::size_t first = 0;
  for (int l = 0; l <= level; ++l) {
    const std::size_t count = new_patch_vertices(l);
    std::copy_n(surface.vertices(patch, l), count, vertices_.begin() + static_cast<std::ptrdiff_t>(first));
    if (surface.colored())
      std::copy_n(surface.colors(patch, l), count, colors_.begin() + static_cast<std::ptrdiff_t>(first));
    first += count;
  }
  // Vertices of edges in the order of their levels, since those of the next one lie between them.
  int deepest = level;
  for (std::size_t k = 0; k < 3; ++k) {
    deepest = std::max<int>(deepest, cut.edge_levels[k]);
    edges_[k] = patch_table(0).edges[k];
  }
  for (int l = 1; l <= deepest; ++l) {
    const PatchTable& table = patch_table(l);
    for (std::size_t k = 0; k < 3; ++k) {
      if (l > cut.edge_levels[k]) continue;
      const std::vector<PatchTable::Number> before = edges_[k];
      std::vector<PatchTable::Number>& now = edges_[k];
      now.resize(table.edges[k].size());
      const float part = part_of_way(cut.edge_details[k], l);
      for (std::size_t t = 0; t < now.size(); ++t) {
        if (t % 2 == 0) {
          now[t] = before[t / 2];
          continue;
        }
        const PatchTable::Number number = table.edges[k][t];
        const std::size_t fresh = number - patch_vertices(l - 1);
        if (l <= level) {
          now[t] = number;
        } else {
          now[t] = static_cast<PatchTable::Number>(count_);
          vertices_[count_++] = surface.vertices(patch, l)[fresh];
          if (surface.colored()) colors_.push_back(surface.colors(patch, l)[fresh]);
        }
        if (part >= 1) continue;
        const std::size_t a = before[t / 2], b = before[t / 2 + 1];
        vertices_[now[t]] = slid(vertices_[a], vertices_[b], vertices_[now[t]], part);
        if (surface.colored()) colors_[now[t]] = slid(colors_[a], colors_[b], colors_[now[t]], part);
      }
    }
  }
  const PatchTable& table = patch_table(level);
  if (const float part = level > 0 ? part_of_way(cut.detail, level) : 1; part < 1) {
    const std::size_t start = patch_vertices(level - 1);
    for (std::size_t i = 0; i < table.parents.size(); ++i) {
      if (table.on_edge[i] < 3) continue;
      const std::size_t a = table.parents[i][0], b = table.parents[i][1], v = start + i;
      vertices_[v] = slid(vertices_[a], vertices_[b], vertices_[v], part);
      if (surface.colored()) colors_[v] = slid(colors_[a], colors_[b], colors_[v], part);
    }
  }
  inner_ = table.inner;
  border_.clear();
  for (const PatchTable::BorderTriangle& t : table.border) {
    std::array<Side, 3> sides;
    for (std::size_t k = 0; k < 3; ++k) {
      const PatchTable::Side& side = t.sides[k];
      if (side.edge == PatchTable::Side::kNone) continue;
      const int left = cut.edge_levels[side.edge] - level;
      sides[k] = {left, side.edge, static_cast<std::uint32_t>(side.from) << left};
    }
    split(t.corners, sides);
  }
}

// A triangle whose sides are halved is cut from the middle of the one with the most halvings to the corner opposite.
void PatchMesh::split(const Triangle& corners, const std::array<Side, 3>& sides) {
  std::size_t k = 0;
  for (std::size_t other = 1; other < 3; ++other)
    if (sides[other].left > sides[k].left) k = other;
  const Side& side = sides[k];
  if (side.left == 0) {
    border_.push_back(corners);
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
