#include "qnv/mesh/manifold.h"

#include "base/finite.h"
#include "qnv/mesh/sides.h"

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

std::uint32_t find(std::vector<std::uint32_t>& sets, std::uint32_t i) {
  while (sets[i] != i) i = sets[i] = sets[sets[i]];
  return i;
}

bool named_in_order(const SurfaceMesh& mesh) {
  std::uint32_t named = 0;
  for (const Corners& t : mesh.triangles)
    for (const std::uint32_t v : t) {
      if (v > named) return false;
      named += v == named ? 1 : 0;
    }
  return named == mesh.positions.size();
}

/// Splits vertices into fans: corners at a vertex stay together only across edges of two triangles with equal
/// orientation. Numbers the vertices in the order in which triangles use them.
void part_fans(SurfaceMesh& mesh, const Neighbours& beside) {
  auto& triangles = mesh.triangles;
  const std::vector<std::uint8_t> whole = one_fan(triangles, mesh.positions.size(), beside);
  if (std::find(whole.begin(), whole.end(), 0) == whole.end() && named_in_order(mesh)) return;
  SurfaceMesh out;
  out.triangles.reserve(triangles.size());
  out.positions.reserve(mesh.positions.size());
  out.colors.reserve(mesh.colors.size());
  std::vector<std::uint32_t> places(mesh.positions.size(), kNone), apart(triangles.size() * 3, kNone);
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    Corners corners;
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t v = triangles[t][k];
      std::uint32_t& place = whole[v] != 0 ? places[v] : apart[3 * t + k];
      if (place == kNone) {
        place = static_cast<std::uint32_t>(out.positions.size());
        out.positions.push_back(mesh.positions[v]);
        if (!mesh.colors.empty()) out.colors.push_back(mesh.colors[v]);
        if (whole[v] == 0)
          for_each_in_fan(triangles, beside, 3 * t + k, [&](std::uint32_t corner) {
            apart[corner] = place;
            return true;
          });
      }
      corners[k] = place;
    }
    out.triangles.push_back(corners);
  }
  out.normals = std::move(mesh.normals);
  mesh = std::move(out);
}

/// Splits edges that still have more than two sides because separate fans meet again there. All triangles except the
/// first get separate vertices and no neighbours. Returns false if there is no such edge. `odd` is the result of
/// join_at().
bool part_crowded_edges(SurfaceMesh& mesh, std::span<const Side> odd, Neighbours& beside) {
  for (std::size_t i = 0, end = 0; i < odd.size(); i = end) {
    for (end = i + 1; end < odd.size() && same_edge(odd[i], odd[end]);) ++end;
    for (std::size_t s = i + 1; s < end; ++s) {
      const std::uint32_t t = odd[s].at / 3;
      for (std::uint32_t& v : mesh.triangles[t]) {
        mesh.positions.push_back(glm::vec3(mesh.positions[v]));
        if (!mesh.colors.empty()) mesh.colors.push_back(Rgb8(mesh.colors[v]));
        v = static_cast<std::uint32_t>(mesh.positions.size() - 1);
      }
      for (std::uint32_t& other : beside[t]) {
        if (other == kNone) continue;
        for (std::uint32_t& back : beside[other])
          if (back == t) back = kNone;
        other = kNone;
      }
    }
  }
  return !odd.empty();
}

/// Splits non-manifold vertices and edges. Fills `beside` with the resulting neighbours.
void part_at(SurfaceMesh& mesh, const std::vector<Side>& sides, Neighbours& beside) {
  beside.assign(mesh.triangles.size(), {kNone, kNone, kNone});
  // Splitting vertices never makes other edges coincide. Therefore only the odd edges can change.
  std::vector<Side> odd = join_at(mesh.triangles, sides, beside);
  do {
    part_fans(mesh, beside);
    for (Side& side : odd) {
      const Corners& t = mesh.triangles[side.at / 3];
      const std::uint32_t a = t[side.at % 3], b = t[(side.at + 1) % 3];
      side = {std::min(a, b), std::max(a, b), side.at};
    }
    std::sort(odd.begin(), odd.end(), side_before);
    odd = join_at(mesh.triangles, odd, beside);
  } while (part_crowded_edges(mesh, odd, beside));
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
  const glm::vec3 p = position + 0.0f;  // turns -0 into 0
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

SurfaceMesh MeshBuilder::finish(Neighbours* beside) {
  auto& triangles = mesh_.triangles;
  std::vector<Side> sides = sorted_sides(triangles);
  // Keeps one of several triangles with the same corners.
  {
    std::vector<std::uint8_t> twice(triangles.size(), 0);  // not bits: threads write adjacent entries
    // Duplicate triangles share all their sides. Therefore tests only the side between the two lowest vertices.
    for_each_edge(sides, [&](std::size_t i, std::size_t end) {
      if (end - i == 1) return;
      const auto third = [&](std::size_t s) { return triangles[sides[s].at / 3][(sides[s].at + 2) % 3]; };
      if (end - i == 2 && third(i) != third(i + 1)) return;
      std::vector<std::pair<std::uint32_t, std::uint32_t>> there;  // pairs of third corner and triangle
      for (std::size_t s = i; s < end; ++s)
        if (third(s) > sides[s].high) there.emplace_back(third(s), sides[s].at / 3);
      std::sort(there.begin(), there.end());
      for (std::size_t k = 1; k < there.size(); ++k)
        if (there[k].first == there[k - 1].first) twice[there[k].second] = 1;
    });
    std::size_t kept = static_cast<std::size_t>(std::find(twice.begin(), twice.end(), 1) - twice.begin());
    for (std::size_t t = kept; t < triangles.size(); ++t)
      if (twice[t] == 0) {
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
  Neighbours found;
  part_at(out, sides, beside ? *beside : found);
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

void part(SurfaceMesh& mesh) {
  Neighbours beside;
  part_at(mesh, sorted_sides(mesh.triangles), beside);
}

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
  for (const Corners& t : mesh.triangles) {
    SurfaceMesh& part = areas[find(sets, t[0])] >= least_part * all ? parts.large : parts.small;
    Corners corners;
    for (std::size_t k = 0; k < 3; ++k) {
      std::uint32_t& place = places[t[k]];
      if (place == kNone) {
        place = static_cast<std::uint32_t>(part.positions.size());
        part.positions.push_back(mesh.positions[t[k]]);
      }
      corners[k] = place;
    }
    part.triangles.push_back(corners);
  }
  return parts;
}

Neighbours neighbours_of(std::span<const Corners> triangles) {
  Neighbours beside(triangles.size(), {kNone, kNone, kNone});
  const std::vector<Side> sides = sorted_sides(triangles);
  for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
    const Side &a = sides[i], &b = sides[i + 1];
    if (!same_edge(a, b)) continue;
    beside[a.at / 3][a.at % 3] = b.at / 3;
    beside[b.at / 3][b.at % 3] = a.at / 3;
  }
  return beside;
}

}  // namespace gs::qnv::displaced
