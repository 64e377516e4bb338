#pragma once

#include "render/collection/nodes/collect_schema.h"
#include "render/scene/sight.h"
#include "vrml/scene/layers.h"

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <array>
#include <optional>

namespace gs::render {

/// Fields of a Layout in one direction (X3D 36.4.1).
struct LayoutAxis {
  enum class Unit : std::uint8_t { world, fraction, pixel };
  enum class Scale : std::uint8_t { none, fraction, stretch, pixel };
  int align = 0;  // -1: left or bottom edge; 0: centre; 1: right or top edge
  double size = 1, offset = 0;
  Unit size_unit = Unit::world, offset_unit = Unit::world;
  Scale scale = Scale::none;
};
/// Fields of a Layout: horizontal, vertical.
using LayoutValues = std::array<LayoutAxis, 2>;
/// Reads a Layout. Sizes that are not positive and values that are not finite become the defaults.
[[nodiscard]] LayoutValues layout_values(const NodeView& layout);

/// Rectangle of a Layout in pixels. Y points up.
struct LayoutRectangle {
  glm::dvec2 center{0};  // relative to the centre of the parent's rectangle
  glm::dvec2 size{0};
  glm::dvec2 scale{1};  // pixels per unit of the content
};
/// Rectangle in which a Layout is placed.
struct LayoutParent {
  glm::dvec2 size{0};              // pixels
  glm::dvec2 center{0};            // pixels from the lower left corner of the picture
  std::optional<glm::dvec2> unit;  // pixels per unit of the coordinate system around the Layout; unset if outermost
};
/// Places a Layout (36.4.1). For the outermost one, the unit WORLD and the scale NONE mean FRACTION. A rectangle with a
/// size in pixels begins at a whole pixel.
[[nodiscard]] LayoutRectangle place_layout(const LayoutValues& layout, const LayoutParent& parent);

/// Picture of a layer in world space, for content in units of the picture.
class Screen {
 public:
  /// `viewer` and `sight` are those of the layer's camera; the size of `sight` is that of the whole picture, of which
  /// the layer fills `boundary`.
  Screen(const glm::dvec3& viewer, const Sight& sight, const vrml::ClipBoundary& boundary);

  /// Place of a Layout.
  struct Placement {
    glm::dmat4 parent_from_local{1.0};
    glm::dvec2 size{0};  // pixels of its rectangle
  };
  /// How a Layout is placed: in the rectangle of another Layout, in a LayoutLayer, or before the viewer of a scene.
  enum class Anchor : std::uint8_t { layout, layer, viewer };
  /// Places a Layout in a rectangle of `outer` pixels. `parent` is the coordinate system around the Layout.
  [[nodiscard]] Placement place(const LayoutValues& layout, Anchor anchor, const glm::dvec2& outer,
                                const glm::dmat4& parent) const;
  /// Returns parent_from_local of a coordinate system with the origin of its parent in which a unit is as long as
  /// `pixels` pixels there (36.4.6).
  [[nodiscard]] glm::dmat4 in_pixels(const glm::dmat4& parent, double pixels) const;
  /// Returns the planes in world space that clip content to a part of the whole picture.
  [[nodiscard]] std::array<glm::dvec4, 4> planes(const vrml::ClipBoundary& part) const;

  /// Returns the size of the layer in pixels.
  [[nodiscard]] const glm::dvec2& size() const { return sight_.pixels; }
  [[nodiscard]] double pixels_per_point() const { return sight_.pixels_per_point; }

 private:
  [[nodiscard]] double pixel_at(const glm::dvec3& in_camera) const;

  Sight sight_;         // of the layer
  glm::dvec2 corner_;   // lower left corner of the layer in the whole picture, pixels
  glm::dvec2 picture_;  // size of the whole picture, pixels
  glm::dmat4 world_from_camera_, camera_from_world_;
};

}  // namespace gs::render
