#include "qnv/codecs/displaced/encode/thin_surface.h"

#include "base/finite.h"
#include "qnv/base/fixed_sum.h"
#include "qnv/base/key_table.h"
#include "qnv/codecs/displaced/encode/cell_estimate.h"
#include "qnv/mesh/simplify/quadric.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <utility>

namespace gs::qnv {
namespace {

// Cells grow by this factor if their estimated number was too small.
constexpr double kCautious = 1.08;
// Maximum weight of a triangle (twice its area, in areas of a cell face), and fraction bits of the sums of weights. The
// maximum keeps sums with a few large triangles in range.
constexpr float kMostArea = 4096;
constexpr int kAreaBits = 26;

/// Merged corners of the triangles in one cell. Lengths are in cell edges, relative to the middle of the cell. The sums
/// do not depend on the order of the triangles.
struct ThinCell {
  std::array<FixedSum<kAreaBits>, 9> planes;  // quadric: sum of squared distances to planes, weighted by area
  std::array<FixedSum<30>, 3> places;         // corner positions
  std::array<std::uint64_t, 3> colors{};      // corner colours
  std::uint64_t corners = 0;

  void add_corner(const glm::vec3& n, float weight, const glm::vec3& local, const Rgb8& color) {
    const float d = -glm::dot(n, local);
    planes[0].add(weight * n.x * n.x);
    planes[1].add(weight * n.x * n.y);
    planes[2].add(weight * n.x * n.z);
    planes[3].add(weight * n.y * n.y);
    planes[4].add(weight * n.y * n.z);
    planes[5].add(weight * n.z * n.z);
    planes[6].add(weight * n.x * d);
    planes[7].add(weight * n.y * d);
    planes[8].add(weight * n.z * d);
    for (std::size_t i = 0; i < 3; ++i) places[i].add(local[static_cast<int>(i)]);
    colors[0] += color.r;
    colors[1] += color.g;
    colors[2] += color.b;
    ++corners;
  }
  void add(const ThinCell& other) {
    for (std::size_t i = 0; i < planes.size(); ++i) planes[i].add(other.planes[i]);
    for (std::size_t i = 0; i < 3; ++i) {
      places[i].add(other.places[i]);
      colors[i] += other.colors[i];
    }
    corners += other.corners;
  }

  /// Returns the cell's vertex, which lies inside the cell.
  [[nodiscard]] glm::vec3 place() const {
    const glm::dvec3 middle =
        glm::dvec3(places[0].value(), places[1].value(), places[2].value()) / static_cast<double>(corners);
    std::array<double, 9> sums{};
    for (std::size_t i = 0; i < sums.size(); ++i) sums[i] = planes[i].value();
    const displaced::Quadric q{sums[0], sums[1], sums[2], sums[3], sums[4], sums[5], sums[6], sums[7], sums[8], 0};
    const glm::dvec3 best = q.least(middle);
    constexpr double kReach = 0.5 + 1e-3;
    const bool inside = std::abs(best.x) <= kReach && std::abs(best.y) <= kReach && std::abs(best.z) <= kReach;
    return inside ? glm::vec3(best) : glm::vec3(middle);
  }
  [[nodiscard]] Rgb8 color() const {
    const auto mean = [&](std::uint64_t sum) { return static_cast<std::uint8_t>((sum + corners / 2) / corners); };
    return {mean(colors[0]), mean(colors[1]), mean(colors[2])};
  }
};

struct KeyedCell {
  std::uint64_t key = 0;
  ThinCell cell;
  [[nodiscard]] std::uint64_t hash() const { return mixed_key(key) >> 8; }
  void add(const KeyedCell& other) { cell.add(other.cell); }
};

/// Triangle with its corners in three cells. The smallest key comes first, so that duplicate triangles compare equal.
struct CellTriangle {
  std::array<std::uint64_t, 3> key{};
  [[nodiscard]] std::uint64_t hash() const { return mixed_key(key[0] + 3 * key[1] + 5 * key[2]) >> 8; }
  void add(const CellTriangle&) {}
};

/// Cells of a part of a surface. Its triangles are triples of cell keys.
struct CellSurface {
  std::vector<KeyedCell> cells;
  std::vector<CellTriangle> triangles;
};

class CellGrid {
 public:
  /// `most` is the maximum number of triangles, and of cells.
  CellGrid(const CellLattice& lattice, std::size_t most) : lattice_(lattice), most_(most) {}

