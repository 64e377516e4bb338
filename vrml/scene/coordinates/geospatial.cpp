#include "vrml/scene/coordinates/geospatial.h"

#include "base/text.h"
#include "vrml/scene/values/transformation.h"

#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

namespace gs::vrml {
namespace {

/// Ellipsoid of ISO/IEC 19775-1 Table 25.3: radius of the equator in metres, and 1 / flattening.
struct Ellipsoid {
  std::string_view name;
  double radius, inverse_flattening;
};
constexpr Ellipsoid kEllipsoids[] = {
    {"WE", 6378137, 298.257223563},
    {"AA", 6377563.396, 299.3249646},
    {"AM", 6377340.189, 299.3249646},
    {"AN", 6378160, 298.25},
    {"BN", 6377483.865, 299.1528128},
    {"BR", 6377397.155, 299.1528128},
    {"CC", 6378206.4, 294.9786982},
    {"CD", 6378249.145, 293.465},
    {"EA", 6377276.345, 300.8017},
    {"EB", 6377298.556, 300.8017},
    {"EC", 6377301.243, 300.8017},
    {"ED", 6377295.664, 300.8017},
    {"EE", 6377304.063, 300.8017},
    {"EF", 6377309.613, 300.8017},
    {"FA", 6378155, 298.3},
    {"HE", 6378200, 298.3},
    {"HO", 6378270, 297},
    {"ID", 6378160, 298.247},
    {"IN", 6378388, 297},
    {"KA", 6378245, 298.3},
    {"RF", 6378137, 298.257222101},
    {"SA", 6378160, 298.25},
    {"WD", 6378135, 298.26},
};

// Constants of UTM: scale of the central meridian, its easting, and the northing of the equator for southern zones.
constexpr double kUtmScale = 0.9996, kUtmEasting = 500'000, kUtmSouth = 10'000'000;

double central_meridian(int zone) { return glm::radians(6.0 * zone - 183); }

/// Series of the transverse Mercator projection (Krueger), to the third order of the third flattening n.
struct Mercator {
  explicit Mercator(double flattening, double radius) : n(flattening / (2 - flattening)) {
    scale = radius / (1 + n) * (1 + n * n / 4 + n * n * n * n / 64) * kUtmScale;
    const double n2 = n * n, n3 = n2 * n;
    forward = {n / 2 - 2 * n2 / 3 + 5 * n3 / 16, 13 * n2 / 48 - 3 * n3 / 5, 61 * n3 / 240};
    inverse = {n / 2 - 2 * n2 / 3 + 37 * n3 / 96, n2 / 48 + n3 / 15, 17 * n3 / 480};
    latitude = {2 * n - 2 * n2 / 3 - 2 * n3, 7 * n2 / 3 - 8 * n3 / 5, 56 * n3 / 15};
  }
  double n, scale;
  std::array<double, 3> forward, inverse, latitude;
};

// Returns the value of a field that all nodes of a kind have; `otherwise` for other nodes.
template <class T>
T field_value(const Node& node, std::string_view name, T otherwise) {
  const InterfaceDeclaration* const field = node.type->find_field(name);
  const T* const value = field ? std::get_if<T>(&node.values[field->slot]) : nullptr;
  return value ? *value : otherwise;
}
glm::dvec3 geo_coordinates(const Node& node, std::string_view name) {
  const glm::dvec3 value = *field_value(node, name, SFVec3d());
  constexpr double kMaxCoordinate = 1e12;  // metres or degrees; beyond, the series of UTM are not finite
  const auto is_usable = [](double x) { return std::abs(x) <= kMaxCoordinate; };
  return is_usable(value.x) && is_usable(value.y) && is_usable(value.z) ? value : glm::dvec3(0);
}

}  // namespace

GeoFrame GeoFrame::make(const MFString& system) {
  GeoFrame frame;
  frame.radius_ = kEllipsoids[0].radius;
  frame.flattening_ = 1 / kEllipsoids[0].inverse_flattening;
  for (const String& word : system) {
    const std::string_view text = word.view();
    if (text == "GD" || text == "GDC") frame.system_ = System::geodetic;
    if (text == "GC" || text == "GCC" || text == "GS") frame.system_ = System::geocentric;
    if (text == "UTM") frame.system_ = System::utm;
    if (text == "S") frame.southern_ = true;
    if (text == "longitude_first" || text == "easting_first") frame.swapped_ = true;
    if (text.size() > 1 && text[0] == 'Z' && text[1] >= '0' && text[1] <= '9')
      frame.zone_ = std::clamp(
          text.size() > 2 && text[2] >= '0' && text[2] <= '9' ? 10 * (text[1] - '0') + text[2] - '0' : text[1] - '0', 1,
          60);
    for (const Ellipsoid& ellipsoid : kEllipsoids)
      if (ellipsoid.name == text) {
        frame.radius_ = ellipsoid.radius;
        frame.flattening_ = 1 / ellipsoid.inverse_flattening;
      }
  }
  return frame;
}

GeoFrame GeoFrame::of(const SceneGraph& scene, const Node& node) {
  GeoFrame frame = make(field_value(node, "geoSystem", MFString()));
  const NodeId id = scene.resolve(field_value(node, "geoOrigin", SFNode()));
  if (!id) return frame;
  const Node& origin = scene.node(id);
  const GeoFrame of_origin = make(field_value(origin, "geoSystem", MFString()));
  frame.origin_ = of_origin.geocentric(geo_coordinates(origin, "geoCoords"));
  if (field_value(origin, "rotateYUp", false)) frame.world_from_ecef_ = glm::transpose(frame.axes(glm::dvec3(0)));
  return frame;
}

glm::dvec3 GeoFrame::position(const glm::dvec3& coordinates) const {
  return world_from_ecef_ * (geocentric(coordinates) - origin_);
}

glm::dvec3 GeoFrame::coordinates(const glm::dvec3& position) const {
  return from_geocentric(glm::transpose(world_from_ecef_) * position + origin_);
}

double GeoFrame::elevation(const glm::dvec3& position) const {
  return geodetic_of(glm::transpose(world_from_ecef_) * position + origin_).z;
}

glm::dmat3 GeoFrame::axes(const glm::dvec3& position) const {
  const glm::dvec3 geodetic = geodetic_of(glm::transpose(world_from_ecef_) * position + origin_);
  const double latitude = geodetic.x, longitude = geodetic.y;
  const glm::dvec3 east(-std::sin(longitude), std::cos(longitude), 0);
  const glm::dvec3 up(std::cos(latitude) * std::cos(longitude), std::cos(latitude) * std::sin(longitude),
                      std::sin(latitude));
  return world_from_ecef_ * glm::dmat3(east, up, glm::cross(east, up));
}

glm::dmat4 GeoFrame::location(const glm::dvec3& coordinates) const {
  const glm::dvec3 place = position(coordinates);
  glm::dmat4 matrix(axes(place));
  matrix[3] = glm::dvec4(place, 1);
  return matrix;
}

glm::dvec3 GeoFrame::geocentric(const glm::dvec3& given) const {
  if (system_ == System::geocentric) return given;
  const glm::dvec3 c = swapped_ ? glm::dvec3(given.y, given.x, given.z) : given;
  return point_of(system_ == System::utm ? from_utm(c) : glm::dvec3(glm::radians(c.x), glm::radians(c.y), c.z));
}

glm::dvec3 GeoFrame::from_geocentric(const glm::dvec3& point) const {
  if (system_ == System::geocentric) return point;
  const glm::dvec3 geodetic = geodetic_of(point);
  const glm::dvec3 c = system_ == System::utm
                           ? to_utm(geodetic)
                           : glm::dvec3(glm::degrees(geodetic.x), glm::degrees(geodetic.y), geodetic.z);
  return swapped_ ? glm::dvec3(c.y, c.x, c.z) : c;
}

glm::dvec3 GeoFrame::point_of(const glm::dvec3& geodetic) const {
  const double e2 = flattening_ * (2 - flattening_), sine = std::sin(geodetic.x);
  const double normal = radius_ / std::sqrt(1 - e2 * sine * sine);
  const double across = (normal + geodetic.z) * std::cos(geodetic.x);
  return {across * std::cos(geodetic.y), across * std::sin(geodetic.y), (normal * (1 - e2) + geodetic.z) * sine};
}

// Iterates the latitude (Bowring); it converges to less than a micrometre in three steps near the surface.
glm::dvec3 GeoFrame::geodetic_of(const glm::dvec3& point) const {
  const double e2 = flattening_ * (2 - flattening_), across = std::hypot(point.x, point.y);
  const double pole = radius_ * (1 - flattening_);
  if (across < 1e-9 && std::abs(point.z) < 1e-9) return {0, 0, -radius_};
  double tangent = (point.z * radius_) / (std::max(across, 1e-12) * pole);
  double latitude = 0;
  for (int i = 0; i < 5; ++i) {
    const double cosine = 1 / std::sqrt(1 + tangent * tangent), sine = tangent * cosine;
    latitude = std::atan2(point.z + e2 / (1 - e2) * pole * sine * sine * sine,
                          across - e2 * radius_ * cosine * cosine * cosine);
    tangent = (1 - flattening_) * std::tan(latitude);
  }
  const double sine = std::sin(latitude), normal = radius_ / std::sqrt(1 - e2 * sine * sine);
  const double elevation = std::abs(latitude) < glm::quarter_pi<double>() ? across / std::cos(latitude) - normal
                                                                          : point.z / sine - normal * (1 - e2);
  return {latitude, std::atan2(point.y, point.x), elevation};
}

glm::dvec3 GeoFrame::from_utm(const glm::dvec3& c) const {
  const Mercator series(flattening_, radius_);
  // Beyond a quarter of the circumference the projection has no meaning, and its series would overflow.
  const auto bounded = [](double angle) { return std::clamp(angle, -glm::half_pi<double>(), glm::half_pi<double>()); };
  const double xi = bounded((c.x - (southern_ ? kUtmSouth : 0)) / series.scale);
  const double eta = bounded((c.y - kUtmEasting) / series.scale);
  double x = xi, y = eta;
  for (int j = 1; j <= 3; ++j) {
    x -= series.inverse[j - 1] * std::sin(2 * j * xi) * std::cosh(2 * j * eta);
    y -= series.inverse[j - 1] * std::cos(2 * j * xi) * std::sinh(2 * j * eta);
  }
  const double conformal = std::asin(std::clamp(std::sin(x) / std::cosh(y), -1.0, 1.0));
  double latitude = conformal;
  for (int j = 1; j <= 3; ++j) latitude += series.latitude[j - 1] * std::sin(2 * j * conformal);
  return {latitude, central_meridian(zone_) + std::atan2(std::sinh(y), std::cos(x)), c.z};
}

glm::dvec3 GeoFrame::to_utm(const glm::dvec3& geodetic) const {
  const Mercator series(flattening_, radius_);
  const double k = 2 * std::sqrt(series.n) / (1 + series.n), sine = std::sin(geodetic.x);
  const double t = std::sinh(std::atanh(sine) - k * std::atanh(k * sine));
  const double away = geodetic.y - central_meridian(zone_);
  const double x = std::atan2(t, std::cos(away)), y = std::atanh(std::sin(away) / std::sqrt(1 + t * t));
  double northing = x, easting = y;
  for (int j = 1; j <= 3; ++j) {
    northing += series.forward[j - 1] * std::sin(2 * j * x) * std::cosh(2 * j * y);
    easting += series.forward[j - 1] * std::cos(2 * j * x) * std::sinh(2 * j * y);
  }
  return {northing * series.scale + (southern_ ? kUtmSouth : 0), easting * series.scale + kUtmEasting, geodetic.z};
}

glm::dvec3 geo_position(const SceneGraph& scene, const Node& node, std::string_view field) {
  return GeoFrame::of(scene, node).position(geo_coordinates(node, field));
}

glm::dmat4 geo_location_matrix(const SceneGraph& scene, const Node& node) {
  return GeoFrame::of(scene, node).location(geo_coordinates(node, "geoCoords"));
}

// Applies a Transform in the axes of geoCenter.
glm::dmat4 geo_transform_matrix(const SceneGraph& scene, const Node& node) {
  const glm::dmat4 place = GeoFrame::of(scene, node).location(geo_coordinates(node, "geoCenter"));
  const glm::dmat4 moved = transform_matrix(
      field_value(node, "translation", SFVec3f(0)), SFVec3f(0), field_value(node, "rotation", SFRotation()),
      field_value(node, "scale", SFVec3f(1)), field_value(node, "scaleOrientation", SFRotation()));
  return place * moved * glm::inverse(place);
}

glm::dmat4 geo_viewpoint_axes(const SceneGraph& scene, const Node& node) {
  return GeoFrame::of(scene, node).location(geo_coordinates(node, "position"));
}

glm::dmat4 geo_viewpoint_matrix(const SceneGraph& scene, const Node& node) {
  return geo_viewpoint_axes(scene, node) * glm::dmat4(rotation_matrix(field_value(node, "orientation", SFRotation())));
}

std::optional<glm::dvec3> geo_viewpoint_center(const SceneGraph& scene, const Node& node) {
  if (geo_coordinates(node, "centerOfRotation") == glm::dvec3(0)) return std::nullopt;
  return geo_position(scene, node, "centerOfRotation");
}

glm::dvec3 GeoGround::up(const glm::dvec3& position) const {
  const glm::dvec3 local(local_from_world * glm::dvec4(position, 1));
  return glm::normalize(glm::inverse(glm::dmat3(local_from_world)) * frame.axes(local)[1]);
}

double GeoGround::speed(const glm::dvec3& position) const {
  constexpr double kPart = 0.1, kMaxFactor = 1e9;
  const double elevation = frame.elevation(glm::dvec3(local_from_world * glm::dvec4(position, 1)));
  const double factor = std::max(1.0, kPart * elevation) * speed_factor;
  return std::isfinite(factor) ? std::clamp(factor, 0.0, kMaxFactor) : 1;
}

GeoGround geo_ground(const SceneGraph& scene, const Node& viewpoint, const glm::dmat4& world_from_local) {
  return {GeoFrame::of(scene, viewpoint), double{field_value(viewpoint, "speedFactor", SFFloat(1))},
          glm::inverse(world_from_local)};
}

}  // namespace gs::vrml
