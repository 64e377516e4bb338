#include "qnv/codecs/lossless/encode/tail_cover.h"

#include "base/parallel.h"
#include "qnv/codecs/displaced/subdivision.h"
#include "qnv/codecs/lossless/mesh_growth.h"
#include "qnv/mesh/triangle_tree.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace gs::qnv {
namespace {

constexpr int kRankCellBits = 4;
constexpr std::size_t kRankCells = std::size_t{1} << 3 * kRankCellBits;
constexpr int kCoverParts = 64;
// Search for the surface opposite a point: first reach, minimum cosine, and maximum reach. The cosine excludes the
// other side of thin parts.
constexpr float kCoverReach = 0.02f, kCoverSide = -0.2f, kAnyReach = 4;
// Minimum area of a component that the stages include, relative to the total area.
constexpr double kMinPartBeside = 2e-4;
// Weight and unit of position errors, compared to squared normal errors. Position errors matter at silhouettes.
constexpr float kOutlineWorth = 0.4f, kOutlineUnit = 0.003f;
// Weight of adjacent cells in the value of a cell.
constexpr double kBesideCell = 0.3;

std::size_t cell_at(const exact::ExactMesh& mesh, std::uint32_t vertex) {
  return exact::cell_of(mesh.vertices[vertex], mesh.bits, kRankCellBits);
}

/// Returns the triangles of components with at least `least_part` of the area, because the stages omit smaller ones.
/// Writes the indices of these triangles to `numbers`. Returns all triangles if no component is large enough.
std::vector<displaced::Corners> large_components(const displaced::SurfaceMesh& mesh, double least_part,
                                                 std::vector<std::uint32_t>& numbers) {
  std::vector<std::uint32_t> root(mesh.positions.size());
  std::iota(root.begin(), root.end(), 0u);
  const auto find = [&](std::uint32_t v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };
  std::vector<double> areas(root.size(), 0);
  const auto area = [&](const displaced::Corners& t) {
    const glm::vec3 a = mesh.positions[t[0]];
    return static_cast<double>(glm::length(glm::cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a)));
  };
  double all = 0;
  for (const displaced::Corners& t : mesh.triangles)
    for (std::size_t k = 1; k < 3; ++k) root[find(t[k])] = find(t[0]);
  for (const displaced::Corners& t : mesh.triangles) {
    areas[find(t[0])] += area(t);
    all += area(t);
  }
  std::vector<displaced::Corners> large;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    if (areas[find(mesh.triangles[t][0])] >= least_part * all) {
      large.push_back(mesh.triangles[t]);
      numbers.push_back(t);
    }
  if (!large.empty()) return large;
  numbers.resize(mesh.triangles.size());
  std::iota(numbers.begin(), numbers.end(), 0u);
  return mesh.triangles;
}

/// Returns the sums, each increased by a fraction of the sums of adjacent cells.
std::vector<double> smoothed(const std::vector<double>& sums) {
  constexpr int n = 1 << kRankCellBits;
  std::vector<double> out(kRankCells, 0);
  for (std::size_t i = 0; i < kRankCells; ++i) {
    const auto at = static_cast<int>(i);
    const int x = at % n, y = at / n % n, z = at / n / n;
    for (int dz = -1; dz <= 1; ++dz)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          if (x + dx < 0 || x + dx >= n || y + dy < 0 || y + dy >= n || z + dz < 0 || z + dz >= n) continue;
          const bool same = dx == 0 && dy == 0 && dz == 0;
          out[i] += (same ? 1 : kBesideCell) * sums[static_cast<std::size_t>(at + (dz * n + dy) * n + dx)];
        }
  }
  return out;
}

}  // namespace

