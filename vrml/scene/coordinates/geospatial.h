#pragma once

#include "vrml/scene/scene_graph.h"

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <optional>
#include <string_view>

namespace gs::vrml {

/// Spatial reference frame of a geospatial node (ISO/IEC 19775-1 25.2): its coordinate system, its ellipsoid and its
/// GeoOrigin. Positions in the world are geocentric, in metres, relative to the origin.
class GeoFrame {
 public:
  /// Reads the fields geoSystem and geoOrigin of a node. Unknown words count as the defaults.
  [[nodiscard]] static GeoFrame of(const SceneGraph& scene, const Node& node);
  /// Makes the frame of a geoSystem without an origin.
  [[nodiscard]] static GeoFrame make(const MFString& system);

  /// Returns the position of coordinates in this frame, for example latitude, longitude and elevation.
  [[nodiscard]] glm::dvec3 position(const glm::dvec3& coordinates) const;
  /// Returns the coordinates of a position.
  [[nodiscard]] glm::dvec3 coordinates(const glm::dvec3& position) const;
  /// Returns the height of a position above the ellipsoid in metres.
  [[nodiscard]] double elevation(const glm::dvec3& position) const;
  /// Returns the axes at a position: x to the east, y up, z to the south.
  [[nodiscard]] glm::dmat3 axes(const glm::dvec3& position) const;
  /// Returns the transform from the axes at some coordinates to the world.
  [[nodiscard]] glm::dmat4 location(const glm::dvec3& coordinates) const;
  /// Reports whether the longitude or easting is the first coordinate.
  [[nodiscard]] bool is_swapped() const { return swapped_; }

 private:
  enum class System : std::uint8_t { geodetic, utm, geocentric };

  [[nodiscard]] glm::dvec3 geocentric(const glm::dvec3& coordinates) const;
  [[nodiscard]] glm::dvec3 from_geocentric(const glm::dvec3& point) const;
  /// Returns the position on the ellipsoid: latitude and longitude in radians, elevation in metres.
  [[nodiscard]] glm::dvec3 geodetic_of(const glm::dvec3& point) const;
  [[nodiscard]] glm::dvec3 point_of(const glm::dvec3& geodetic) const;
  [[nodiscard]] glm::dvec3 from_utm(const glm::dvec3& coordinates) const;
  [[nodiscard]] glm::dvec3 to_utm(const glm::dvec3& geodetic) const;

  System system_ = System::geodetic;
  bool swapped_ = false;  // longitude or easting is the first coordinate
  int zone_ = 1;          // of UTM
  bool southern_ = false;
  double radius_, flattening_;       // of the ellipsoid; the radius is that of the equator
  glm::dvec3 origin_{0};             // geocentric
  glm::dmat3 world_from_ecef_{1.0};  // rotation of a GeoOrigin with rotateYUp
};

/// Returns the position of the coordinates in an SFVec3d field of a geospatial node.
[[nodiscard]] glm::dvec3 geo_position(const SceneGraph& scene, const Node& node, std::string_view field);
/// Returns parent_from_local of a GeoLocation.
[[nodiscard]] glm::dmat4 geo_location_matrix(const SceneGraph& scene, const Node& node);
/// Returns parent_from_local of a GeoTransform.
[[nodiscard]] glm::dmat4 geo_transform_matrix(const SceneGraph& scene, const Node& node);
/// Returns the axes at the position of a GeoViewpoint as a transform.
[[nodiscard]] glm::dmat4 geo_viewpoint_axes(const SceneGraph& scene, const Node& node);
/// Returns the pose of a GeoViewpoint: parent_from_camera.
[[nodiscard]] glm::dmat4 geo_viewpoint_matrix(const SceneGraph& scene, const Node& node);
/// Returns the position of centerOfRotation of a GeoViewpoint; nullopt for its default, which lies far from all scenes.
[[nodiscard]] std::optional<glm::dvec3> geo_viewpoint_center(const SceneGraph& scene, const Node& node);

/// Ellipsoid below the viewer of a GeoViewpoint (X3D 25.3.11). It determines the up direction and the speed.
struct GeoGround {
  GeoFrame frame;
  double speed_factor = 1;
  glm::dmat4 local_from_world{1.0};  // coordinate system of the GeoViewpoint

  /// Returns the up direction at a position, as a unit vector. Both are in world space.
  [[nodiscard]] glm::dvec3 up(const glm::dvec3& position) const;
  /// Returns the factor on the speed of NavigationInfo at a position in world space: speedFactor, times a tenth of the
  /// elevation above 10 m.
  [[nodiscard]] double speed(const glm::dvec3& position) const;
};
/// Returns the ellipsoid of a GeoViewpoint at a place in the hierarchy.
[[nodiscard]] GeoGround geo_ground(const SceneGraph& scene, const Node& viewpoint, const glm::dmat4& world_from_local);

}  // namespace gs::vrml