  /// Adds a triangle. Returns false if the limit is exceeded.
  [[nodiscard]] bool add(const Triangle& triangle) {
    if (!finite(triangle.positions[0]) || !finite(triangle.positions[1]) || !finite(triangle.positions[2])) return true;
    const glm::vec3 ab = (triangle.positions[1] - triangle.positions[0]) / lattice_.edge;
    const glm::vec3 ac = (triangle.positions[2] - triangle.positions[0]) / lattice_.edge;
    const glm::vec3 across = glm::cross(ab, ac);
    const float twice = std::sqrt(glm::dot(across, across));
    if (!(twice > 0) || !std::isfinite(twice)) return true;
    const glm::vec3 normal = across / twice;
    std::array<std::uint32_t, 3> at{};
    for (std::size_t k = 0; k < 3; ++k) {
      glm::vec3 local;
      const std::uint64_t key = lattice_.cell_of(triangle.positions[k], local);
      at[k] = numbers_.add(key);
      if (at[k] == cells_.size()) cells_.push_back({key, {}});
      cells_[at[k]].cell.add_corner(normal, std::min(twice, kMostArea), local, triangle.colors[k]);
    }
    if (at[0] != at[1] && at[1] != at[2] && at[2] != at[0]) triangles_.push_back(at);
    return !full();
  }
  [[nodiscard]] bool full() const { return triangles_.size() > most_ || cells_.size() > most_; }
  [[nodiscard]] std::size_t triangles() const { return triangles_.size(); }

  /// Returns the cells and triangles, and releases them.
  [[nodiscard]] CellSurface take() {
    numbers_ = {};
    CellSurface out;
    out.triangles.reserve(triangles_.size());
    for (const auto& triangle : triangles_) {
      CellTriangle& added = out.triangles.emplace_back();
      for (std::size_t k = 0; k < 3; ++k) added.key[k] = cells_[triangle[k]].key;
      std::rotate(added.key.begin(), std::ranges::min_element(added.key), added.key.end());
    }
    triangles_ = {};
    out.cells = std::move(cells_);
    return out;
  }

