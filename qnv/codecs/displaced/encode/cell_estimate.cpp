#include "qnv/codecs/displaced/encode/cell_estimate.h"

#include "base/finite.h"
#include "qnv/base/key_table.h"
#include "qnv/base/morton.h"

#include <glm/common.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace gs::qnv {
namespace {

// Triangles per area of a cell face: 1.5 intersected cells, averaged over the directions of the surface, times two
// triangles per vertex.
constexpr double kTrianglesPerFace = 3;
// Grids of one estimate. Cells of each grid have twice the edge of the previous one. The edge in kMiddleGrid is the one
// expected for a smooth surface.
constexpr std::size_t kGrids = 6, kMiddleGrid = 2;
constexpr int kMaxEstimates = 12;
// Target of the estimate, as a share of the limit. The margin allows for the error of the estimate.
constexpr double kAimed = 0.9;
constexpr std::size_t kAimedFrom = 64;  // smaller limits get no margin
// Expected cells of a sample if the grid is at the limit, and maximum cells of a sample. A larger sample counts as
// infinite.
constexpr std::size_t kSample = std::size_t{1} << 15, kMostSampled = std::size_t{1} << 17;

/// Number of cells or of triangles of each grid, whichever is larger.
using GridSizes = std::array<double, kGrids>;

/// Counts of cells and triangles in several grids, for the triangles of this rank.
class GridCounts {
 public:
  /// `finest` is the lattice of the first grid. Samples one in `one_in` cells; `one_in` is a power of two.
  GridCounts(const CellLattice& finest, std::uint64_t one_in) : finest_(finest), mask_(one_in - 1) {}

  void add(const Triangle& triangle) {
    if (!finite(triangle.positions[0]) || !finite(triangle.positions[1]) || !finite(triangle.positions[2])) return;
    std::array<std::uint64_t, 3> keys{};
    glm::vec3 local;
    for (std::size_t k = 0; k < 3; ++k) keys[k] = finest_.cell_of(triangle.positions[k], local);
    for (std::size_t grid = 0; grid < kGrids; ++grid) {
      for (std::size_t k = 0; k < 3; ++k)
        if ((k == 0 || keys[k] != keys[k - 1]) && sampled(keys[k])) note(grid, keys[k]);
      if (keys[0] != keys[1] && keys[1] != keys[2] && keys[2] != keys[0]) ++triangles_[grid];
      for (std::uint64_t& key : keys) key >>= 3;
    }
  }

  /// Returns the sizes of the grids for the triangles of all ranks. Collective.
  [[nodiscard]] GridSizes sizes(Ranks& ranks) const {
    GridSizes sizes{};
    const auto triangles = gather_records(ranks, std::span<const std::uint64_t>(triangles_));
    for (std::size_t i = 0; i < triangles.size(); ++i) sizes[i % kGrids] += static_cast<double>(triangles[i]);
    for (std::size_t grid = 0; grid < kGrids; ++grid) {
      auto keys = gather_records(ranks, std::span<const std::uint64_t>(samples_[grid].keys()));
      std::sort(keys.begin(), keys.end());
      keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
      const bool counted = keys.size() <= kMostSampled;
      const double cells = static_cast<double>(keys.size()) * static_cast<double>(mask_ + 1);
      sizes[grid] = counted ? std::max(sizes[grid], cells) : std::numeric_limits<double>::infinity();
    }
    return sizes;
  }

 private:
  [[nodiscard]] bool sampled(std::uint64_t key) const { return (key * 0xbf58476d1ce4e5b9ULL >> 40 & mask_) == 0; }
  void note(std::size_t grid, std::uint64_t key) {
    if (samples_[grid].size() <= kMostSampled) samples_[grid].add(key);
  }

  CellLattice finest_;
  std::uint64_t mask_;
  std::array<KeyTable, kGrids> samples_;  // sampled cells
  std::array<std::uint64_t, kGrids> triangles_{};
};

}  // namespace

std::uint64_t CellLattice::cell_of(const glm::vec3& p, glm::vec3& local) const {
  constexpr float kLast = static_cast<float>((1 << kBits) - 1);
  const glm::vec3 place = (p - lower) / edge;
  const glm::vec3 cell = glm::clamp(glm::floor(place), glm::vec3(0), glm::vec3(kLast));
  local = place - cell - 0.5f;
  return morton_encode(static_cast<std::uint32_t>(cell.x), static_cast<std::uint32_t>(cell.y),
                       static_cast<std::uint32_t>(cell.z));
}

glm::vec3 CellLattice::middle_of(std::uint64_t key) const {
  const auto cell = morton_decode(key);
  return lower +
         (glm::vec3(static_cast<float>(cell[0]), static_cast<float>(cell[1]), static_cast<float>(cell[2])) + 0.5f) *
             edge;
}

double coarsest_cell_edge(const Box& box) {
  const glm::vec3 size = box.size();
  return 2 * static_cast<double>(std::max({size.x, size.y, size.z}));
}

std::variant<float, EncodeError> estimated_cell_edge(EncodeRanks& shared, const TriangleSource& source,
                                                     const SurfaceSurvey& survey, std::size_t most,
                                                     Progress* progress) {
  const double coarsest = coarsest_cell_edge(survey.box), finest = coarsest / 2 / ((1 << CellLattice::kBits) - 2);
  const auto limit = static_cast<double>(most), aimed = most < kAimedFrom ? limit : kAimed * limit;
  const std::uint64_t one_in = std::bit_floor(std::max<std::size_t>(1, most / kSample));
  const double step = std::ldexp(1.0, kGrids - 1);  // ratio of the coarsest edge of an estimate to the finest
  double edge = std::sqrt(kTrianglesPerFace * survey.area / limit) / std::ldexp(1.0, kMiddleGrid);
  for (int estimates = 0; estimates < kMaxEstimates; ++estimates) {
    edge = std::clamp(edge, finest, coarsest);
    if (progress) {
      progress->stage = "measuring";
      progress->done = 0;
      progress->total = survey.triangles / shared.count();
    }
    GridCounts counts({survey.box.lower, static_cast<float>(edge)}, one_in);
    auto problem = read_share(
        shared, source,
        [&](std::span<const Triangle> triangles) {
          for (const Triangle& triangle : triangles) counts.add(triangle);
          if (progress) progress->done += triangles.size();
          return true;
        },
        progress);
    if (problem) return std::move(*problem);
    const GridSizes sizes = counts.sizes(shared.ranks());
    if (sizes.back() > aimed) {
      if (edge >= coarsest) return static_cast<float>(coarsest);
      edge *= step;
    } else if (sizes.front() <= aimed) {
      if (edge <= finest) return static_cast<float>(edge);
      edge /= step;
    } else {
      std::size_t fits = 1;
      while (sizes[fits] > aimed) ++fits;
      // Between two grids, the logarithm of the size is nearly linear in that of the edge.
      const double above = std::log2(sizes[fits - 1]), below = std::log2(std::max(sizes[fits], 1.0));
      const double part = std::isfinite(above) ? (std::log2(aimed) - below) / std::max(above - below, 1e-6) : 0;
      return static_cast<float>(std::ldexp(edge, static_cast<int>(fits)) * std::exp2(-std::clamp(part, 0.0, 1.0)));
    }
  }
  return static_cast<float>(std::min(edge * step, coarsest));
}

}  // namespace gs::qnv
