#pragma once

#include <glm/vec3.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace gs::app {

/// Measurement of clicked points; lengths are in world units.
class Ruler {
 public:
  static constexpr std::size_t kMaxPoints = 1000;

  /// Adds a point. Returns false if it is not finite or there are kMaxPoints already.
  bool add(const glm::dvec3& place);
  /// Removes the last point. Returns false if there is none.
  bool undo();
  void clear() { points_.clear(); }
  [[nodiscard]] const std::vector<glm::dvec3>& points() const { return points_; }

  /// Returns the length from point `leg` to the next one.
  [[nodiscard]] double length_of(std::size_t leg) const;
  /// Returns the length of the whole line.
  [[nodiscard]] double length() const;
  /// Returns the straight distance from the first point to the last.
  [[nodiscard]] double distance() const;
  /// Returns the angle at a point between two legs, in degrees. Returns nullopt at the ends and for coinciding points.
  [[nodiscard]] std::optional<double> angle_at(std::size_t point) const;
  /// Returns the area of the polygon of all points; at least three are needed. For a non-planar polygon, returns the
  /// area of its largest projection.
  [[nodiscard]] std::optional<double> area() const;

  /// Lists every point, leg and angle, then length, distance and area. `unit` is the length unit and may be empty.
  [[nodiscard]] std::string text(const std::string& unit = {}) const;
  /// Summarises the result in one line: "12.4 mm", or for three points "length 30.1, angle 87.2 deg, area 81.3".
  [[nodiscard]] std::string summary(const std::string& unit = {}) const;

 private:
  std::vector<glm::dvec3> points_;
};

}  // namespace gs::app
