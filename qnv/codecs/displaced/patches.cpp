#include "qnv/codecs/displaced/patches.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace gs::qnv::displaced {

Patches::Patches(std::vector<Corners> triangles, std::uint32_t vertices)
    : triangles_(std::move(triangles)), patch_edges_(triangles_.size()), owners_(vertices, kNone), vertices_(vertices) {
  for (std::uint32_t t = 0; t < triangles_.size(); ++t)
    for (const std::uint32_t v : triangles_[t])
      if (owners_[v] == kNone) owners_[v] = t;
  const auto beside = neighbours_of(triangles_);
  for (std::uint32_t t = 0; t < triangles_.size(); ++t)
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t other = beside[t][k];
      const std::uint32_t a = triangles_[t][k], b = triangles_[t][(k + 1) % 3];
      if (other != kNone && other < t) {
        for (std::uint32_t l = 0; l < 3; ++l)
          if (triangles_[other][l] == b && triangles_[other][(l + 1) % 3] == a)
            patch_edges_[t][k] = patch_edges_[other][l];
        continue;
      }
      patch_edges_[t][k] = static_cast<std::uint32_t>(edges_.size());
      edges_.push_back({a, b, t, other});
    }
}

void Patches::set_creases(const std::vector<bool>& creases) {
  for (std::size_t e = 0; e < edges_.size() && e < creases.size(); ++e)
    edges_[e].crease = creases[e] && edges_[e].other != kNone;
}

bool Patches::has_lines() const {
  return std::any_of(edges_.begin(), edges_.end(), [](const Edge& edge) { return edge.line(); });
}

Patches Patches::cut() const {
  // Joins the corners at a vertex across edges that are not creases.
  std::vector<std::uint32_t> sets(triangles_.size() * 3);
  std::iota(sets.begin(), sets.end(), 0u);
  const auto find = [&](std::uint32_t i) {
    while (sets[i] != i) i = sets[i] = sets[sets[i]];
    return i;
  };
  const auto corner_of = [&](std::uint32_t patch, std::uint32_t vertex) {
    const Corners& t = triangles_[patch];
    return 3 * patch + (t[0] == vertex ? 0u : t[1] == vertex ? 1u : 2u);
  };
  for (const Edge& edge : edges_) {
    if (edge.line()) continue;
    for (const std::uint32_t v : {edge.from, edge.to})
      sets[find(corner_of(edge.owner, v))] = find(corner_of(edge.other, v));
  }
  std::vector<std::uint32_t> places(sets.size(), kNone);
  std::vector<Corners> triangles(triangles_.size());
  std::uint32_t vertices = 0;
  for (std::uint32_t t = 0; t < triangles_.size(); ++t)
    for (std::uint32_t k = 0; k < 3; ++k) {
      std::uint32_t& place = places[find(3 * t + k)];
      if (place == kNone) place = vertices++;
      triangles[t][k] = place;
    }
  return {std::move(triangles), vertices};
}

void Patches::grid(std::uint32_t patch, int level, std::vector<std::uint32_t>& indices) const {
  const std::size_t n = std::size_t{1} << level;
  indices.resize((n + 1) * (n + 2) / 2);
  const auto put = [&](std::size_t i, std::size_t j, std::size_t v) {
    indices[row_start(j, n) + i] = static_cast<std::uint32_t>(v);
  };
  put(0, 0, triangles_[patch][0]);
  put(n, 0, triangles_[patch][1]);
  put(0, n, triangles_[patch][2]);
  for (std::uint32_t k = 0; k < 3; ++k) {
    const std::uint32_t e = patch_edges_[patch][k];
    const bool same_way = edges_[e].from == triangles_[patch][k];
    const std::size_t start = edge_start(e, level);
    for (std::size_t t = 1; t < n; ++t) {
      const std::size_t v = start + (same_way ? t : n - t) - 1;
      if (k == 0)
        put(t, 0, v);
      else if (k == 1)
        put(n - t, t, v);
      else
        put(0, n - t, v);
    }
  }
  std::size_t v = inner_start(patch, level);
  for (std::size_t j = 1; j + 1 < n; ++j)
    for (std::size_t i = 1; i + j < n; ++i) put(i, j, v++);
}

}  // namespace gs::qnv::displaced
