#include "qnv/displaced/manifold.h"

#include "qnv/base/finite.h"
#include "qnv/base/parallel.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

namespace gs::qnv::displaced {
namespace {

std::uint64_t hash(const glm::vec3& p) {
  std::uint64_t h = std::bit_cast<std::uint32_t>(p.x) * std::uint64_t{0x9e3779b97f4a7c15};
  h = (h ^ h >> 29 ^ std::bit_cast<std::uint32_t>(p.y)) * std::uint64_t{0xbf58476d1ce4e5b9};
  h = (h ^ h >> 32 ^ std::bit_cast<std::uint32_t>(p.z)) * std::uint64_t{0x94d049bb133111eb};
  return h ^ h >> 31;
}

/// One side of a triangle.
struct Side {
  std::uint32_t low, high;  // its vertices
  std::uint32_t at;         // 3 * triangle + corner where it begins
};

constexpr std::size_t kVerticesTogether = std::size_t{1} << 15;  // whose sides a thread sorts

/// All sides, those between the same vertices beside each other.
std::vector<Side> sorted_sides(std::span<const Corners> triangles) {
  // Counted out by the lower vertex; of each there are a few.
  std::uint32_t vertices = 0;
  for (const Corners& t : triangles) vertices = std::max({vertices, t[0] + 1, t[1] + 1, t[2] + 1});
  std::vector<std::uint32_t> ends(std::size_t{vertices} + 1, 0);
  for (const Corners& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) ++ends[std::min(t[k], t[(k + 1) % 3]) + 1];
  for (std::size_t v = 1; v < ends.size(); ++v) ends[v] += ends[v - 1];
  std::vector<Side> sides(triangles.size() * 3);
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t a = triangles[t][k], b = triangles[t][(k + 1) % 3];
      sides[ends[std::min(a, b)]++] = {std::min(a, b), std::max(a, b), 3 * t + k};
    }
  const std::size_t parts = (std::size_t{vertices} + kVerticesTogether - 1) / kVerticesTogether;
  parallel_for(parts, [&](std::size_t part) {
    std::size_t v = part * kVerticesTogether, first = v == 0 ? 0 : ends[v - 1];
    for (const std::size_t last = std::min<std::size_t>(v + kVerticesTogether, vertices); v < last; first = ends[v++])
      std::sort(sides.begin() + static_cast<std::ptrdiff_t>(first), sides.begin() + ends[v],
                [](const Side& a, const Side& b) { return a.high != b.high ? a.high < b.high : a.at < b.at; });
  });
  return sides;
}

std::uint32_t find(std::vector<std::uint32_t>& sets, std::uint32_t i) {
  while (sets[i] != i) i = sets[i] = sets[sets[i]];
  return i;
}

bool same_edge(const Side& a, const Side& b) { return a.low == b.low && a.high == b.high; }
std::uint32_t next(std::uint32_t corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; }

/// Corners at one vertex stay together where an edge of two triangles that turn the same way joins them; every fan of
/// such gets a vertex of its own.
/// `sides`: of its triangles. False where the triangles are as they were.
bool part_fans(SurfaceMesh& mesh, const std::vector<Side>& sides) {
  auto& triangles = mesh.triangles;
  std::vector<std::uint32_t> sets(triangles.size() * 3);
  std::iota(sets.begin(), sets.end(), 0u);
  const auto vertex_at = [&](std::uint32_t corner) { return triangles[corner / 3][corner % 3]; };
  for (std::size_t i = 0, end = 0; i < sides.size(); i = end) {
    for (end = i + 1; end < sides.size() && same_edge(sides[i], sides[end]);) ++end;
    if (end - i != 2) continue;
    const std::uint32_t a = sides[i].at, b = sides[i + 1].at;
    if (vertex_at(a) != vertex_at(next(b))) continue;
    sets[find(sets, a)] = find(sets, next(b));
    sets[find(sets, next(a))] = find(sets, b);
  }
  SurfaceMesh out;
  out.triangles.reserve(triangles.size());
  out.positions.reserve(mesh.positions.size());
  out.colors.reserve(mesh.colors.size());
  std::vector<std::uint32_t> places(sets.size(), kNone);
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    Corners corners;
    for (std::uint32_t k = 0; k < 3; ++k) {
      std::uint32_t& place = places[find(sets, 3 * t + k)];
      if (place == kNone) {
        place = static_cast<std::uint32_t>(out.positions.size());
        out.positions.push_back(mesh.positions[triangles[t][k]]);
        if (!mesh.colors.empty()) out.colors.push_back(mesh.colors[triangles[t][k]]);
      }
      corners[k] = place;
    }
    out.triangles.push_back(corners);
  }
  out.normals = std::move(mesh.normals);
  const bool changed = out.triangles != triangles;
  mesh = std::move(out);
  return changed;
}