TailCover::TailCover(const exact::ExactMesh& mesh, const displaced::Surface& surface, int level, unsigned threads)
    : mesh_(mesh), near_(surface.patches().size()), cell_errors_(kRankCells, 0) {
  displaced::SurfaceMesh lattice;
  const float step = 1 / static_cast<float>((1 << mesh.bits) - 1);
  for (const glm::ivec3& v : mesh.vertices) lattice.positions.push_back(glm::vec3(v) * step);
  lattice.triangles = mesh.triangles;
  std::vector<glm::vec3> normals(mesh.vertices.size(), glm::vec3(0));
  for (const displaced::Corners& t : mesh.triangles) {
    const glm::vec3 a = lattice.positions[t[0]];
    const glm::vec3 n = glm::cross(lattice.positions[t[1]] - a, lattice.positions[t[2]] - a);
    for (const std::uint32_t v : t) normals[v] += n;
  }
  std::vector<std::uint32_t> numbers;
  lattice.triangles = large_components(lattice, kMinPartBeside, numbers);
  const displaced::TriangleTree tree(lattice, threads);
  const std::vector<glm::vec3> places = surface.positions(level);
  const std::vector<std::uint32_t> vertex_of = surface.vertices_of_slots(level);
  const std::vector<glm::vec3> facing = displaced::slot_normals(surface.patches(), surface.slots(), level, places);
  std::vector<std::uint32_t> triangle(vertex_of.size(), displaced::kNone);
  std::vector<float> errors(vertex_of.size(), 0);
  constexpr std::size_t kRun = 1024;  // slots per task
  parallel_for((vertex_of.size() + kRun - 1) / kRun,
               [&](std::size_t run) {
                 for (std::size_t slot = run * kRun; slot < std::min((run + 1) * kRun, vertex_of.size()); ++slot) {
                   const glm::vec3 from = places[vertex_of[slot]];
                   displaced::SurfacePoint there = tree.nearest(from, kCoverReach, facing[slot], kCoverSide);
                   const bool opposite = there.triangle != displaced::kNone;
                   if (!opposite) there = tree.nearest(from, kAnyReach, facing[slot], -1.0f);
                   triangle[slot] = there.triangle == displaced::kNone ? displaced::kNone : numbers[there.triangle];
                   if (!opposite) continue;
                   const glm::vec3 weights = tree.weights(there);
                   glm::vec3 normal(0);
                   for (int k = 0; k < 3; ++k) {
                     const glm::vec3& n = normals[lattice.triangles[there.triangle][static_cast<std::size_t>(k)]];
                     const float length = glm::length(n);
                     if (length > 0) normal += weights[k] / length * n;
                   }
                   const float length = glm::length(normal);
                   const glm::vec3 off = (length > 0 ? normal / length : facing[slot]) - facing[slot];
                   const float away = glm::length(there.position - from) / kOutlineUnit;
                   errors[slot] = glm::dot(off, off) + kOutlineWorth * away * away;
                 }
               },
               threads);
  std::vector<std::uint32_t> grid;
  for (std::uint32_t p = 0; p < near_.size(); ++p) {
    surface.slots().grid(p, level, grid);
    for (const std::uint32_t slot : grid)
      if (triangle[slot] != displaced::kNone) near_[p].push_back(triangle[slot]);
    std::ranges::sort(near_[p]);
    near_[p].erase(std::unique(near_[p].begin(), near_[p].end()), near_[p].end());
  }
  std::vector<double> counts(kRankCells, 0);
  for (std::size_t slot = 0; slot < errors.size(); ++slot) {
    if (triangle[slot] == displaced::kNone) continue;
    const std::size_t cell = cell_at(mesh, mesh.triangles[triangle[slot]][0]);
    cell_errors_[cell] += static_cast<double>(errors[slot]);
    ++counts[cell];
  }
  for (std::size_t i = 0; i < kRankCells; ++i) cell_errors_[i] = counts[i] > 0 ? cell_errors_[i] / counts[i] : -1;
}

exact::TailRanks TailCover::ranks() const {
  std::vector<double> vertices(kRankCells, 0), areas(kRankCells, 0);
  for (const displaced::Corners& t : mesh_.triangles) {
    const glm::dvec3 a(mesh_.vertices[t[0]]);
    const glm::dvec3 n = glm::cross(glm::dvec3(mesh_.vertices[t[1]]) - a, glm::dvec3(mesh_.vertices[t[2]]) - a);
    areas[cell_at(mesh_, t[0])] += glm::length(n);
    vertices[cell_at(mesh_, t[0])] += 0.5;
  }
  for (std::size_t i = 0; i < kRankCells; ++i) areas[i] *= std::max(0.0, cell_errors_[i]);
  const std::vector<double> gains = smoothed(areas), costs = smoothed(vertices);
  std::vector<std::size_t> order;
  double all = 0;
  for (std::size_t i = 0; i < kRankCells; ++i) {
    if (vertices[i] == 0) continue;
    order.push_back(i);
    all += vertices[i];
  }
  std::ranges::stable_sort(order,
                           [&](std::size_t a, std::size_t b) { return gains[a] * costs[b] > gains[b] * costs[a]; });
  exact::TailRanks ranks{kRankCellBits, std::vector<std::uint8_t>(kRankCells, exact::GateQueue::kRanks - 1)};
  double so_far = 0;
  for (const std::size_t i : order) {
    ranks.of[i] = static_cast<std::uint8_t>(
        std::min<double>(std::floor(so_far / all * exact::GateQueue::kRanks), exact::GateQueue::kRanks - 1));
    so_far += vertices[i];
  }
  return ranks;
}

exact::Cover TailCover::cover(int stage, const exact::TailOrder& order) const {
  const std::size_t count = mesh_.triangles.size();
  std::vector<std::uint32_t> last(mesh_.vertices.size(), 0);  // triangle count after which the triangles of a
                                                              // vertex are complete
  for (std::uint32_t i = 0; i < order.triangles.size(); ++i)
    for (const std::uint32_t v : mesh_.triangles[order.triangles[i]]) last[v] = i + 1;
  exact::Cover cover;
  cover.stage = stage;
  cover.parts = kCoverParts;
  cover.triangles = static_cast<std::uint32_t>(count);
  for (const std::vector<std::uint32_t>& near : near_) {
    // Requires the adjacent triangles too, so that the mesh overlaps the patch and leaves no gap.
    std::uint64_t come = near.empty() ? count : 0;
    for (const std::uint32_t t : near)
      for (const std::uint32_t v : mesh_.triangles[t]) come = std::max<std::uint64_t>(come, last[v]);
    cover.patches.push_back(static_cast<std::uint8_t>((come * kCoverParts + count - 1) / count));
  }
  return cover;
}

}  // namespace gs::qnv
