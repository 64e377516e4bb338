#pragma once

#include "base/box.h"
#include "vrml/scene/field_value.h"
#include "vrml/scene/scene_graph.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>

namespace gs::vrml {

class TextShaper;

/// Geometry of one Shape, ready to draw, without GL objects. Node space, metres.
///
/// Arrays share storage with the fields they came from where the layout permits it.
struct Mesh {
  enum class Primitive : std::uint8_t { triangles, lines, points };

  Primitive primitive = Primitive::triangles;
  Array<glm::vec3> positions;
  Array<glm::vec3> normals;              // empty, or one unit vector per position
  Array<Color> colors;                   // empty, or one per position; replaces diffuseColor / emissiveColor
  Array<glm::vec2> texture_coordinates;  // empty, or one (s, t) per position
  Array<std::uint32_t> indices;          // 3, 2 or 1 per primitive; all < positions.size()
  bool solid = true;                     // back faces need not be drawn
  bool lit = true;                       // false for lines and points (VRML97 4.14.2)
  bool convex = false;                   // no front face hides another: the faces lie on a convex body
  bool limited = false;                  // a memory or time limit removed some or all of it
  bool pictured = false;                 // texture_coordinates refer to the TextShaper's glyph atlas
  float font_size = 0;                   // of a Text, in node space; 0 if MeshOptions::text_level has no effect
  Box bounds;                            // of the positions in use
  /// The same surface with fewer triangles, for small projections; null if there is none. Its distance from this mesh
  /// is at most `coarser_error`, relative to the radius of the sphere around `bounds`.
  std::shared_ptr<const Mesh> coarser;
  float coarser_error = 0;

  [[nodiscard]] bool empty() const { return indices.empty(); }
  /// Returns the cost in Resource::meshes, including the renderer's copy. Arrays shared with fields count once.
  [[nodiscard]] std::uint64_t cost() const;
};

/// Level of detail of curved primitives, and optional parts.
struct MeshOptions {
  int segments = 32;  // around a full circle; at least 3
  /// Give an IndexedFaceSet without texCoord the default coordinates of VRML97 6.23. Set it to false to save the work
  /// if no texture is drawn.
  bool texture_coordinates = true;
  /// Box, Cone, Cylinder or Sphere: use the default measures instead of the node's.
  bool default_measures = false;
  /// OutlineGroup: another one that refines it and is drawn with it; null if there is none.
  NodeId refiner{};
  /// Font access; without it, Text is empty. Must outlive the call. At level kTextPictures it draws text from a glyph
  /// atlas, which takes the place of the Shape's texture.
  TextShaper* text_shaper = nullptr;
  std::size_t text_level = 1;  // index in kTextTolerances (vrml/mesh/text_shaper.h): detail of glyphs
};

/// Tessellates a geometry node. Triangles are counter-clockwise seen from the front, whatever the node's `ccw` field
/// says. Broken input (indices out of range, NaN coordinates, degenerate polygons) loses only the affected faces.
/// Returns an empty mesh for other nodes. `geometry` may be a PROTO instance. Working memory is drawn from the scene's
/// budget and given back; the caller accounts for the mesh itself. Runs on any thread that owns the scene.
[[nodiscard]] Mesh tessellate(const SceneGraph& scene, NodeId geometry, const MeshOptions& options = {});

/// Returns the axis scale that turns the default Box, Cone, Cylinder or Sphere into this one, so that many nodes share
/// one mesh. Returns nullopt for other nodes and invalid measures.
[[nodiscard]] std::optional<glm::vec3> scale_of_primitive(const SceneGraph& scene, NodeId geometry);

}  // namespace gs::vrml
