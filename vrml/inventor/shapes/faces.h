#pragma once

#include "vrml/inventor/state.h"

#include <optional>
#include <string_view>
#include <vector>

namespace gs::vrml::inventor {

/// Polygons or polylines of a shape, as VRML97 writes them, with the numbers that the shape gives them.
struct FaceList {
  MFInt32 index;  // coordIndex, with -1 after each face
  /// For shapes that are not an indexed set of faces; for those, all lists stay empty.
  MFInt32 vertex;  // per entry of `index`: number of the vertex in the shape; -1 after each face
  MFInt32 entry;   // per entry of `index`: index in the shape's own coordIndex; empty for shapes without indices
  MFInt32 part;    // per face: number of its part (strip, row, polyline); empty if each face is a part
  MFInt32 face;    // per face: number of the face; empty if they are in order

  [[nodiscard]] std::size_t count() const;  // number of faces
  /// Adds a corner. `own_entry` is -1 for shapes without indices.
  void corner(std::int32_t coordinate, std::int32_t number, std::int32_t own_entry);
  void end_face(std::int32_t part_number);
};

/// Indices of colours, normals or texture coordinates for a FaceList.
struct AttributeIndex {
  bool per_vertex = true;
  MFInt32 index;  // empty: the indices of the coordinates, or one value per face in order
};

/// Returns the indices for a binding. `own` are the shape's indices (materialIndex, normalIndex); `count` is the number
/// of values. If `cycles` is set, indices above `count` start again; otherwise returns nullopt for them. Returns
/// nullopt if the binding is `overall` and `cycles` is set.
[[nodiscard]] std::optional<AttributeIndex> attribute_index(const FaceList& faces, Binding binding, const MFInt32& own,
                                                            std::size_t count, bool cycles);

/// Returns the binding with this name. Bindings with indices become those without if the shape has no indices.
[[nodiscard]] Binding binding_named(std::string_view name, Binding otherwise);
[[nodiscard]] Binding without_index(Binding binding);

}  // namespace gs::vrml::inventor
