#include "qnv/container/value_grid.h"

#include "base/bytes.h"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace gs::qnv {
namespace {

enum GridFlag : std::uint8_t { kGaps = 1, kExact = 2, kLabelled = 4, kColors = 8, kLuma = 16 };

bool spans_space(const std::array<glm::vec3, 3>& axes) {
  std::array<glm::dvec3, 3> steps;
  for (std::size_t i = 0; i < 3; ++i) {
    const double length = glm::length(glm::dvec3(axes[i]));
    if (!(length > 0) || !std::isfinite(length)) return false;
    steps[i] = glm::dvec3(axes[i]) / length;
  }
  return std::abs(glm::determinant(glm::dmat3(steps[0], steps[1], steps[2]))) >= 1e-4;
}

}  // namespace

bool sound(const ValueGrid& grid) {
  std::uint64_t samples = 1;
  glm::dvec3 reach = glm::abs(grid.origin);
  for (std::size_t i = 0; i < 3; ++i) {
    const std::uint32_t n = grid.dimensions[i];
    if (n < 1 || n > (grid.labels ? kMaxLabelEdge : kMaxSamples)) return false;
    samples *= n;
    if (samples > kMaxSamples) return false;
    reach += glm::abs(glm::dvec3(grid.axes[i])) * static_cast<double>(n);
  }
  for (int i = 0; i < 3; ++i)
    if (!(reach[i] < 1e30)) return false;
  if (grid.components < 1 || grid.components > kMaxValueComponents) return false;
  for (const double number : {grid.slope, grid.intercept, grid.unit, grid.zero})
    if (!std::isfinite(number)) return false;
  if (!spans_space(grid.axes) || grid.slope == 0 || !(grid.unit != 0)) return false;
  const auto later = [](const ValueError& a, const ValueError& b) { return a.chunks >= b.chunks; };
  const auto wrong = [](const ValueError& e) { return !(e.most >= 0) || !(e.rms >= 0) || !std::isfinite(e.rms); };
  return grid.errors.size() <= ValueGrid::kMaxValueErrors && std::ranges::none_of(grid.errors, wrong) &&
         std::ranges::adjacent_find(grid.errors, later) == grid.errors.end();
}

bool fits(const ValueGrid& grid, const ValueGrid& first) {
  return grid.dimensions == first.dimensions && grid.origin == first.origin && grid.axes == first.axes &&
         grid.components == first.components && !grid.labels && !grid.colors;
}

std::vector<std::byte> encode_value_grid(const ValueGrid& grid) {
  std::vector<std::byte> out;
  ByteWriter write(out);
  for (const std::uint32_t n : grid.dimensions) write.integer(n);
  for (int i = 0; i < 3; ++i) write.f64(grid.origin[i]);
  for (const glm::vec3& axis : grid.axes)
    for (int i = 0; i < 3; ++i) write.f32(axis[i]);
  write.integer(static_cast<std::uint8_t>(grid.stored));
  write.integer(static_cast<std::uint8_t>((grid.gaps ? kGaps : 0) | (grid.exact ? kExact : 0) |
                                          (grid.labels ? kLabelled : 0) | (grid.colors ? kColors : 0) |
                                          (grid.luma ? kLuma : 0)));
  write.integer(grid.components);
  write.integer(grid.correction);
  for (const double number : {grid.slope, grid.intercept, grid.unit, grid.zero}) write.f64(number);
  write.f64(grid.missing.value_or(std::numeric_limits<double>::quiet_NaN()));
  for (const ValueError& error : grid.errors) {
    write.integer(error.chunks);
    write.f32(error.most);
    write.f32(error.rms);
  }
  return out;
}

std::optional<ValueGrid> decode_value_grid(std::span<const std::byte> section) {
  ByteReader read(section);
  ValueGrid grid;
  for (std::uint32_t& n : grid.dimensions) n = read.integer<std::uint32_t>();
  for (int i = 0; i < 3; ++i) grid.origin[i] = read.f64();
  for (glm::vec3& axis : grid.axes)
    for (int i = 0; i < 3; ++i) axis[i] = read.f32();
  const auto stored = read.integer<std::uint8_t>(), flags = read.integer<std::uint8_t>();
  grid.components = read.integer<std::uint16_t>();
  grid.correction = read.integer<std::uint32_t>();
  grid.gaps = (flags & kGaps) != 0;
  grid.exact = (flags & kExact) != 0;
  grid.labels = (flags & kLabelled) != 0;
  grid.colors = (flags & kColors) != 0;
  grid.luma = (flags & kLuma) != 0;
  for (double* number : {&grid.slope, &grid.intercept, &grid.unit, &grid.zero}) *number = read.f64();
  if (const double missing = read.f64(); std::isfinite(missing)) grid.missing = missing;
  if (!read.good() || stored > static_cast<std::uint8_t>(VoxelType::f32) || (grid.exact && grid.correction != 0) ||
      (grid.labels && (grid.gaps || grid.exact || grid.correction != 0 || grid.components != 1)) ||
      (grid.colors && (stored != static_cast<std::uint8_t>(VoxelType::u8) || grid.components < 3 ||
                       grid.components > 4 || grid.gaps || grid.exact)) ||
      (grid.luma && !grid.colors))
    return std::nullopt;
  grid.stored = static_cast<VoxelType>(stored);
  while (read.left() >= 12) {
    ValueError error;
    error.chunks = read.integer<std::uint32_t>();
    error.most = read.f32();
    error.rms = read.f32();
    grid.errors.push_back(error);
    if (grid.errors.size() > ValueGrid::kMaxValueErrors) return std::nullopt;
  }
  return sound(grid) ? std::optional(std::move(grid)) : std::nullopt;
}

}  // namespace gs::qnv
