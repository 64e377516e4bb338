#include "app/view/values/ruler.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace gs::app {
namespace {

std::string measure(double value, const std::string& unit = {}) {
  char buffer[48];
  std::snprintf(buffer, sizeof buffer, "%.6g", value);
  return unit.empty() ? buffer : std::string(buffer) + ' ' + unit;
}

}  // namespace

bool Ruler::add(const glm::dvec3& place) {
  if (points_.size() >= kMaxPoints || !std::isfinite(place.x + place.y + place.z)) return false;
  points_.push_back(place);
  return true;
}

bool Ruler::undo() {
  if (points_.empty()) return false;
  points_.pop_back();
  return true;
}

double Ruler::length_of(std::size_t leg) const {
  return leg + 1 < points_.size() ? glm::length(points_[leg + 1] - points_[leg]) : 0;
}

double Ruler::length() const {
  double sum = 0;
  for (std::size_t i = 0; i + 1 < points_.size(); ++i) sum += length_of(i);
  return sum;
}

double Ruler::distance() const { return points_.size() < 2 ? 0 : glm::length(points_.back() - points_.front()); }

std::optional<double> Ruler::angle_at(std::size_t point) const {
  if (point == 0 || point + 1 >= points_.size()) return std::nullopt;
  const glm::dvec3 a = points_[point - 1] - points_[point], b = points_[point + 1] - points_[point];
  const glm::dvec3 across = glm::cross(a, b);
  if (!(glm::dot(a, a) > 0 && glm::dot(b, b) > 0)) return std::nullopt;
  return std::atan2(glm::length(across), glm::dot(a, b)) * 180 / std::numbers::pi;  // also accurate for small angles
}

std::optional<double> Ruler::area() const {
  if (points_.size() < 3) return std::nullopt;
  glm::dvec3 sum(0);
  for (std::size_t i = 1; i + 1 < points_.size(); ++i)
    sum += glm::cross(points_[i] - points_.front(), points_[i + 1] - points_.front());
  return glm::length(sum) / 2;
}

std::string Ruler::text(const std::string& unit) const {
  std::string text;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const glm::dvec3& p = points_[i];
    text += "point " + std::to_string(i + 1) + ": " + measure(p.x) + ", " + measure(p.y) + ", " + measure(p.z) + '\n';
  }
  for (std::size_t i = 0; i + 1 < points_.size(); ++i)
    text +=
        "from " + std::to_string(i + 1) + " to " + std::to_string(i + 2) + ": " + measure(length_of(i), unit) + '\n';
  for (std::size_t i = 1; i + 1 < points_.size(); ++i)
    if (const auto angle = angle_at(i))
      text += "angle at " + std::to_string(i + 1) + ": " + measure(*angle, "degrees") + '\n';
  if (points_.size() > 2) {
    text += "length: " + measure(length(), unit) + '\n';
    text += "distance: " + measure(distance(), unit) + '\n';
    text += "area: " + measure(*area(), unit.empty() ? unit : unit + "^2") + '\n';
  }
  return text;
}

std::string Ruler::summary(const std::string& unit) const {
  if (points_.empty()) return "Click the first point";
  if (points_.size() == 1) return "Click the next point";
  if (points_.size() == 2) return measure(length(), unit);
  std::string text = "length " + measure(length(), unit);
  if (const auto angle = angle_at(points_.size() - 2)) text += ", angle " + measure(*angle) + " degrees";
  return text + ", area " + measure(*area(), unit.empty() ? unit : unit + "^2");
}

}  // namespace gs::app
