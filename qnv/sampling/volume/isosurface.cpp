#include "qnv/sampling/volume/isosurface.h"

#include "qnv/sampling/volume/gradients.h"
#include "qnv/sampling/volume/marching_cubes.h"
#include "qnv/sampling/volume/volume_window.h"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace gs::qnv {
namespace {

using marching_cubes::Cases;
using marching_cubes::EdgeTriangle;
using marching_cubes::kEdges;
using marching_cubes::kFaces;

// Cell of eight voxels that the surface crosses.
struct CrossedCell {
  std::uint32_t x = 0, y = 0, z = 0;
  std::uint8_t inside = 0;  // one bit per corner; 1 means inside
  std::array<double, 8> above{};  // value - isovalue of each corner
};

struct SurfaceVertex {
  glm::vec3 position{0}, normal{0};
};

class Marcher {
 public:
  Marcher(const VolumeSource& source, const IsosurfaceOptions& options, const TriangleSink& sink, Progress* progress)
      : source_(source), layout_(source.layout), options_(options), sink_(sink), progress_(progress) {
    const glm::dmat3 axes(layout_.axes[0], layout_.axes[1], layout_.axes[2]);
    to_world_ = glm::transpose(glm::inverse(axes));
    mirrored_ = glm::determinant(axes) < 0;
  }

  std::optional<VolumeError> run() {
    const std::uint32_t nz = layout_.dimensions[2];
    if (progress_) {
      progress_->stage = "marching";
      progress_->done = 0;
      progress_->total = nz;
    }
    if (std::min({layout_.dimensions[0], layout_.dimensions[1], nz}) < 2) return std::nullopt;
    VolumeWindow window(source_, options_.threads);
    const std::uint32_t batch = window.batch();
    for (std::uint64_t z = 0; z + 1 < nz; z += batch) {
      const auto count = static_cast<std::uint32_t>(std::min<std::uint64_t>(batch, nz - 1 - z));
      const auto first = static_cast<std::int64_t>(z);
      if (!window.move_to(first - 1, first + count + 1))
        return VolumeError{"the slices from " + std::to_string(z) + " onward cannot be read"};
      if (!march(window, static_cast<std::uint32_t>(z), count)) {
        if (progress_ && progress_->cancelled) return VolumeError{"cancelled"};
        return std::nullopt;
      }
      if (progress_) progress_->done = z + count;
    }
    if (progress_) progress_->done = nz;
    return std::nullopt;
  }

 private:
  // Processes the cells above the slices z to z + count - 1 in blocks. Limits the number of blocks in memory, because a
  // noisy cell makes ten triangles.
  bool march(const VolumeWindow& window, std::uint32_t z, std::uint32_t count) {
    constexpr std::uint32_t kBlock = 1u << 14;
    constexpr std::size_t kGroup = 32;
    const std::uint32_t height = layout_.dimensions[1] - 1;
    const std::uint32_t rows = std::max(1u, kBlock / layout_.dimensions[0]), blocks = (height - 1) / rows + 1;
    const std::size_t units = std::size_t{count} * blocks;
    std::vector<std::vector<Triangle>> made(std::min(units, kGroup));
    for (std::size_t begin = 0; begin < units; begin += kGroup) {
      const std::size_t size = std::min(kGroup, units - begin);
      parallel_for(
          size,
          [&](std::size_t i) {
            made[i].clear();
            const auto y = static_cast<std::uint32_t>((begin + i) % blocks) * rows;
            const auto layer = static_cast<std::uint32_t>(z + (begin + i) / blocks);
            const std::uint32_t end = y + std::min(rows, height - y);
            for (std::uint32_t row = y; row < end; ++row) march_row(window, row, layer, made[i]);
          },
          options_.threads);
      if (progress_ && progress_->cancelled) return false;
      for (std::size_t i = 0; i < size; ++i)
        if (!made[i].empty() && !sink_(made[i])) return false;
    }
    return true;
  }

