#include "render/volume/volume_model.h"

#include "base/finite.h"
#include "base/parallel.h"
#include "qnv/sampling/volume/gradients.h"
#include "render/scene/color_ramps.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <bit>
#include <cmath>

namespace gs::render {
namespace {

constexpr std::size_t kModelRange = 16384;  // vectors per task
constexpr float kFinestCells = 128;  // cells of the finest grid along the longest edge of the box
constexpr float kEnough = 6;  // minimum vectors in a cube for a reliable density
constexpr float kBoundaryLayers = 3;  // thickness of a boundary in voxels
constexpr float kMaxSpacing = 2;  // maximum spacing, as a multiple of the 90th percentile
constexpr std::size_t kSample = 65536;  // weights that are sorted for a quantile
constexpr float kGloss = 16;  // specular exponent
constexpr double kRootOfTwo = 1.41421356237309505;

/// Returns the value at `rank` (0 to 1) of the sorted values. If there are many, uses a sample.
float quantile(const std::vector<float>& values, float rank) {
  const std::size_t step = values.size() / kSample + 1;
  std::vector<float> some;
  some.reserve(values.size() / step + 1);
  for (std::size_t i = 0; i < values.size(); i += step)
    if (std::isfinite(values[i]) && values[i] > 0) some.push_back(values[i]);
  if (some.empty()) return 0;
  const auto at = static_cast<std::ptrdiff_t>(rank * static_cast<float>(some.size() - 1));
  std::nth_element(some.begin(), some.begin() + at, some.end());
  return some[static_cast<std::size_t>(at)];
}

/// Numbers of vectors in the cells of several grids. Each grid is twice as coarse as the previous grid.
class Counts {
 public:
  Counts(std::span<const glm::vec3> positions, const Box& box, float finest) : lower_(box.lower) {
    Grid grid;
    grid.edge = finest;
    for (int i = 0; i < 3; ++i) grid.cells[i] = 1 + static_cast<int>(std::min(box.size()[i] / finest, kFinestCells));
    grid.counts.assign(grid.size(), 0);
    for (const glm::vec3& p : positions)
      if (finite(p)) grid.counts[grid.at(cell(grid, p, 0, 0), cell(grid, p, 1, 0), cell(grid, p, 2, 0))] += 1;
    grids_.push_back(std::move(grid));
    while (grids_.back().size() > 1) grids_.push_back(coarser(grids_.back()));
  }

  /// Returns the spacing of the vectors around `p`. `h` is the spacing of voxels.
  [[nodiscard]] float spacing(const glm::vec3& p, float h) const {
    if (!finite(p)) return 0;
    float n = 0, e = 0;
    for (const Grid& grid : grids_) {
      n = std::max(about(grid, p), 0.125f);
      e = grid.edge;
      if (n >= kEnough) break;
    }
    const float solid = e / h;
    if (n > solid * solid * solid) return e * std::cbrt(1 / n);
    return std::max(h, e * std::sqrt(kBoundaryLayers / n));
  }

 private:
  struct Grid {
    float edge = 0;
    std::array<int, 3> cells{};
    std::vector<float> counts;
    [[nodiscard]] std::size_t size() const {
      return static_cast<std::size_t>(cells[0]) * static_cast<std::size_t>(cells[1]) *
             static_cast<std::size_t>(cells[2]);
    }
    [[nodiscard]] std::size_t at(int x, int y, int z) const {
      return (static_cast<std::size_t>(z) * static_cast<std::size_t>(cells[1]) + static_cast<std::size_t>(y)) *
                 static_cast<std::size_t>(cells[0]) +
             static_cast<std::size_t>(x);
    }
  };

  [[nodiscard]] int cell(const Grid& grid, const glm::vec3& p, int axis, float shift) const {
    const float along = std::floor((p[axis] - lower_[axis]) / grid.edge + shift);
    return static_cast<int>(std::clamp(along, 0.0f, static_cast<float>(grid.cells[static_cast<unsigned>(axis)] - 1)));
  }

  static Grid coarser(const Grid& fine) {
    Grid grid;
    grid.edge = 2 * fine.edge;
    for (unsigned i = 0; i < 3; ++i) grid.cells[i] = (fine.cells[i] + 1) / 2;
    grid.counts.assign(grid.size(), 0);
    for (int z = 0; z < fine.cells[2]; ++z)
      for (int y = 0; y < fine.cells[1]; ++y)
        for (int x = 0; x < fine.cells[0]; ++x)
          grid.counts[grid.at(x / 2, y / 2, z / 2)] += fine.counts[fine.at(x, y, z)];
    return grid;
  }

