#pragma once

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

/// An axis-aligned box; empty when lower > upper.
struct Bounds {
  glm::vec3 lower{std::numeric_limits<float>::infinity()};
  glm::vec3 upper{-std::numeric_limits<float>::infinity()};

  [[nodiscard]] bool empty() const { return !(lower.x <= upper.x); }
  void add(const glm::vec3& p) {
    lower = {std::min(lower.x, p.x), std::min(lower.y, p.y), std::min(lower.z, p.z)};
    upper = {std::max(upper.x, p.x), std::max(upper.y, p.y), std::max(upper.z, p.z)};
  }
  void add(const Bounds& other) {
    if (other.empty()) return;
    add(other.lower);
    add(other.upper);
  }
  [[nodiscard]] glm::vec3 center() const { return (lower + upper) * 0.5f; }
  [[nodiscard]] glm::vec3 size() const { return upper - lower; }
};

/// The geometry of one Shape, ready to draw; no GL in it. Node space, metres.
///
/// Arrays share their storage with the fields they came from where the layout allows it.
struct Mesh {
  enum class Primitive : std::uint8_t { triangles, lines, points };

  Primitive primitive = Primitive::triangles;
  Array<glm::vec3> positions;
  Array<glm::vec3> normals;              // empty, or one unit vector a position
  Array<Color> colors;                   // empty, or one a position; replaces diffuseColor / emissiveColor
  Array<glm::vec2> texture_coordinates;  // empty, or one (s, t) a position
  Array<std::uint32_t> indices;          // 3, 2 or 1 a primitive; every one < positions.size()
  bool solid = true;                     // back faces need not be drawn
  bool lit = true;                       // false for lines and points (VRML97 4.14.2)
  bool convex = false;                   // no front face hides another: they belong to a convex body
  bool left_out = false;                 // the limit for meshes, or the end of the time, took some or all of it
  bool pictured = false;                 // texture_coordinates are of the TextShaper's picture of glyphs
  float font_size = 0;                   // of a Text, in node space; 0 of what MeshOptions::text_level does not change
  Bounds bounds;                         // of the positions that are used
  /// The same surface with fewer triangles, for who sees it small; null: there is none. No point of it is farther from
  /// this one than `coarser_error`, as a part of the radius of the sphere around `bounds`.
  std::shared_ptr<const Mesh> coarser;
  float coarser_error = 0;

  [[nodiscard]] bool empty() const { return indices.empty(); }
  /// What it takes of Resource::meshes, with the copy of those who draw it: arrays that it shares with fields once.
  [[nodiscard]] std::uint64_t cost() const;
};

/// How finely curved primitives are cut, and what may be left out.
struct MeshOptions {
  int segments = 32;  // around a full circle; at least 3
  /// Give an IndexedFaceSet without texCoord the default coordinates of VRML97 6.23. False saves
  /// the work where no texture is drawn.
  bool texture_coordinates = true;
  /// Of a Box, Cone, Cylinder or Sphere: the one with the default measures, in the place of its own.
  bool default_measures = false;
  /// Of an OutlineGroup: the one that refines it, whose polygons are drawn with it; null: none.
  NodeId refiner{};
  /// Who knows fonts; without one, Text is empty. Must outlive the call. At kTextPictures it has a picture of glyphs,
  /// in whose place no texture of the Shape can be.
  TextShaper* text_shaper = nullptr;
  std::size_t text_level = 1;  // of kTextTolerances (vrml/mesh/text_shaper.h): how finely glyphs are cut
};

/// The mesh of a geometry node, in counter-clockwise order seen from the front whatever the node's
/// `ccw` says. Broken input (indices out of range, NaN coordinates, degenerate polygons) loses the
/// faces it touches and nothing else. Empty for a node that is no geometry or has none.
/// `geometry` may be a PROTO instance. Memory for the work is drawn from the scene's budget and given back; the mesh's
/// own is for the caller to draw. Any thread that owns the scene.
[[nodiscard]] Mesh tessellate(const SceneGraph& scene, NodeId geometry, const MeshOptions& options = {});

/// What makes a Box, Cone, Cylinder or Sphere of one with the default measures, along its axes: so that worlds of
/// thousands share one mesh. Nothing for any other node, and for measures that are none.
[[nodiscard]] std::optional<glm::vec3> scale_of_primitive(const SceneGraph& scene, NodeId geometry);

}  // namespace gs::vrml
