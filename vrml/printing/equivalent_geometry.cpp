#include "vrml/mesh/mesh.h"
#include "vrml/printing/equivalents.h"

#include <algorithm>
#include <numbers>
#include <string_view>
#include <utility>

namespace gs::vrml {
namespace {

const FieldValue* given_value(const SceneGraph& scene, NodeId node, std::string_view field) {
  const InterfaceDeclaration* const declaration = scene.node(node).type->find_field(field);
  return declaration ? &scene.node(node).values[declaration->slot] : nullptr;
}

template <class T>
T value_or(const SceneGraph& scene, NodeId node, std::string_view field, T otherwise) {
  const FieldValue* const value = given_value(scene, node, field);
  const T* const found = value ? std::get_if<T>(value) : nullptr;
  return found ? *found : otherwise;
}

// Copies a field that both types have.
void copy(const SceneGraph& scene, NodeId node, std::string_view field, MadeNode& made) {
  if (const FieldValue* const value = given_value(scene, node, field)) made.set(field, *value);
}

// Returns the number of points of a Coordinate or CoordinateDouble.
std::size_t point_count(const SceneGraph& scene, NodeId geometry) {
  const NodeId coordinate = scene.resolve(value_or<SFNode>(scene, geometry, "coord", {}));
  const FieldValue* const points = scene.contains(coordinate) ? given_value(scene, coordinate, "point") : nullptr;
  return points ? element_count(*points) : 0;
}

// Returns the index of a set of triangles, or the numbers of its points in order.
MFInt32 vertices_of(const SceneGraph& scene, NodeId geometry) {
  if (const FieldValue* const index = given_value(scene, geometry, "index")) return std::get<MFInt32>(*index);
  MFInt32 vertices;
  const std::size_t count = point_count(scene, geometry);
  for (std::size_t i = 0; i < count; ++i) vertices.push_back(static_cast<std::int32_t>(i));
  return vertices;
}

// Returns runs of vertices: up to negative indices, or with the lengths in the field `counts`.
std::vector<std::vector<std::int32_t>> runs_of(const SceneGraph& scene, NodeId geometry, std::string_view counts) {
  std::vector<std::vector<std::int32_t>> runs;
  const MFInt32 vertices = vertices_of(scene, geometry);
  const FieldValue* const lengths = given_value(scene, geometry, counts);
  if (!lengths) {
    runs.emplace_back();
    for (const std::int32_t vertex : vertices) {
      if (vertex < 0)
        runs.emplace_back();
      else
        runs.back().push_back(vertex);
    }
    return runs;
  }
  std::size_t next = 0;
  for (const std::int32_t length : std::get<MFInt32>(*lengths)) {
    const std::size_t end = std::min(vertices.size(), next + static_cast<std::size_t>(std::max(length, 0)));
    runs.emplace_back(vertices.begin() + next, vertices.begin() + end);
    next = end;
  }
  return runs;
}

MadeNode face_set(const SceneGraph& scene, NodeId node, const NodeType& type, MFInt32 faces) {
  MadeNode made(type);
  for (const std::string_view field : {"color", "coord", "normal", "texCoord", "ccw"}) copy(scene, node, field, made);
  copy(scene, node, "colorPerVertex", made);
  made.set("coordIndex", std::move(faces));
  // Without normals, normalPerVertex TRUE means smooth shading (X3D 11.2.3).
  if (value_or<SFBool>(scene, node, "normalPerVertex", true) && !value_or<SFNode>(scene, node, "normal", {}))
    made.set("creaseAngle", std::numbers::pi_v<float>);
  copy(scene, node, "normalPerVertex", made);
  copy(scene, node, "solid", made);
  return made;
}

MFInt32 faces_of(const MFInt32& vertices, std::size_t corners) {
  MFInt32 faces;
  std::size_t count = 0;
  for (const std::int32_t vertex : vertices) {
    if (vertex < 0) continue;
    faces.push_back(vertex);
    if (++count % corners == 0) faces.push_back(-1);
  }
  return faces;
}

void add_face(MFInt32& faces, std::int32_t a, std::int32_t b, std::int32_t c) {
  for (const std::int32_t vertex : {a, b, c, -1}) faces.push_back(vertex);
}

// Adds the Coordinate and the colours of a mesh.
void add_vertices(const Mesh& mesh, MadeNode& made) {
  MadeNode coordinate(built_in_node_type(NodeKind::coordinate));
  coordinate.set("point", mesh.positions);
  made.set("coord", std::move(coordinate));
  if (mesh.colors.empty()) return;
  MadeNode color(built_in_node_type(NodeKind::color));
  color.set("color", mesh.colors);
  made.set("color", std::move(color));
}

MadeNode triangles_of(const Mesh& mesh) {
  MadeNode made(built_in_node_type(NodeKind::indexed_face_set));
  add_vertices(mesh, made);
  MFInt32 faces;
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
    add_face(faces, static_cast<std::int32_t>(mesh.indices[i]), static_cast<std::int32_t>(mesh.indices[i + 1]),
             static_cast<std::int32_t>(mesh.indices[i + 2]));
  made.set("coordIndex", std::move(faces));
  if (!mesh.normals.empty()) {
    MadeNode normal(built_in_node_type(NodeKind::normal));
    normal.set("vector", mesh.normals);
    made.set("normal", std::move(normal));
  }
  made.set("solid", mesh.solid);
  if (!mesh.texture_coordinates.empty()) {
    MadeNode coordinates(built_in_node_type(NodeKind::texture_coordinate));
    coordinates.set("point", mesh.texture_coordinates);
    made.set("texCoord", std::move(coordinates));
  }
  return made;
}

MadeNode lines_of(const Mesh& mesh) {
  MadeNode made(built_in_node_type(NodeKind::indexed_line_set));
  add_vertices(mesh, made);
  MFInt32 lines;
  for (std::size_t i = 0; i + 1 < mesh.indices.size(); i += 2) {
    const bool continues = i > 0 && mesh.indices[i] == mesh.indices[i - 1];
    if (!continues && i > 0) lines.push_back(-1);
    if (!continues) lines.push_back(static_cast<std::int32_t>(mesh.indices[i]));
    lines.push_back(static_cast<std::int32_t>(mesh.indices[i + 1]));
  }
  made.set("coordIndex", std::move(lines));
  return made;
}

}  // namespace

MadeNode faces_of_triangle_set(const SceneGraph& scene, NodeId node, const NodeType& type) {
  return face_set(scene, node, type, faces_of(vertices_of(scene, node), 3));
}

MadeNode faces_of_quad_set(const SceneGraph& scene, NodeId node, const NodeType& type) {
  return face_set(scene, node, type, faces_of(vertices_of(scene, node), 4));
}

MadeNode faces_of_triangle_fan_set(const SceneGraph& scene, NodeId node, const NodeType& type) {
  MFInt32 faces;
  for (const auto& run : runs_of(scene, node, "fanCount"))
    for (std::size_t i = 2; i < run.size(); ++i) add_face(faces, run[0], run[i - 1], run[i]);
  return face_set(scene, node, type, std::move(faces));
}

MadeNode faces_of_triangle_strip_set(const SceneGraph& scene, NodeId node, const NodeType& type) {
  MFInt32 faces;
  for (const auto& run : runs_of(scene, node, "stripCount"))
    for (std::size_t i = 2; i < run.size(); ++i) add_face(faces, run[i - 2 + i % 2], run[i - 1 - i % 2], run[i]);
  return face_set(scene, node, type, std::move(faces));
}

MadeNode lines_of_line_set(const SceneGraph& scene, NodeId node, const NodeType& type) {
  MadeNode made(type);
  copy(scene, node, "color", made);
  copy(scene, node, "coord", made);
  MFInt32 lines;
  for (const auto& run : runs_of(scene, node, "vertexCount")) {
    if (!lines.empty()) lines.push_back(-1);
    for (const std::int32_t vertex : run) lines.push_back(vertex);
  }
  made.set("coordIndex", std::move(lines));
  return made;
}

MadeNode tessellated_node(const SceneGraph& scene, NodeId node, const NodeType& type) {
  (void)type;
  const Mesh mesh = tessellate(scene, node);
  if (mesh.primitive == Mesh::Primitive::triangles) return triangles_of(mesh);
  if (mesh.primitive == Mesh::Primitive::lines) return lines_of(mesh);
  MadeNode made(built_in_node_type(NodeKind::point_set));
  add_vertices(mesh, made);
  return made;
}

}  // namespace gs::vrml