  /// Returns the number of vectors around `p`, interpolated between cell centres, so that it is continuous.
  [[nodiscard]] float about(const Grid& grid, const glm::vec3& p) const {
    std::array<int, 3> low{}, high{};
    glm::vec3 part;
    for (int i = 0; i < 3; ++i) {
      const float along = (p[i] - lower_[i]) / grid.edge - 0.5f;
      const auto u = static_cast<unsigned>(i);
      low[u] = cell(grid, p, i, -0.5f);
      high[u] = std::min(low[u] + 1, grid.cells[u] - 1);
      part[i] = std::clamp(along - static_cast<float>(low[u]), 0.0f, 1.0f);
    }
    const auto row = [&](int y, int z) {
      const float a = grid.counts[grid.at(low[0], y, z)], b = grid.counts[grid.at(high[0], y, z)];
      return a + (b - a) * part.x;
    };
    const auto sheet = [&](int z) {
      const float a = row(low[1], z), b = row(high[1], z);
      return a + (b - a) * part.y;
    };
    const float a = sheet(low[2]), b = sheet(high[2]);
    return a + (b - a) * part.z;
  }

  glm::vec3 lower_;
  std::vector<Grid> grids_;
};

/// Returns the box of a volume: that of the description if valid, enlarged to contain all positions. The description's
/// box covers vectors that are not received yet.
Box box_of(const qnv::Volume& volume) {
  Box box;
  for (const glm::vec3& p : volume.positions)
    if (finite(p)) box.add(p);
  const Box& source = volume.description.box;
  if (!source.empty() && finite(source.lower) && finite(source.upper) && !box.empty()) {
    box.add(source.lower);
    box.add(source.upper);
  }
  return box;
}

/// Returns the largest floor(sqrt(2)^i) that is at most `n`, for n >= 1.
std::size_t power_below(std::size_t n) {
  const std::size_t whole = std::bit_floor(n);
  const auto half = static_cast<std::size_t>(static_cast<double>(whole) * kRootOfTwo);
  return half <= n ? half : whole;
}
/// Returns the smallest floor(sqrt(2)^i) that is greater than `n`, for n >= 1.
std::size_t power_above(std::size_t n) {
  const std::size_t whole = std::bit_floor(n);
  const auto half = static_cast<std::size_t>(static_cast<double>(whole) * kRootOfTwo);
  return n < half ? half : 2 * whole;
}

float attenuation(const VolumeLight& light, float distance) {
  const glm::vec3& a = light.attenuation;
  return 1 / std::max(a.x + a.y * distance + a.z * distance * distance, 1.0f);
}

float spot(const VolumeLight& light, const glm::vec3& to_light) {
  if (light.cut_off_angle >= kVolumePi) return 1;
  const float angle = std::acos(std::clamp(-glm::dot(light.direction, to_light), -1.0f, 1.0f));
  if (angle >= light.cut_off_angle) return 0;
  if (angle <= light.beam_width || !(light.beam_width < light.cut_off_angle)) return 1;
  return (angle - light.cut_off_angle) / (light.beam_width - light.cut_off_angle);
}

}  // namespace

std::span<const VolumeLight> volume_headlight() {
  static const VolumeLight light;
  return {&light, 1};
}

VolumeTransfer volume_transfer(const qnv::Description& about, std::span<const qnv::TransferPoint> points) {
  std::vector<qnv::TransferPoint> soft;
  std::span<const qnv::TransferPoint> own = points.empty() ? std::span(about.transfer) : points;
  if (own.empty()) own = soft = qnv::default_transfer(about.value_range.first, about.value_range.second);
  VolumeTransfer table{};
  if (own.empty()) return table;
  const auto color = [](const qnv::TransferPoint& p) {
    return glm::vec4(glm::vec3(p.color.r, p.color.g, p.color.b) / 255.0f, p.opacity);
  };
  for (std::size_t i = 0; i < table.size(); ++i) {
    const float value = static_cast<float>(i) / 255;
    // Find the first point above. Points that are not finite or out of order hide the points after them.
    std::size_t next = 0;
    while (next < own.size() && own[next].value < value) ++next;
    glm::vec4 entry = color(own[std::min(next, own.size() - 1)]);
    if (next > 0 && next < own.size()) {
      const float from = own[next - 1].value, width = own[next].value - from;
      if (width > 0) entry = color(own[next - 1]) + (entry - color(own[next - 1])) * ((value - from) / width);
    }
    const float opacity = entry.w > 0 ? std::min(entry.w, 0.999f) : 0.0f;
    entry.w = -std::log(1 - opacity);
    table[i] = entry;
  }
  return table;
}

VolumePrefix volume_prefix(std::size_t size, std::size_t budget) {
  if (budget == 0 || budget >= size) return {size, size};
  return {budget, std::max<std::size_t>(power_below(budget), 1)};
}

glm::vec3 volume_color_by(const qnv::Volume& volume, ColorBy by, std::size_t k) {
  const std::size_t last = std::max<std::size_t>(volume.size(), 1) - 1;
  qnv::Rgb8 color{255, 255, 255};
  switch (by) {
    case ColorBy::own:
      break;
    case ColorBy::normal: {
      const glm::vec3& n = volume.normals[k];
      const float length = std::sqrt(glm::dot(n, n));
      return length > 0 && std::isfinite(length) ? n * (0.5f / length) + 0.5f : glm::vec3(0.5f);
    }
    case ColorBy::level:
      color = level_color(octave_of(k), octave_of(last));
      break;
    case ColorBy::chunk:
      color = chunk_color(static_cast<std::uint32_t>(k / kBlockVectors));
      break;
    case ColorBy::age:
      color = age_color(last > 0 ? static_cast<double>(k) / static_cast<double>(last) : 0.0);
      break;
  }
  return glm::vec3(color.r, color.g, color.b) * (1 / 255.0f);
}

VolumeModel volume_model(const qnv::Volume& volume, unsigned threads, std::size_t counted) {
  VolumeModel model;
  const std::size_t size = volume.size();
  if (size == 0 || volume.normals.size() != size || volume.weights.size() != size ||
      (!volume.classes.empty() && volume.classes.size() != size) ||
      (!volume.colors.empty() && volume.colors.size() != size))
    return model;
  counted = std::clamp<std::size_t>(counted, 1, size);
  const std::size_t count = counted < size ? std::min(size, power_above(counted)) : size;
  const Box box = box_of(volume);
  if (box.empty()) return model;
  const glm::vec3 edges = box.size();
  const float longest = std::max({edges.x, edges.y, edges.z});
  if (!std::isfinite(longest)) return model;
  float h = volume.description.spacing;
  if (!(h > 0) || !std::isfinite(h)) h = longest / (2 * std::cbrt(static_cast<float>(size)));
  if (longest > 0) h = std::min(h, longest);
  h = std::max(h, 1e-20f);
  model.transfer = volume_transfer(volume.description);
  model.full_magnitude = quantile(volume.weights, 0.5f);
  const Counts counts(std::span(volume.positions).first(counted), box, std::max(2 * h, longest / kFinestCells));
  model.spacing.resize(count);
  parallel_for((count + kModelRange - 1) / kModelRange,
               [&](std::size_t r) {
                 for (std::size_t i = r * kModelRange; i < std::min(count, (r + 1) * kModelRange); ++i)
                   model.spacing[i] = counts.spacing(volume.positions[i], h);
               },
               threads);
  const float most = kMaxSpacing * quantile(model.spacing, 0.9f);
  for (float& s : model.spacing) s = std::min(s, most);
  // A vector with a cell does not extend beyond its cell, unless it also represents other vectors.
  if (volume.cells.size() == size && counted == size)
    for (std::size_t i = 0; i < count; ++i)
      if (volume.cells[i].edge > 0) model.spacing[i] = std::min(model.spacing[i], std::max(volume.cells[i].edge, h));
  return model;
}

glm::vec3 volume_shade(const VolumeOptions& options, const glm::vec3& color, const glm::vec3& place,
                       const glm::vec3& normal) {
  const float length2 = glm::dot(normal, normal), distance2 = glm::dot(place, place);
  const bool facing = length2 > 0 && std::isfinite(length2);
  const glm::vec3 n = facing ? normal / std::sqrt(length2) : glm::vec3(0);
  const glm::vec3 to_viewer = distance2 > 0 ? place / -std::sqrt(distance2) : glm::vec3(0, 0, 1);
  glm::vec3 diffuse(0), gloss(0);
  for (const VolumeLight& light : options.lights.empty() ? volume_headlight() : options.lights) {
    glm::vec3 to_light = light.place;
    float strength = 1;
    if (!light.directional) {
      to_light -= place;
      const float distance = std::sqrt(glm::dot(to_light, to_light));
      if (!(distance <= light.radius)) continue;
      to_light = distance > 0 ? to_light / distance : to_viewer;
      strength = attenuation(light, distance) * spot(light, to_light);
    }
    const float falls = facing ? std::abs(glm::dot(n, to_light)) : 1.0f;
    diffuse += light.color * (strength * (options.ambient + options.diffuse * falls + light.ambient));
    const glm::vec3 half = to_light + to_viewer;
    const float half2 = glm::dot(half, half);
    if (!facing || !(half2 > 0)) continue;
    float shine = glm::dot(n, half);
    shine = shine * shine / half2;  // the square makes the highlight two-sided
    shine *= shine, shine *= shine, shine *= shine;
    static_assert(kGloss == 16);
    gloss += light.color * (strength * options.specular * shine);
  }
  const glm::vec3 lit = color * diffuse + gloss;
  const auto whole = [](float c) { return c > 0 ? std::min(c, 1.0f) : 0.0f; };
  return fogged(options.fog, {whole(lit.x), whole(lit.y), whole(lit.z)}, place);
}

}  // namespace gs::render
