#pragma once

#include "vrml/scene/values/field_value.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>

namespace gs::vrml::inventor {

/// Part of the traversal state that nodes set together.
enum class Part : std::uint8_t {
  coordinates,
  normals,
  texture_coordinates,
  texture_function,
  material,
  material_binding,
  normal_binding,
  texture,
  texture_transform,
  hints,
  draw_style,
  light_model,
  font,
  complexity,
  count,
};
inline constexpr std::size_t kParts = static_cast<std::size_t>(Part::count);

/// Assignment of materials or normals to the parts of a shape.
enum class Binding : std::uint8_t {
  overall,
  per_part,
  per_part_indexed,
  per_face,
  per_face_indexed,
  per_vertex,
  per_vertex_indexed,
};

struct MaterialState {
  MFColor ambient{{0.2F, 0.2F, 0.2F}}, diffuse{{0.8F, 0.8F, 0.8F}}, specular{{0, 0, 0}}, emissive{{0, 0, 0}};
  MFFloat shininess{0.2F}, transparency{0};
};

struct TextureState {
  String file;  // empty if the texture has no file
  SFImage image;
  bool repeat_s = true, repeat_t = true;
  [[nodiscard]] bool is_set() const { return !file.empty() || image.width() > 0; }
};

/// Function that computes texture coordinates from coordinates.
struct TextureFunction {
  enum class Kind : std::uint8_t { given, plane, environment };
  Kind kind = Kind::given;
  SFVec3f s{1, 0, 0}, t{0, 1, 0};
};

struct HintsState {
  bool ccw = true, solid = false, convex = true;
  float crease_angle = 0.5F;
};

enum class DrawStyle : std::uint8_t { filled, lines, points, invisible };

struct FontState {
  String family = "SERIF", style = "PLAIN";
  float size = 10;
};

/// Camera of the text in world space.
struct CameraState {
  glm::dvec3 position{0, 0, 1};
  double height_angle = 0.785398;
  double height = 0;  // of the view, for a camera without perspective; 0 for others
};

/// Traversal state: everything that nodes set for the shapes after them. Transforms are in Output. Copies share arrays.
struct State {
  MFVec3f points, normals;
  MFFloat weights;  // of the points, for NURBS; empty if all are 1
  MFVec2f texture_points;
  MaterialState material;
  TextureState texture;
  TextureFunction texture_function;
  glm::dmat3 texture_transform{1};
  HintsState hints;
  FontState font;
  Binding material_binding = Binding::overall, normal_binding = Binding::per_vertex_indexed;
  DrawStyle draw_style = DrawStyle::filled;
  bool lit = true, textured = true;
  SFVec3f attenuation{0, 0, 1};  // of local lights: square, linear, constant
  double unit = 1;               // metres; see the node Units
  /// Identity of the value of each part. Equal identities mean equal values.
  std::array<std::uint64_t, kParts> serials{};

  [[nodiscard]] std::uint64_t serial(Part part) const { return serials[static_cast<std::size_t>(part)]; }
};

}  // namespace gs::vrml::inventor
