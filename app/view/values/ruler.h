#pragma once

#include <glm/vec3.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace gs::app {

/// Measurement of lengths, angles and areas between clicked points. Lengths are in world units.
class Ruler {
 public:
  static constexpr std::size_t kMaxPoints = 1000;

  /// Adds a point. Returns false if it is not finite, or if there are already kMaxPoints points.
  bool add(const glm::dvec3& place);
  /// Removes the last point. Returns false if there is none.
  bool undo();
  void clear() { points_.clear(); }
  [[nodiscard]] const std::vector<glm::dvec3>& points() const { return points_; }

  /// Returns the distance from the point at index `leg` to the next point.
  [[nodiscard]] double length_of(std::size_t leg) const;
  /// Returns the sum of the lengths of all legs.
  [[nodiscard]] double length() const;
  /// Returns the straight-line distance from the first point to the last.
  [[nodiscard]] double distance() const;
  /// Returns the angle in degrees between the two legs at the point at index `point`. Returns nullopt at the first and
  /// last point, and if neighbouring points coincide.
  [[nodiscard]] std::optional<double> angle_at(std::size_t point) const;
  /// Returns the area of the polygon of all points; nullopt for fewer than three points. If the polygon is not planar,
  /// returns the area of its largest projection.
  [[nodiscard]] std::optional<double> area() const;

  /// Returns a text with each point, length and angle, and then the total length, distance and area. `unit` is the unit
  /// of length and may be empty.
  [[nodiscard]] std::string text(const std::string& unit = {}) const;
  /// Returns the result in one line, such as "12.4 mm", or for three points "length 30.1, angle 87.2 deg, area 81.3".
  [[nodiscard]] std::string summary(const std::string& unit = {}) const;

 private:
  std::vector<glm::dvec3> points_;
};

}  // namespace gs::app
