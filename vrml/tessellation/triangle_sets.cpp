// Tessellators of the X3D nodes that list triangles or quadrilaterals (X3D 11.2.5, 32.4.6).
#include "vrml/mesh/face_set.h"
#include "vrml/mesh/vertices.h"
#include "vrml/tessellation/properties.h"
#include "vrml/tessellation/tessellators.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <span>
#include <utility>

namespace gs::vrml {
namespace {

/// Writer of a coordIndex from lists of vertices.
class FaceLister {
 public:
  /// Reserves memory for `faces` faces of `corners` corners.
  FaceLister(std::size_t faces, std::size_t corners) : next_(index_.prepare(faces * (corners + 1))) {}

  void triangle(std::int32_t a, std::int32_t b, std::int32_t c) {
    next_[0] = a;
    next_[1] = b;
    next_[2] = c;
    next_[3] = -1;
    next_ += 4;
    count_ += 4;
  }
  void quadrilateral(std::int32_t a, std::int32_t b, std::int32_t c, std::int32_t d) {
    next_[0] = a;
    next_[1] = b;
    next_[2] = c;
    next_[3] = d;
    next_[4] = -1;
    next_ += 5;
    count_ += 5;
  }
  [[nodiscard]] MFInt32 finish() {
    index_.commit(count_);
    if (count_ == 0) index_.clear();
    return std::move(index_);
  }

 private:
  MFInt32 index_;
  std::int32_t* next_;
  std::size_t count_ = 0;
};

/// Source of the vertices of a node: its field `index`, or the coordinates in their order.
struct Vertices {
  std::span<const std::int32_t> index;
  std::size_t count = 0;  // number of coordinates, if there is no index

