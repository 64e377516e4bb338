#pragma once

#include "base/noncopyable.h"
#include "vrml/inventor/converter.h"
#include "vrml/inventor/shapes/faces.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>

namespace gs::vrml::inventor {

/// Indices that a shape gives for its materials, normals and texture coordinates.
struct OwnIndices {
  MFInt32 material, normal, texture;
  bool indexed = true;  // false for FaceSet, QuadMesh and similar shapes, which have no indices
};

/// Adds a Shape with the geometry `geometry_type`, and returns the geometry for its fields. Returns null if a limit is
/// reached. Call Output::end() for it.
[[nodiscard]] NodeId begin_geometry(Converter& converter, const Item& item, const State& state, const Look& look,
                                    std::string_view geometry_type);
/// Adds a Shape with a geometry that exists already.
void add_shape(Converter& converter, const Item& item, const State& state, const Look& look, NodeId geometry);

/// Sets a geometric property, such as `coord`. Properties with the same identity share one node.
template <class T>
void set_property(Converter& converter, NodeId geometry, std::string_view field, std::string_view type,
                  std::string_view values_field, const T& values, const std::string& identity) {
  Output& output = converter.output();
  NodeId& known = converter.looks().property(std::string(type) + identity);
  if (known) return output.place(known, output.field(geometry, field));
  const NodeId node = output.begin(type, output.field(geometry, field), output.scene().node(geometry).location);
  if (!node) return;
  output.set(node, values_field, values);
  output.end(node);
  converter.looks().property(std::string(type) + identity) = node;
}

/// Adds a Shape with polygons, drawn in the style of the state: as polygons, outlines or points.
void add_faces(Converter& converter, const Item& item, const State& state, const FaceList& faces,
               const OwnIndices& own);
/// Adds a Shape with polylines.
void add_lines(Converter& converter, const Item& item, const State& state, const FaceList& lines,
               const OwnIndices& own);
/// Adds a Shape with the points from `first` on.
void add_points(Converter& converter, const Item& item, const State& state, std::size_t first, std::size_t count);

/// Returns the state for a shape: that of the traversal, with the values of the shape's vertexProperty.
[[nodiscard]] State state_of_shape(Converter& converter, const Item& item);
/// Sets the values that a VertexProperty gives.
void apply_vertex_property(Converter& converter, const Item& item, State& state);

}  // namespace gs::vrml::inventor
