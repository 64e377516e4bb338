#pragma once

#include "vrml/scene/scene_graph.h"
#include "vrml/tessellation/nurbs.h"

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

// NURBS curves and surfaces of the nodes of VRML97 Amendment 1 and of the X3D component NURBS. A field of control
// points, weights or knots may have any of the types that these standards use.
namespace gs::vrml {

/// Returns the numbers of a field of the type MFFloat or MFDouble. Returns no numbers for other fields.
[[nodiscard]] std::vector<double> numbers_of(const SceneGraph& scene, NodeId node, std::string_view field);
/// Returns the points of a field: an MFVec2f, MFVec2d or MFVec3f, or an SFNode with a Coordinate, CoordinateDouble or
/// TextureCoordinate. Points in a plane have z = 0.
[[nodiscard]] std::vector<glm::dvec3> points_of(const SceneGraph& scene, NodeId node, std::string_view field);

/// NURBS curve: control points (w x, w y, w z, w) along one axis.
class NurbsCurve {
 public:
  /// Returns the curve of a node with the fields controlPoint, weight, knot, order and, in X3D, closed. Returns nullopt
  /// if the node does not define a valid curve.
  [[nodiscard]] static std::optional<NurbsCurve> make(const SceneGraph& scene, NodeId node);

  /// Evaluates the curve at `place`, 0 to 1.
  [[nodiscard]] glm::dvec3 at(double place) const;
  [[nodiscard]] const NurbsAxis& axis() const { return axis_; }

 private:
  NurbsCurve(NurbsAxis axis, std::vector<glm::dvec4> points) : axis_(std::move(axis)), points_(std::move(points)) {}
  NurbsAxis axis_;
  std::vector<glm::dvec4> points_;
};

/// Returns the points of a curve in the plane: a NurbsCurve2D, tessellated, or a ContourPolyline2D. Returns no points
/// for other nodes. The budget limits their number.
[[nodiscard]] std::vector<glm::dvec3> polyline_of(const SceneGraph& scene, NodeId node);

/// NURBS surface: columns x rows control points (w x, w y, w z, w), row by row.
class NurbsSurface {
 public:
  /// Point of a surface, and its derivatives by the two parameters. The whole surface has the size 1 x 1.
  struct Place {
    glm::dvec3 point{}, along_u{}, along_v{};
  };

  /// Returns the surface of a node with the fields controlPoint, weight, uDimension, uKnot, uOrder, ... and, in X3D,
  /// uClosed and vClosed. Returns nullopt if the node does not define a valid surface.
  [[nodiscard]] static std::optional<NurbsSurface> make(const SceneGraph& scene, NodeId node);

  /// Returns the surface that has other points with the axes and weights of this one. These points are not homogeneous.
  /// Returns nullopt if there are too few points.
  [[nodiscard]] std::optional<NurbsSurface> with_points(const std::vector<glm::dvec3>& points) const;
  /// Evaluates the surface at one place, 0 to 1 in both directions.
  [[nodiscard]] Place at(double u, double v) const;
  /// Calls take(column, row, Place) for all corners of a subdivision into columns x rows, row by row.
  template <class Take>
  void sample(std::size_t columns, std::size_t rows, const Take& take) const {
    std::vector<NurbsAxis::Weights> across;
    across.reserve(columns + 1);
    for (std::size_t i = 0; i <= columns; ++i)
      across.push_back(u_.at(static_cast<double>(i) / static_cast<double>(columns)));
    Row row;
    for (std::size_t j = 0; j <= rows; ++j) {
      read_row(v_.at(static_cast<double>(j) / static_cast<double>(rows)), row);
      for (std::size_t i = 0; i <= columns; ++i) take(i, j, place_in(row, across[i]));
    }
  }
  [[nodiscard]] const NurbsAxis& u() const { return u_; }
  [[nodiscard]] const NurbsAxis& v() const { return v_; }

 private:
  /// Control points of the curve along u at one value of v, and their derivatives by v.
  struct Row {
    std::vector<glm::dvec4> curve, motion;
  };
  NurbsSurface(NurbsAxis u, NurbsAxis v, std::vector<glm::dvec4> points)
      : u_(std::move(u)), v_(std::move(v)), points_(std::move(points)) {}
  void read_row(const NurbsAxis::Weights& along, Row& row) const;
  [[nodiscard]] Place place_in(const Row& row, const NurbsAxis::Weights& across) const;

  NurbsAxis u_, v_;
  std::vector<glm::dvec4> points_;
};

}  // namespace gs::vrml
