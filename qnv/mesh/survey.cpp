#include "qnv/mesh/survey.h"

#include "base/finite.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace gs::qnv {

void SurfaceSurvey::add(std::span<const Triangle> more) {
  for (const Triangle& t : more) {
    if (!finite(t.positions[0]) || !finite(t.positions[1]) || !finite(t.positions[2])) continue;
    for (const glm::vec3& p : t.positions) box.add(p);
    const glm::dvec3 a(t.positions[0]), b(t.positions[1]), c(t.positions[2]);
    const glm::dvec3 faced = 0.5 * glm::cross(b - a, c - a);
    const double size = glm::length(faced);
    area += size;
    facing += faced;
    volume += glm::dot(a, faced) / 3;
    if (triangles++ == 0) color = t.colors[0];
    for (const Rgb8& corner : t.colors) {
      colored = colored || corner != color;
      colors += glm::dvec3(corner.r, corner.g, corner.b) * (size / 3);
    }
  }
}

void SurfaceSurvey::add(const SurfaceSurvey& later) {
  if (later.triangles == 0) return;
  box.add(later.box.lower);
  box.add(later.box.upper);
  area += later.area;
  volume += later.volume;
  facing += later.facing;
  colors += later.colors;
  if (triangles == 0) color = later.color;
  colored = colored || later.colored || color != later.color;
  triangles += later.triangles;
}

Rgb8 SurfaceSurvey::mean_color() const {
  if (!colored || !(area > 0) || !std::isfinite(area)) return color;
  const auto part = [&](double sum) { return static_cast<std::uint8_t>(std::clamp(sum / area + 0.5, 0.0, 255.0)); };
  return {part(colors.x), part(colors.y), part(colors.z)};
}

bool SurfaceSurvey::closed() const { return glm::length(facing) < 1e-4 * area && volume > 0; }

bool SurfaceSurvey::sound() const { return area > 0 && std::isfinite(area) && finite(box.size()); }

Description describe_vectors(const VectorView& vectors,
                             const std::vector<std::pair<std::string, std::string>>& metadata) {
  Description d = vectors.description;
  d.total = 0;
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    const float weight = vectors.weights[i];
    if (!finite(vectors.positions[i]) || !(weight > 0) || !std::isfinite(weight)) continue;
    d.total += weight;
    d.box.add(vectors.positions[i]);
  }
  if (!std::isfinite(d.spacing)) d.spacing = 0;
  if (!std::isfinite(d.value_range.first) || !std::isfinite(d.value_range.second)) d.value_range = {0, 1};
  d.metadata = metadata;
  for (const auto& pair : vectors.description.metadata) {
    const auto same = [&](const auto& other) { return other.first == pair.first; };
    if (std::none_of(d.metadata.begin(), d.metadata.end(), same)) d.metadata.push_back(pair);
  }
  return d;
}

}  // namespace gs::qnv