  void march_row(const VolumeWindow& window, std::uint32_t y, std::uint32_t z, std::vector<Triangle>& to) const {
    const std::array<GradientRow, 4> rows = {window.row(y, z), window.row(y + 1, z), window.row(y, z + 1),
                                             window.row(y + 1, z + 1)};
    const double isovalue = options_.isovalue;
    const auto column = [&](std::uint32_t x) {  // corners 0, 2, 4, 6 of the cell at x
      unsigned inside = 0;
      for (unsigned i = 0; i < 4; ++i) inside |= static_cast<unsigned>(rows[i].here[x] >= isovalue) << 2 * i;
      return inside;
    };
    unsigned next = column(0);
    for (std::uint32_t x = 0; x + 1 < layout_.dimensions[0]; ++x) {
      const unsigned here = next;
      next = column(x + 1);
      const unsigned inside = here | next << 1;
      if (inside == 0 || inside == 0xff) continue;
      CrossedCell cell{x, y, z, static_cast<std::uint8_t>(inside), {}};
      bool whole = true;
      for (unsigned corner = 0; corner < 8; ++corner) {
        const float value = rows[corner >> 1].here[x + (corner & 1)];
        whole = whole && value == value;
        cell.above[corner] = value - isovalue;
      }
      if (whole) march_cell(cell, rows, to);
    }
  }

  void march_cell(const CrossedCell& cell, const std::array<GradientRow, 4>& rows, std::vector<Triangle>& to) const {
    const Cases& cases = cases_;
    const std::span<const EdgeTriangle> triangles =
        cases.triangles(cell.inside, joined_faces(cell, cases.ambiguous_faces(cell.inside)));
    std::array<SurfaceVertex, 12> corners;
    unsigned known = 0;
    for (const EdgeTriangle& edges : triangles) {
      for (const std::uint8_t e : edges) {
        if ((known >> e & 1) != 0) continue;
        known |= 1u << e;
        corners[e] = corner_at(cell, e, rows);
      }
      const SurfaceVertex &a = corners[edges[0]], &b = corners[edges[mirrored_ ? 2 : 1]],
                          &c = corners[edges[mirrored_ ? 1 : 2]];
      if (a.position == b.position || b.position == c.position || c.position == a.position) continue;
      to.push_back({{a.position, b.position, c.position},
                    {a.normal, b.normal, c.normal},
                    {options_.color, options_.color, options_.color}});
    }
  }

  // Decides each ambiguous face by the value of its saddle, (ac - bd) / (a + c - b - d). Here a and c are inside, b and
  // d outside.
  static std::uint8_t joined_faces(const CrossedCell& cell, std::uint8_t ambiguous) {
    unsigned joined = 0;
    for (unsigned face = 0; ambiguous >> face != 0; ++face) {
      if ((ambiguous >> face & 1) == 0) continue;
      const auto& c = kFaces[face];
      const double even = cell.above[c[0]] * cell.above[c[2]], odd = cell.above[c[1]] * cell.above[c[3]];
      const bool even_inside = (cell.inside >> c[0] & 1) != 0;
      if (even_inside ? even >= odd : odd >= even) joined |= 1u << face;
    }
    return static_cast<std::uint8_t>(joined);
  }

  // Interpolates from the lower to the upper corner, so that all cells with this edge get the same bits.
  SurfaceVertex corner_at(const CrossedCell& cell, std::uint8_t e, const std::array<GradientRow, 4>& rows) const {
    const auto [lower, upper] = kEdges[e];
    const double low = cell.above[lower], high = cell.above[upper];
    const double t = std::clamp(low / (low - high), 0.0, 1.0);
    std::array<double, 3> place = {static_cast<double>(cell.x + (lower & 1u)),
                                   static_cast<double>(cell.y + (lower >> 1 & 1u)),
                                   static_cast<double>(cell.z + (lower >> 2 & 1u))};
    place[e / 4] += t;
    SurfaceVertex corner;
    corner.position = voxel_position(layout_, place[0], place[1], place[2]);
    const auto gradient = [&](std::uint8_t c) { return gradient_at(rows[c >> 1], cell.x + (c & 1u), to_world_); };
    const glm::dvec3 slope = gradient(lower) * (1 - t) + gradient(upper) * t;
    const double length = glm::length(slope);
    if (length > 0 && std::isfinite(length)) corner.normal = glm::vec3(slope / -length);
    return corner;
  }

  const VolumeSource& source_;
  const VolumeLayout& layout_;
  const IsosurfaceOptions& options_;
  const TriangleSink& sink_;
  Progress* progress_;
  const Cases& cases_ = Cases::get();
  glm::dmat3 to_world_{1};
  bool mirrored_ = false;
};

}  // namespace

std::optional<VolumeError> isosurface(const VolumeSource& source, const IsosurfaceOptions& options,
                                      const TriangleSink& sink, Progress* progress) {
  if (const auto problem = check(source.layout)) return problem;
  if (!source.read) return VolumeError{"the volume has no source of slices"};
  if (!std::isfinite(options.isovalue))
    return VolumeError{"the isovalue is not finite; expected a value of the volume"};
  if (!sink) return std::nullopt;
  return Marcher(source, options, sink, progress).run();
}

}  // namespace gs::qnv
