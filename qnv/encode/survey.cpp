#include "qnv/encode/survey.h"

#include "qnv/base/finite.h"

#include <glm/geometric.hpp>

#include <cmath>

namespace gs::qnv {

void SurfaceSurvey::add(std::span<const Triangle> more) {
  for (const Triangle& t : more) {
    if (!finite(t.positions[0]) || !finite(t.positions[1]) || !finite(t.positions[2])) continue;
    for (const glm::vec3& p : t.positions) box.add(p);
    const glm::dvec3 a(t.positions[0]), b(t.positions[1]), c(t.positions[2]);
    const glm::dvec3 faced = 0.5 * glm::cross(b - a, c - a);
    area += glm::length(faced);
    facing += faced;
    volume += glm::dot(a, faced) / 3;
    if (triangles++ == 0) color = t.colors[0];
    for (const Rgb8& corner : t.colors) colored = colored || corner != color;
  }
}

bool SurfaceSurvey::closed() const { return glm::length(facing) < 1e-4 * area && volume > 0; }

bool SurfaceSurvey::sound() const { return area > 0 && std::isfinite(area) && finite(box.size()); }

}  // namespace gs::qnv
