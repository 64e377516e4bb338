#include "qnv/codecs/displaced/encode/thin_surface.h"

#include "base/finite.h"
#include "qnv/mesh/simplify/quadric.h"
#include "qnv/mesh/survey.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace gs::qnv {
namespace {

constexpr int kCellBits = 20;  // bits of a cell's index along an axis
// Number of triangles per face of an intersected cell's area: cells per face, averaged over directions, times two
// triangles per vertex.
constexpr double kTrianglesPerFace = 3;
// Maximum number of attempts to choose the grid, each based on the result of the previous one. The second constant is
// the accepted fraction of the requested size.
constexpr int kMaxGrids = 4;
constexpr double kNearEnough = 0.7, kCautious = 1.08;

/// Merged corners of the triangles in one cell. Lengths are in cell edges, relative to the middle of the cell.
struct ThinCell {
  std::array<float, 10> planes{};  // quadric: sum of squared distances to planes, weighted by area
  glm::vec3 places{0};  // sum of corner positions
  glm::vec3 colors{0};  // sum of corner colours
  std::uint32_t corners = 0;

  void add_plane(const glm::vec3& n, float d, float weight) {
    planes[0] += weight * n.x * n.x;
    planes[1] += weight * n.x * n.y;
    planes[2] += weight * n.x * n.z;
    planes[3] += weight * n.y * n.y;
    planes[4] += weight * n.y * n.z;
    planes[5] += weight * n.z * n.z;
    planes[6] += weight * n.x * d;
    planes[7] += weight * n.y * d;
    planes[8] += weight * n.z * d;
    planes[9] += weight * d * d;
  }

  /// Returns the cell's vertex, which lies inside the cell.
  [[nodiscard]] glm::vec3 place() const {
    const glm::dvec3 middle(places / static_cast<float>(corners));
    const displaced::Quadric q{planes[0], planes[1], planes[2], planes[3], planes[4],
                               planes[5], planes[6], planes[7], planes[8], planes[9]};
    const glm::dvec3 best = q.least(middle);
    constexpr double kReach = 0.5 + 1e-3;
    const bool inside = std::abs(best.x) <= kReach && std::abs(best.y) <= kReach && std::abs(best.z) <= kReach;
    return inside ? glm::vec3(best) : glm::vec3(middle);
  }
};

class CellGrid {
 public:
  /// `most` is the maximum number of triangles, and of cells.
  CellGrid(const Box& box, float edge, std::size_t most)
      : lower_(box.lower), edge_(edge), most_(most), table_(1 << 16, 0) {}

  /// Adds a triangle. Returns false if the limit is exceeded.
  [[nodiscard]] bool add(const Triangle& triangle) {
    if (!finite(triangle.positions[0]) || !finite(triangle.positions[1]) || !finite(triangle.positions[2])) return true;
    std::array<glm::vec3, 3> local{};
    std::array<std::uint32_t, 3> at{};
    const glm::vec3 ab = (triangle.positions[1] - triangle.positions[0]) / edge_;
    const glm::vec3 ac = (triangle.positions[2] - triangle.positions[0]) / edge_;
    const glm::vec3 across = glm::cross(ab, ac);
    const float twice = std::sqrt(glm::dot(across, across));
    if (!(twice > 0) || !std::isfinite(twice)) return true;
    const glm::vec3 normal = across / twice;
    for (std::size_t k = 0; k < 3; ++k) {
      at[k] = cell_of(triangle.positions[k], local[k]);
      ThinCell& cell = cells_[at[k]];
      cell.add_plane(normal, -glm::dot(normal, local[k]), twice);
      cell.places += local[k];
      cell.colors += glm::vec3(triangle.colors[k].r, triangle.colors[k].g, triangle.colors[k].b);
      ++cell.corners;
    }
    if (at[0] != at[1] && at[1] != at[2] && at[2] != at[0]) {
      // Starts with the smallest index, so that duplicate triangles compare equal.
      while (at[0] > at[1] || at[0] > at[2]) std::rotate(at.begin(), at.begin() + 1, at.end());
      triangles_.push_back(at);
    }
    return triangles_.size() <= most_ && cells_.size() <= most_;
  }

  [[nodiscard]] std::size_t triangles() const { return triangles_.size(); }
  [[nodiscard]] std::size_t cells() const { return cells_.size(); }

  [[nodiscard]] ThinnedSurface surface() {
    std::sort(triangles_.begin(), triangles_.end());
    triangles_.erase(std::unique(triangles_.begin(), triangles_.end()), triangles_.end());
    ThinnedSurface out;
    constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t> vertices(cells_.size(), kUnused);
    for (auto& triangle : triangles_)
      for (std::uint32_t& corner : triangle) {
        std::uint32_t& vertex = vertices[corner];
        if (vertex == kUnused) {
          vertex = static_cast<std::uint32_t>(out.positions.size());
          const ThinCell& cell = cells_[corner];
          out.positions.push_back(middle_of(keys_[corner]) + cell.place() * edge_);
          const glm::vec3 color = cell.colors / static_cast<float>(cell.corners) + 0.5f;
          out.colors.push_back({static_cast<std::uint8_t>(color.x), static_cast<std::uint8_t>(color.y),
                                static_cast<std::uint8_t>(color.z)});
        }
        corner = vertex;
      }
    out.triangles = std::move(triangles_);
    return out;
  }

 private:
  static constexpr std::uint64_t kAxis = (std::uint64_t{1} << kCellBits) - 1;