 private:
  CellLattice lattice_;
  std::size_t most_;
  std::vector<KeyedCell> cells_;
  KeyTable numbers_;                                     // indices of the cells
  std::vector<std::array<std::uint32_t, 3>> triangles_;  // triangles as cell indices
};

/// Returns the surface of merged cells and triangles, both sorted by their keys. Drops cells without triangles.
ThinnedSurface surface_of(const CellLattice& lattice, std::span<const KeyedCell> cells,
                          std::span<const CellTriangle> triangles) {
  ThinnedSurface out;
  constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();
  KeyTable numbers;
  for (const KeyedCell& cell : cells) (void)numbers.add(cell.key);
  std::vector<std::uint32_t> vertices(cells.size(), kUnused);
  out.triangles.reserve(triangles.size());
  for (const CellTriangle& triangle : triangles) {
    auto& corners = out.triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t at = numbers.add(triangle.key[k]);
      std::uint32_t& vertex = vertices[at];
      if (vertex == kUnused) {
        const ThinCell& cell = cells[at].cell;
        vertex = static_cast<std::uint32_t>(out.positions.size());
        out.positions.push_back(lattice.middle_of(triangle.key[k]) + cell.place() * lattice.edge);
        out.colors.push_back(cell.color());
      }
      corners[k] = vertex;
    }
  }
  return out;
}

/// Merges the corners in the cells of a lattice. Returns nullopt if there are more than `most` cells or triangles.
/// Collective.
std::variant<std::optional<ThinnedSurface>, EncodeError> merged_surface(EncodeRanks& shared,
                                                                        const TriangleSource& source,
                                                                        const CellLattice& lattice, std::size_t most,
                                                                        Progress* progress) {
  CellGrid grid(lattice, most);
  auto problem = read_share(
      shared, source,
      [&](std::span<const Triangle> triangles) {
        for (const Triangle& triangle : triangles)
          if (!grid.add(triangle)) return false;
        if (progress) progress->done += triangles.size();
        return true;
      },
      progress);
  if (problem) {
    if (problem->message == kUnreadable) problem->message += " again";
    return std::move(*problem);
  }
  // A part of one rank that exceeds the limit suffices to reject the grid.
  const std::uint64_t own = grid.full() ? most + 1 : grid.triangles();
  std::uint64_t all = 0;
  for (const std::uint64_t one : gather_records(shared.ranks(), std::span(&own, 1))) all += std::min(one, most + 1);
  if (all > most) return std::nullopt;
  CellSurface surface = grid.take();
  auto triangles = merged_records(shared, std::move(surface.triangles), true);
  if (auto* failed = std::get_if<EncodeError>(&triangles)) return std::move(*failed);
  auto cells = merged_records(shared, std::move(surface.cells), true);
  if (auto* failed = std::get_if<EncodeError>(&cells)) return std::move(*failed);
  const auto& merged = std::get<std::vector<KeyedCell>>(cells);
  if (merged.size() > most) return std::nullopt;
  return surface_of(lattice, merged, std::get<std::vector<CellTriangle>>(triangles));
}

/// Counts of positions and of triangles at the start of a stored surface.
using ThinnedSizes = std::array<std::uint64_t, 2>;
static_assert(sizeof(Rgb8) == 3);

std::vector<std::byte> stored_form(const ThinnedSurface& surface) {
  const ThinnedSizes sizes{surface.positions.size(), surface.triangles.size()};
  std::vector<std::byte> bytes;
  const auto add = [&](const auto& list) {
    const auto part = std::as_bytes(std::span(list));
    bytes.insert(bytes.end(), part.begin(), part.end());
  };
  add(sizes);
  add(surface.positions);
  add(surface.colors);
  add(surface.triangles);
  return bytes;
}

/// Returns the surface in bytes of stored_form(). Returns nullopt if they are invalid or a count exceeds `most`.
std::optional<ThinnedSurface> surface_in(std::span<const std::byte> bytes, std::size_t most) {
  ThinnedSizes sizes{};
  if (bytes.size() < sizeof sizes) return std::nullopt;
  std::memcpy(sizes.data(), bytes.data(), sizeof sizes);
  bytes = bytes.subspan(sizeof sizes);
  if (sizes[0] > most || sizes[1] > most || bytes.size() != 15 * sizes[0] + 12 * sizes[1]) return std::nullopt;
  ThinnedSurface surface;
  const auto take = [&](auto& list, std::uint64_t count) {
    list.resize(static_cast<std::size_t>(count));
    const std::size_t size = std::as_bytes(std::span(list)).size();
    if (size > 0) std::memcpy(static_cast<void*>(list.data()), bytes.data(), size);
    bytes = bytes.subspan(size);
  };
  take(surface.positions, sizes[0]);
  take(surface.colors, sizes[0]);
  take(surface.triangles, sizes[1]);
  for (const auto& corners : surface.triangles)
    for (const std::uint32_t corner : corners)
      if (corner >= sizes[0]) return std::nullopt;
  return surface;
}

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

std::variant<ThinnedSurface, EncodeError> thin_surface(EncodeRanks& shared, const TriangleSource& source,
                                                       const SurfaceSurvey& survey, std::size_t most,
                                                       Progress* progress) {
  if (!survey.sound()) return EncodeError{"no surface to encode; expected triangles with an area"};
  const std::string work = "thinned " + std::to_string(most);
  if (const auto earlier = earlier_result(shared, work))
    if (auto surface = surface_in(*earlier, most)) return std::move(*surface);
  auto estimated = estimated_cell_edge(shared, source, survey, most, progress);
  if (auto* failed = std::get_if<EncodeError>(&estimated)) return std::move(*failed);
  const auto coarsest = static_cast<float>(coarsest_cell_edge(survey.box));
  for (float edge = std::get<float>(estimated);; edge = std::min(coarsest, edge * static_cast<float>(kCautious))) {
    if (progress) {
      progress->stage = "thinning";
      progress->done = 0;
      progress->total = survey.triangles / shared.count();
    }
    auto merged = merged_surface(shared, source, {survey.box.lower, edge}, most, progress);
    if (auto* failed = std::get_if<EncodeError>(&merged)) return std::move(*failed);
    if (auto& surface = std::get<std::optional<ThinnedSurface>>(merged)) {
      if (auto failed = record_result(shared, work, stored_form(*surface))) return std::move(*failed);
      return std::move(*surface);
    }
    if (edge >= coarsest) return EncodeError{"the surface cannot be simplified enough"};
  }
}

}  // namespace gs::qnv
