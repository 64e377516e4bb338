#include "render/collection/nodes/screen.h"

#include "render/collection/nodes/collect_nodes.h"

#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string_view>

namespace gs::render {
namespace {

using glm::dmat3;
using glm::dmat4;
using glm::dvec2;
using glm::dvec3;
using Unit = LayoutAxis::Unit;
using Scale = LayoutAxis::Scale;

constexpr double kMostPixels = 1e7;     // limit of sizes and offsets; more than any picture has
constexpr double kLayerDistance = 10;   // of the plane z = 0 of a LayoutLayer before its viewer
constexpr double kViewerDistance = 1;   // of a LayoutGroup of a scene before the viewer
constexpr double kNearestDepth = 1e-3;  // of content in pixels, relative to its distance: it may be beside the viewer

/// Returns the value of a list for a direction. A single value holds for both.
template <class List>
auto value_at(const List* list, std::size_t axis) {
  return list && !list->empty() ? list->begin() + std::min(axis, list->size() - 1) : nullptr;
}

std::string_view name_at(const NodeView& view, int field, std::size_t axis) {
  const auto* name = value_at(view.find<vrml::MFString>(field), axis);
  return name ? name->view() : std::string_view();
}

Unit unit_named(std::string_view name) {
  return name == "FRACTION" ? Unit::fraction : name == "PIXEL" ? Unit::pixel : Unit::world;
}

Scale scale_named(std::string_view name) {
  return name == "FRACTION"  ? Scale::fraction
         : name == "STRETCH" ? Scale::stretch
         : name == "PIXEL"   ? Scale::pixel
                             : Scale::none;
}

/// Converts a length to pixels. `whole` is the parent's size in this direction; `unit` is null for the outermost
/// Layout.
double in_pixels_of(double length, Unit given, double whole, const double* unit) {
  const double factor = given == Unit::pixel ? 1 : given == Unit::world && unit ? *unit : whole;
  const double pixels = length * factor;
  return std::isfinite(pixels) ? std::clamp(pixels, -kMostPixels, kMostPixels) : 0;
}

/// Returns the rotation and the translation of a matrix.
dmat4 rigid_part(const dmat4& matrix) {
  dmat4 result(rotation_part(matrix));
  result[3] = matrix[3];
  return result;
}

}  // namespace

LayoutValues layout_values(const NodeView& layout) {
  using F = LayoutFields;
  LayoutValues values;
  for (std::size_t axis = 0; axis < values.size(); ++axis) {
    LayoutAxis& to = values[axis];
    // A single value of `align` is horizontal: its names have a direction.
    const auto* aligns = layout.find<vrml::MFString>(F::align);
    const std::string_view align =
        aligns && aligns->size() > axis ? (aligns->begin() + axis)->view() : std::string_view();
    if (align == (axis == 0 ? "LEFT" : "BOTTOM")) to.align = -1;
    if (align == (axis == 0 ? "RIGHT" : "TOP")) to.align = 1;
    to.size_unit = unit_named(name_at(layout, F::size_units, axis));
    to.offset_unit = unit_named(name_at(layout, F::offset_units, axis));
    to.scale = scale_named(name_at(layout, F::scale_mode, axis));
    const auto* size = value_at(layout.find<vrml::MFFloat>(F::size), axis);
    if (size && *size > 0 && std::isfinite(*size)) to.size = *size;
    const auto* offset = value_at(layout.find<vrml::MFFloat>(F::offset), axis);
    if (offset && std::isfinite(*offset)) to.offset = *offset;
  }
  return values;
}

LayoutRectangle place_layout(const LayoutValues& layout, const LayoutParent& parent) {
  LayoutRectangle result;
  for (int axis = 0; axis < 2; ++axis) {
    const LayoutAxis& given = layout[static_cast<std::size_t>(axis)];
    const double whole = parent.size[axis];
    const double* const unit = parent.unit ? &(*parent.unit)[axis] : nullptr;
    const double size = result.size[axis] = in_pixels_of(given.size, given.size_unit, whole, unit);
    double& center = result.center[axis];
    center = given.align * (whole - size) / 2 + in_pixels_of(given.offset, given.offset_unit, whole, unit);
    if (given.size_unit == Unit::pixel) {
      const double edge = parent.center[axis] + center - size / 2;
      center += std::floor(edge + 0.5) - edge;
    }
    const Scale scale = given.scale == Scale::none && !unit ? Scale::fraction : given.scale;
    result.scale[axis] = scale == Scale::fraction ? size : scale == Scale::none ? *unit : 1;
  }
  const bool x = layout[0].scale == Scale::stretch, y = layout[1].scale == Scale::stretch;
  if (x && y) result.scale = dvec2(std::max(result.size.x, result.size.y));
  if (x && !y) result.scale.x = result.scale.y;
  if (y && !x) result.scale.y = result.scale.x;
  return result;
}

Screen::Screen(const dvec3& viewer, const Sight& sight, const vrml::ClipBoundary& boundary)
    : sight_(sight), picture_(sight.pixels), world_from_camera_(sight.orientation) {
  const dvec2 last(std::round(boundary[1] * picture_.x), std::round(boundary[3] * picture_.y));
  corner_ = {std::round(boundary[0] * picture_.x), std::round(boundary[2] * picture_.y)};
  sight_.pixels = glm::max(last - corner_, dvec2(1));
  world_from_camera_[3] = glm::dvec4(viewer, 1);
  const dmat3 back = glm::transpose(sight.orientation);
  camera_from_world_ = dmat4(back);
  camera_from_world_[3] = glm::dvec4(-(back * viewer), 1);
}

double Screen::pixel_at(const dvec3& in_camera) const {
  const double nearest = kNearestDepth * glm::length(in_camera);
  return pixel_length(sight_, std::max(std::abs(in_camera.z), nearest));
}

Screen::Placement Screen::place(const LayoutValues& layout, Anchor anchor, const dvec2& outer,
                                const dmat4& parent) const {
  dmat4 base = anchor == Anchor::viewer ? dmat4(1) : rigid_part(parent);
  if (anchor != Anchor::layout)
    base =
        glm::translate(world_from_camera_, dvec3(0, 0, anchor == Anchor::layer ? -kLayerDistance : -kViewerDistance)) *
        base;
  const dvec3 origin(camera_from_world_ * base[3]);
  const double pixel = pixel_at(origin);
  LayoutParent around{outer, size() / 2.0 + dvec2(origin) / pixel, {}};
  if (anchor == Anchor::layout)
    around.unit = dvec2(glm::length(dvec3(parent[0])), glm::length(dvec3(parent[1]))) / pixel;
  const LayoutRectangle rectangle = place_layout(layout, around);
  const dvec2 scale = rectangle.scale * pixel;
  const dmat4 world =
      glm::scale(glm::translate(base, dvec3(rectangle.center * pixel, 0)), dvec3(scale, std::min(scale.x, scale.y)));
  return {glm::inverse(parent) * world, rectangle.size};
}

dmat4 Screen::in_pixels(const dmat4& parent, double pixels) const {
  const double length = pixel_at(dvec3(camera_from_world_ * parent[3])) * pixels;
  dvec3 scale;
  for (int axis = 0; axis < 3; ++axis) scale[axis] = length / glm::length(dvec3(parent[axis]));
  const bool usable = length > 0 && std::isfinite(scale.x + scale.y + scale.z);
  return usable ? glm::scale(dmat4(1), scale) : dmat4(1);
}

std::array<glm::dvec4, 4> Screen::planes(const vrml::ClipBoundary& part) const {
  std::array<glm::dvec4, 4> result;
  for (std::size_t edge = 0; edge < result.size(); ++edge) {
    const int axis = edge < 2 ? 0 : 1;
    const double sign = edge % 2 == 0 ? 1 : -1;  // lower edges keep what is above them
    const double at = std::round(part[edge] * picture_[axis]) - corner_[axis] - sight_.pixels[axis] / 2;
    glm::dvec4 plane(0);
    plane[axis] = sign;
    if (sight_.height > 0) {
      plane.w = -sign * at * pixel_length(sight_, 1);
    } else {
      plane.z = sign * at * pixel_length(sight_, 1);
      plane /= glm::length(dvec3(plane));
    }
    result[edge] = glm::transpose(camera_from_world_) * plane;
  }
  return result;
}

}  // namespace gs::render