  [[nodiscard]] glm::vec3 middle_of(std::uint64_t key) const {
    const glm::vec3 cell(static_cast<float>(key & kAxis), static_cast<float>(key >> kCellBits & kAxis),
                         static_cast<float>(key >> 2 * kCellBits & kAxis));
    return lower_ + (cell + 0.5f) * edge_;
  }

  std::uint32_t cell_of(const glm::vec3& p, glm::vec3& local) {
    const glm::vec3 place = (p - lower_) / edge_;
    const glm::vec3 cell = glm::clamp(glm::floor(place), glm::vec3(0), glm::vec3(static_cast<float>(kAxis)));
    local = place - cell - 0.5f;
    const std::uint64_t key = static_cast<std::uint64_t>(cell.x) | static_cast<std::uint64_t>(cell.y) << kCellBits |
                              static_cast<std::uint64_t>(cell.z) << 2 * kCellBits;
    if (cells_.size() * 2 >= table_.size()) grow();
    std::size_t slot = slot_of(key);
    for (; table_[slot] != 0; slot = (slot + 1) & (table_.size() - 1))
      if (keys_[table_[slot] - 1] == key) return table_[slot] - 1;
    keys_.push_back(key);
    cells_.emplace_back();
    table_[slot] = static_cast<std::uint32_t>(cells_.size());
    return table_[slot] - 1;
  }
  [[nodiscard]] std::size_t slot_of(std::uint64_t key) const {
    key *= 0x9e3779b97f4a7c15ULL;
    return static_cast<std::size_t>(key ^ key >> 32) & (table_.size() - 1);
  }
  void grow() {
    table_.assign(table_.size() * 2, 0);
    for (std::size_t i = 0; i < keys_.size(); ++i) {
      std::size_t slot = slot_of(keys_[i]);
      while (table_[slot] != 0) slot = (slot + 1) & (table_.size() - 1);
      table_[slot] = static_cast<std::uint32_t>(i + 1);
    }
  }

  glm::vec3 lower_;
  float edge_;
  std::size_t most_;
  std::vector<ThinCell> cells_;
  std::vector<std::uint64_t> keys_;  // keys of the cells
  std::vector<std::uint32_t> table_;  // hash table with open addressing: cell index + 1
  std::vector<std::array<std::uint32_t, 3>> triangles_;  // triangles as cell indices
};

}  // namespace

TriangleSource ThinnedSurface::source() const {
  return [this](const TriangleSink& sink) {
    constexpr std::size_t kTogether = 4096;
    std::vector<Triangle> batch;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      Triangle& triangle = batch.emplace_back();
      for (std::size_t k = 0; k < 3; ++k) {
        triangle.positions[k] = positions[triangles[i][k]];
        triangle.colors[k] = colors[triangles[i][k]];
      }
      if (batch.size() < kTogether && i + 1 < triangles.size()) continue;
      if (!sink(batch)) return false;
      batch.clear();
    }
    return true;
  };
}

std::variant<ThinnedSurface, EncodeError> thin_surface(const TriangleSource& source, std::size_t most,
                                                       Progress* progress) {
  const auto begin = [&](const char* stage, std::uint64_t total) {
    if (!progress) return;
    progress->stage = stage;
    progress->done = 0;
    progress->total = total;
  };
  begin("reading", 0);
  SurfaceSurvey s;
  const bool read = source([&](std::span<const Triangle> triangles) {
    s.add(triangles);
    if (progress) progress->done += triangles.size();
    return !is_cancelled(progress);
  });
  if (!read) return EncodeError{is_cancelled(progress) ? "cancelled" : "the surface cannot be read"};
  if (!s.sound()) return EncodeError{"no surface to encode; expected triangles with an area"};
  const glm::vec3 size = s.box.size();
  const double longest = std::max({size.x, size.y, size.z}), finest = longest / ((1 << kCellBits) - 2);
  std::optional<CellGrid> best;
  double edge = std::sqrt(kTrianglesPerFace * s.area / static_cast<double>(most)), too_fine = 0;
  for (int grids = 0; grids < kMaxGrids || !best; ++grids) {
    edge = std::clamp(edge, finest, longest * 2);
    CellGrid grid(s.box, static_cast<float>(edge), most);
    begin("thinning", s.triangles);
    std::uint64_t done = 0;
    bool full = false;
    const bool whole = source([&](std::span<const Triangle> triangles) {
      for (const Triangle& triangle : triangles) {
        full = !grid.add(triangle);
        if (full) return false;
        ++done;
      }
      if (progress) progress->done += triangles.size();
      return !is_cancelled(progress);
    });
    if (is_cancelled(progress)) return EncodeError{"cancelled"};
    if (!whole && !full) return EncodeError{"the surface cannot be read again"};
    if (full) {
      // Assumes that the rest of the source has triangles at the same density.
      const double part = std::max(1e-3, static_cast<double>(done) / static_cast<double>(s.triangles));
      too_fine = std::max(too_fine, edge);
      if (edge >= longest * 2) return EncodeError{"the surface cannot be simplified enough"};
      edge *= std::clamp(std::sqrt(1 / part) * kCautious, 1.2, 8.0);
      continue;
    }
    const double filled = static_cast<double>(std::max(grid.triangles(), grid.cells())) / static_cast<double>(most);
    best.emplace(std::move(grid));
    if (filled >= kNearEnough || edge <= finest || too_fine > 0) break;
    edge *= std::clamp(std::sqrt(std::max(filled, 1e-6)) * kCautious, 0.02, 0.95);
  }
  return best->surface();
}

}  // namespace gs::qnv