  [[nodiscard]] std::size_t size() const { return index.empty() ? count : index.size(); }
  [[nodiscard]] std::int32_t operator[](std::size_t i) const {
    return index.empty() ? static_cast<std::int32_t>(i) : index[i];
  }
};

constexpr std::size_t kMaxVertices = kMaximumCorners / 5;

/// Makes the mesh of faces with the properties of the node. Without normals, normalPerVertex TRUE means smooth shading.
Mesh composed(const SceneGraph& scene, NodeId geometry, const MeshOptions& options, Coordinates coordinates,
              MFInt32 coord_index) {
  FaceSet faces;
  faces.coord_index = std::move(coord_index);
  faces.points = std::move(coordinates.points);
  set_properties(faces, scene, geometry);
  if (scene.get<SFBool>(geometry, "normalPerVertex")) faces.crease_angle = std::numbers::pi_v<float>;
  set_texture_coordinates(faces, scene, geometry);
  faces.default_texture_coordinates = options.texture_coordinates;
  faces.ccw = scene.get<SFBool>(geometry, "ccw");
  faces.solid = scene.get<SFBool>(geometry, "solid");
  faces.budget = scene.budget();
  Mesh mesh = make_mesh(std::move(faces));
  mesh.origin = coordinates.origin;
  return mesh;
}

/// Lists faces of `corners` vertices each. Skips the end markers of IndexedFaceSet, which some files have.
MFInt32 plain_faces(const Vertices& vertices, std::size_t corners) {
  FaceLister lister(vertices.size() / corners, corners);
  std::array<std::int32_t, 4> face{};
  std::size_t have = 0;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    if (vertices[i] < 0) continue;
    face[have++] = vertices[i];
    if (have < corners) continue;
    have = 0;
    corners == 3 ? lister.triangle(face[0], face[1], face[2])
                 : lister.quadrilateral(face[0], face[1], face[2], face[3]);
  }
  return lister.finish();
}

/// Calls `add(first, count)` for each run of vertices. Runs end at negative indices.
template <class Add>
void for_each_run(std::span<const std::int32_t> index, const Add& add) {
  for (std::size_t begin = 0; begin < index.size();) {
    std::size_t end = begin;
    while (end < index.size() && index[end] >= 0) ++end;
    add(begin, end - begin);
    begin = end + 1;
  }
}

/// Calls `add(first, count)` for each run of coordinates, as counted by the field `counts`.
template <class Add>
void for_each_run(std::span<const std::int32_t> counts, std::size_t points, const Add& add) {
  std::size_t begin = 0;
  for (const std::int32_t given : counts) {
    if (begin == points) return;
    const std::size_t count = std::min<std::size_t>(static_cast<std::size_t>(std::max(given, 0)), points - begin);
    add(begin, count);
    begin += count;
  }
}

enum class Joined : std::uint8_t { strip, fan };

/// Appends the triangles of a strip or fan.
void add_joined(FaceLister& lister, const Vertices& vertices, Joined joined, std::size_t first, std::size_t count) {
  for (std::size_t i = 2; i < count; ++i) {
    const std::size_t at = first + i;
    if (joined == Joined::fan)
      lister.triangle(vertices[first], vertices[at - 1], vertices[at]);
    else if (i % 2 == 0)
      lister.triangle(vertices[at - 2], vertices[at - 1], vertices[at]);
    else
      lister.triangle(vertices[at - 1], vertices[at - 2], vertices[at]);
  }
}

[[nodiscard]] Mesh limited() {
  Mesh mesh;
  mesh.limited = true;
  return mesh;
}

/// Draws the memory of a coordIndex for this number of vertices.
[[nodiscard]] bool draw(Share& share, std::size_t vertices) {
  constexpr std::uint64_t kBytesOfVertex = 20;
  return vertices <= kMaxVertices && share.grow(vertices * kBytesOfVertex);
}

Mesh plain_set(const SceneGraph& scene, NodeId geometry, const MeshOptions& options, bool indexed,
               std::size_t corners) {
  Coordinates coordinates = coordinates_of(scene, geometry);
  const MFInt32 index = indexed ? scene.get<MFInt32>(geometry, "index") : MFInt32{};
  const Vertices vertices{index.span(), indexed ? 0 : coordinates.points.size()};
  Share share(scene.budget(), Resource::meshes);
  if (!draw(share, vertices.size())) return limited();
  return composed(scene, geometry, options, std::move(coordinates), plain_faces(vertices, corners));
}

Mesh indexed_joined_set(const SceneGraph& scene, NodeId geometry, const MeshOptions& options, Joined joined) {
  const MFInt32 index = scene.get<MFInt32>(geometry, "index");
  Share share(scene.budget(), Resource::meshes);
  if (!draw(share, index.size())) return limited();
  FaceLister lister(index.size(), 3);
  for_each_run(index.span(),
               [&](std::size_t first, std::size_t count) { add_joined(lister, {index.span()}, joined, first, count); });
  return composed(scene, geometry, options, coordinates_of(scene, geometry), lister.finish());
}

Mesh counted_joined_set(const SceneGraph& scene, NodeId geometry, const MeshOptions& options, Joined joined,
                        const char* counts) {
  Coordinates coordinates = coordinates_of(scene, geometry);
  const std::size_t points = coordinates.points.size();
  Share share(scene.budget(), Resource::meshes);
  if (!draw(share, points)) return limited();
  FaceLister lister(points, 3);
  for_each_run(scene.get<MFInt32>(geometry, counts).span(), points, [&](std::size_t first, std::size_t count) {
    add_joined(lister, {{}, points}, joined, first, count);
  });
  return composed(scene, geometry, options, std::move(coordinates), lister.finish());
}

}  // namespace

Mesh tessellate_triangle_set(const SceneGraph& scene, NodeId geometry, const MeshOptions& options) {
  return plain_set(scene, geometry, options, false, 3);
}
Mesh tessellate_indexed_triangle_set(const SceneGraph& scene, NodeId geometry, const MeshOptions& options) {
  return plain_set(scene, geometry, options, true, 3);
}
Mesh tessellate_quad_set(const SceneGraph& scene, NodeId geometry, const MeshOptions& options) {
  return plain_set(scene, geometry, options, false, 4);
}
Mesh tessellate_indexed_quad_set(const SceneGraph& scene, NodeId geometry, const MeshOptions& options) {
  return plain_set(scene, geometry, options, true, 4);
}
Mesh tessellate_triangle_fan_set(const SceneGraph& scene, NodeId geometry, const MeshOptions& options) {
  return counted_joined_set(scene, geometry, options, Joined::fan, "fanCount");
}
Mesh tessellate_triangle_strip_set(const SceneGraph& scene, NodeId geometry, const MeshOptions& options) {
  return counted_joined_set(scene, geometry, options, Joined::strip, "stripCount");
}
Mesh tessellate_indexed_triangle_fan_set(const SceneGraph& scene, NodeId geometry, const MeshOptions& options) {
  return indexed_joined_set(scene, geometry, options, Joined::fan);
}
Mesh tessellate_indexed_triangle_strip_set(const SceneGraph& scene, NodeId geometry, const MeshOptions& options) {
  return indexed_joined_set(scene, geometry, options, Joined::strip);
}

}  // namespace gs::vrml