/// Where fans that meet again further on leave more than two sides at an edge, all triangles but the first get vertices
/// of their own. False where there is no such edge.
bool part_crowded_edges(SurfaceMesh& mesh, const std::vector<Side>& sides) {
  bool parted = false;
  for (std::size_t i = 0, end = 0; i < sides.size(); i = end) {
    for (end = i + 1; end < sides.size() && same_edge(sides[i], sides[end]);) ++end;
    const auto begins = [&](std::size_t s) { return mesh.triangles[sides[s].at / 3][sides[s].at % 3]; };
    if (end - i == 1 || (end - i == 2 && begins(i) != begins(i + 1))) continue;
    for (std::size_t s = i + 1; s < end; ++s)
      for (std::uint32_t& v : mesh.triangles[sides[s].at / 3]) {
        mesh.positions.push_back(glm::vec3(mesh.positions[v]));
        if (!mesh.colors.empty()) mesh.colors.push_back(Rgb8(mesh.colors[v]));
        v = static_cast<std::uint32_t>(mesh.positions.size() - 1);
        parted = true;
      }
  }
  return parted;
}

/// Sorting them takes longest: what is a manifold already has the same ones all the time.
void part_at(SurfaceMesh& mesh, std::vector<Side> sides) {
  do {
    if (part_fans(mesh, sides)) sides = sorted_sides(mesh.triangles);
    if (!part_crowded_edges(mesh, sides)) return;
    sides = sorted_sides(mesh.triangles);
  } while (true);
}

}  // namespace

MeshBuilder::MeshBuilder(bool colored, bool apart) : colored_(colored), apart_(apart), table_(1 << 12, 0) {}

void MeshBuilder::grow() {
  table_.assign(table_.size() * 2, 0);
  for (std::uint32_t v = 0; v < mesh_.positions.size(); ++v) {
    std::size_t at = hash(mesh_.positions[v]) & (table_.size() - 1);
    while (table_[at] != 0) at = (at + 1) & (table_.size() - 1);
    table_[at] = v + 1;
  }
}

std::uint32_t MeshBuilder::vertex(const glm::vec3& position, Rgb8 color) {
  const glm::vec3 p = position + 0.0f;  // -0 is 0
  std::size_t at = hash(p) & (table_.size() - 1);
  for (; table_[at] != 0; at = (at + 1) & (table_.size() - 1))
    if (mesh_.positions[table_[at] - 1] == p && (!apart_ || own_colors_[table_[at] - 1] == color)) break;
  if (table_[at] == 0) {
    mesh_.positions.push_back(p);
    if (apart_) own_colors_.push_back(color);
    if (colored_) {
      sums_.emplace_back(0.0f);
      counts_.push_back(0);
    }
    table_[at] = static_cast<std::uint32_t>(mesh_.positions.size());
  }
  const std::uint32_t v = table_[at] - 1;
  if (colored_) {
    sums_[v] += glm::vec3(color.r, color.g, color.b);
    ++counts_[v];
  }
  if (mesh_.positions.size() * 2 > table_.size()) grow();
  return v;
}

void MeshBuilder::add(std::span<const Triangle> triangles) {
  for (const Triangle& t : triangles) {
    if (!finite(t.positions[0]) || !finite(t.positions[1]) || !finite(t.positions[2])) continue;
    Corners corners;
    for (std::size_t k = 0; k < 3; ++k) corners[k] = vertex(t.positions[k], t.colors[k]);
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
    mesh_.triangles.push_back(corners);
    std::array<glm::vec3, 3> normals = t.normals;
    const glm::vec3 face = glm::cross(t.positions[1] - t.positions[0], t.positions[2] - t.positions[0]);
    const float area = glm::length(face);
    for (glm::vec3& n : normals) {
      const float length = glm::length(n);
      n = length > 0 && std::isfinite(length) ? n / length : area > 0 ? face / area : glm::vec3(0);
    }
    mesh_.normals.push_back(normals);
  }
}

