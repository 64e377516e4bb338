#pragma once

#include "base/box.h"
#include "vrml/scene/scene_graph.h"
#include "vrml/scene/values/field_value.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

namespace gs::vrml {

class TextShaper;

/// Texture coordinates (s, t, r, q), one per position. One set of a MultiTextureCoordinate of X3D.
using CoordinateSet = Array<glm::vec4>;
/// Maximum sets of texture coordinates of a mesh.
inline constexpr std::size_t kMaxCoordinateSets = 5;

/// Geometry of one Shape, ready to draw, without GL objects. Node space, metres.
///
/// Arrays share storage with the fields that they came from, if the layout permits it.
struct Mesh {
  enum class Primitive : std::uint8_t { triangles, lines, points };

  Primitive primitive = Primitive::triangles;
  Array<glm::vec3> positions;
  Array<glm::vec3> normals;              // empty, or one unit vector per position
  Array<Color> colors;                   // empty, or one per position; replace diffuseColor or emissiveColor
  Array<float> opacities;                // empty, or one per position; replace 1 - transparency (ColorRGBA)
  Array<float> fog_depths;               // empty, or one per position: the part of the fog, 0 to 1 (FogCoordinate)
  Array<glm::vec2> texture_coordinates;  // empty, or one (s, t) per position
  /// All sets of texture coordinates, at most kMaxCoordinateSets. Empty if `texture_coordinates` has all of them.
  std::vector<CoordinateSet> coordinate_sets;
  Array<std::uint32_t> indices;  // 3 per triangle, 2 per line or 1 per point; all < positions.size()
  bool solid = true;             // back faces need not be drawn
  bool lit = true;               // false for lines and points (VRML97 4.14.2)
  bool convex = false;           // the faces are on a convex body, so no front face hides another
  bool limited = false;          // a limit of memory or time removed some or all of the geometry
  bool translucent = false;      // some opacities are below 1
  bool pictured = false;         // texture_coordinates refer to the glyph atlas of the TextShaper
  bool in_points = false;        // Text with a ScreenFontStyle: a unit is a point of the screen (X3D 36.4.5)
  float font_size = 0;           // size of a Text in node space; 0 if MeshOptions::text_level does not matter
  Box bounds;                    // bounds of the positions in use
  glm::dvec3 origin{0};  // position of the mesh's space in node space; not 0 for coordinates in double precision
  /// The same surface with fewer triangles, for small sizes on the screen; null if there is none. Its maximum distance
  /// from this mesh is `coarser_error`, relative to the radius of the sphere around `bounds`.
  std::shared_ptr<const Mesh> coarser;
  float coarser_error = 0;

  [[nodiscard]] bool empty() const { return indices.empty(); }
  /// Returns the memory in the unit of Resource::meshes, including the renderer's copy. Arrays shared with fields count
  /// once.
  [[nodiscard]] std::uint64_t cost() const;
};

/// Options of tessellate(): level of detail of curved primitives, and optional parts.
struct MeshOptions {
  int segments = 32;  // number around a full circle; at least 3
  /// Gives an IndexedFaceSet without texCoord the default coordinates of VRML97 6.23. False saves this work if no
  /// texture is drawn.
  bool texture_coordinates = true;
  /// For Box, Cone, Cylinder and Sphere: uses the default measures instead of the node's.
  bool default_measures = false;
  /// Gives lines texture coordinates: s is the length along the polyline, in metres. For line patterns.
  bool line_lengths = false;
  /// For OutlineGroup: another OutlineGroup that refines it and is drawn with it; null if there is none.
  NodeId refiner{};
  /// Access to fonts; if null, a Text is empty. Must outlive the call. At the level kTextPictures, the mesh draws the
  /// text from a glyph atlas, which replaces the texture of the Shape.
  TextShaper* text_shaper = nullptr;
  std::size_t text_level = 1;  // detail of glyphs: index in kTextTolerances (vrml/mesh/text_shaper.h)
};

/// Tessellates a geometry node. Triangles are counter-clockwise seen from the front, even if the node's `ccw` field is
/// FALSE. Broken input (indices out of range, NaN coordinates, degenerate polygons) removes only the affected faces.
/// Returns an empty mesh for other nodes. `geometry` may be a PROTO instance. Draws working memory from the scene's
/// budget and gives it back. The caller draws the memory of the mesh. Any thread that owns the scene.
[[nodiscard]] Mesh tessellate(const SceneGraph& scene, NodeId geometry, const MeshOptions& options = {});

/// Returns the scale per axis that turns the default Box, Cone, Cylinder or Sphere into this node, so that many nodes
/// share one mesh. Returns nullopt for other nodes and for invalid measures.
[[nodiscard]] std::optional<glm::vec3> scale_of_primitive(const SceneGraph& scene, NodeId geometry);

}  // namespace gs::vrml
