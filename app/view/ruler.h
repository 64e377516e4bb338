#pragma once

#include <glm/vec3.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace gs::app {

/// Places that were clicked, and what lies between them: lengths in the world's units.
class Ruler {
 public:
  static constexpr std::size_t kMostPoints = 1000;

  /// False, and nothing is added, for what is no place, or when there are kMostPoints.
  bool add(const glm::dvec3& place);
  /// Takes the last one back. False when there was none.
  bool undo();
  void clear() { points_.clear(); }
  [[nodiscard]] const std::vector<glm::dvec3>& points() const { return points_; }

  /// From one point to the next.
  [[nodiscard]] double length_of(std::size_t leg) const;
  /// Of the whole line.
  [[nodiscard]] double length() const;
  /// From the first point to the last, straight.
  [[nodiscard]] double distance() const;
  /// At the point between two legs, degrees; nothing at the ends, and where two points are the same.
  [[nodiscard]] std::optional<double> angle_at(std::size_t point) const;
  /// Of the polygon of all points, three or more: of a flat one its area, else that of its largest shadow.
  [[nodiscard]] std::optional<double> area() const;

  /// Lines of text: every point, leg and angle, then length, distance and area. `unit`: of lengths; may be empty.
  [[nodiscard]] std::string text(const std::string& unit = {}) const;
  /// What matters most, in one line: "12.4 mm", with three points "length 30.1, angle 87.2 deg, area 81.3".
  [[nodiscard]] std::string summary(const std::string& unit = {}) const;

 private:
  std::vector<glm::dvec3> points_;
};

}  // namespace gs::app