SurfaceMesh MeshBuilder::finish() {
  auto& triangles = mesh_.triangles;
  std::vector<Side> sides = sorted_sides(triangles);
  // Of triangles with the same corners one stays.
  {
    std::vector<bool> twice(triangles.size(), false);
    // Such meet at every side of theirs; the one between its two lowest corners tells.
    std::vector<std::pair<std::uint32_t, std::uint32_t>> there;  // the third corner, the triangle
    for (std::size_t i = 0, end = 0; i < sides.size(); i = end) {
      for (end = i + 1; end < sides.size() && same_edge(sides[i], sides[end]);) ++end;
      if (end - i == 1) continue;
      there.clear();
      for (std::size_t s = i; s < end; ++s) {
        const std::uint32_t t = sides[s].at / 3, third = triangles[t][(sides[s].at + 2) % 3];
        if (third > sides[s].high) there.emplace_back(third, t);
      }
      std::sort(there.begin(), there.end());
      for (std::size_t k = 1; k < there.size(); ++k)
        if (there[k].first == there[k - 1].first) twice[there[k].second] = true;
    }
    std::size_t kept = 0;
    for (std::size_t t = 0; t < triangles.size(); ++t)
      if (!twice[t]) {
        mesh_.normals[kept] = mesh_.normals[t];
        triangles[kept++] = triangles[t];
      }
    if (kept != triangles.size()) {
      triangles.resize(kept);
      mesh_.normals.resize(kept);
      sides = sorted_sides(triangles);
    }
  }
  SurfaceMesh out = std::move(mesh_);
  mesh_ = {};
  add_colors(out);
  part_at(out, std::move(sides));
  return out;
}

SurfaceMesh MeshBuilder::welded() const {
  SurfaceMesh out = mesh_;
  add_colors(out);
  return out;
}

void MeshBuilder::add_colors(SurfaceMesh& mesh) const {
  if (!colored_) return;
  mesh.colors.reserve(mesh.positions.size());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const glm::vec3 c = sums_[v] / static_cast<float>(counts_[v]) + 0.5f;
    mesh.colors.push_back(
        {static_cast<std::uint8_t>(c.x), static_cast<std::uint8_t>(c.y), static_cast<std::uint8_t>(c.z)});
  }
}

void part(SurfaceMesh& mesh) { part_at(mesh, sorted_sides(mesh.triangles)); }

SplitMesh split_components(const SurfaceMesh& mesh, double least_part) {
  std::vector<std::uint32_t> sets(mesh.positions.size());
  std::iota(sets.begin(), sets.end(), 0u);
  for (const Corners& t : mesh.triangles) {
    sets[find(sets, t[0])] = find(sets, t[1]);
    sets[find(sets, t[1])] = find(sets, t[2]);
  }
  std::vector<double> areas(mesh.positions.size(), 0.0);
  double all = 0;
  for (const Corners& t : mesh.triangles) {
    const glm::vec3 a = mesh.positions[t[0]];
    const auto area =
        static_cast<double>(glm::length(glm::cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a))) / 2;
    areas[find(sets, t[0])] += area;
    all += area;
  }
  SplitMesh parts;
  std::vector<std::uint32_t> places(mesh.positions.size(), kNone);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Corners& t = mesh.triangles[i];
    SurfaceMesh& part = areas[find(sets, t[0])] >= least_part * all ? parts.large : parts.small;
    Corners corners;
    for (std::size_t k = 0; k < 3; ++k) {
      std::uint32_t& place = places[t[k]];
      if (place == kNone) {
        place = static_cast<std::uint32_t>(part.positions.size());
        part.positions.push_back(mesh.positions[t[k]]);
        if (!mesh.colors.empty()) part.colors.push_back(mesh.colors[t[k]]);
      }
      corners[k] = place;
    }
    part.triangles.push_back(corners);
    if (!mesh.normals.empty()) part.normals.push_back(mesh.normals[i]);
  }
  return parts;
}

std::vector<std::array<std::uint32_t, 3>> neighbours_of(std::span<const Corners> triangles) {
  std::vector<std::array<std::uint32_t, 3>> beside(triangles.size(), {kNone, kNone, kNone});
  const std::vector<Side> sides = sorted_sides(triangles);
  for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
    const Side &a = sides[i], &b = sides[i + 1];
    if (a.low != b.low || a.high != b.high) continue;
    beside[a.at / 3][a.at % 3] = b.at / 3;
    beside[b.at / 3][b.at % 3] = a.at / 3;
  }
  return beside;
}

}  // namespace gs::qnv::displaced
