#include "vrml/mesh/face_set.h"

#include "vrml/mesh/corner_normals.h"
#include "vrml/mesh/face_reader.h"
#include "vrml/mesh/polygon.h"
#include "vrml/mesh/vertices.h"
#include "vrml/mesh/welder.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace gs::vrml {
namespace {

constexpr float kUnitTolerance = 0.01f;   // of the squared length; texts give three or four digits
constexpr float kShortestSquare = 1e-24f;

[[nodiscard]] bool has_direction(const glm::vec3& v) {
  const float square = glm::dot(v, v);
  return square > kShortestSquare && square < std::numeric_limits<float>::infinity();
}

/// Appends indices, making room as it goes.
class IndexWriter {
 public:
  explicit IndexWriter(std::size_t expected) { grow(expected); }

  void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    if (end_ - next_ < 3) grow(static_cast<std::size_t>(next_ - begin_) + 3);
    next_[0] = a;
    next_[1] = b;
    next_[2] = c;
    next_ += 3;
  }
  [[nodiscard]] Array<std::uint32_t> finish() {
    indices_.commit(static_cast<std::size_t>(next_ - begin_));
    indices_.shrink_to_fit();
    if (indices_.empty()) indices_.clear();
    return std::move(indices_);
  }

 private:
  void grow(std::size_t room) {
    indices_.commit(static_cast<std::size_t>(next_ - begin_));
    begin_ = next_ = indices_.prepare(std::max<std::size_t>(room, 3));
    end_ = begin_ + (indices_.capacity() - indices_.size());
  }
  Array<std::uint32_t> indices_;
  std::uint32_t *begin_ = nullptr, *next_ = nullptr, *end_ = nullptr;
};

/// Cuts faces into triangles.
class FaceCutter {
 public:
  FaceCutter(const FaceSet& faces, std::span<const std::int32_t> coord_index) : faces_(faces), index_(coord_index) {}

  /// Calls emit(i, j, k), places in `corners`, for each triangle.
  template <class Emit>
  void cut(std::span<const std::uint32_t> corners, const Emit& emit) {
    const auto count = static_cast<std::uint32_t>(corners.size());
    if (count == 3 || faces_.convex) {
      for (std::uint32_t i = 2; i < count; ++i) emit(0u, i - 1, i);
      return;
    }
    polygon_.resize(count);
    for (std::uint32_t i = 0; i < count; ++i)
      polygon_[i] = faces_.points[static_cast<std::size_t>(index_[corners[i]])];
    const std::span<const std::uint32_t> triangles = triangulator_.triangulate(polygon_);
    for (std::size_t i = 0; i < triangles.size(); i += 3) emit(triangles[i], triangles[i + 1], triangles[i + 2]);
  }

 private:
  const FaceSet& faces_;
  std::span<const std::int32_t> index_;
  std::vector<glm::vec3> polygon_;
  PolygonTriangulator triangulator_;
};

/// The mesh when every corner takes all its attributes by its vertex: the arrays as they are, and indices.
class SharedBuilder {
 public:
  SharedBuilder(const FaceSet& faces, std::span<const std::int32_t> coord_index, const UsableVertices& vertices)
      : faces_(faces), index_(coord_index), vertices_(vertices), used_(faces.points.size(), 0),
        out_(coord_index.size() / 4 * 3 + 3) {}

  [[nodiscard]] Mesh build() {
    FaceCutter cutter(faces_, index_);
    std::size_t position = 0, face = 0;
    while (position < index_.size()) {
      const std::size_t triangles = vertices_.all() ? read_triangles(index_.subspan(position)) : 0;
      position += 4 * triangles;
      face += triangles;
      if (position >= index_.size()) break;
      FaceReader reader(index_, vertices_, faces_.ccw, position, face);
      // Not one reader a face: its memory is kept while faces are no plain triangles.
      do {
        if (reader.read()) add(cutter, reader);
      } while (!reader.at_end() && !(vertices_.all() && is_triangle(reader.position())));
      position = reader.position();
      face = reader.next_face();
    }
    Mesh mesh;
    mesh.positions = faces_.points;
    mesh.normals = faces_.normal.values;
    mesh.colors = faces_.color.values;
    mesh.texture_coordinates = faces_.texture_coordinate.values;
    mesh.indices = out_.finish();
    mesh.bounds = bounds_of(faces_.points.span(), used_);
    return mesh;
  }

 private:
  [[nodiscard]] bool is_triangle(std::size_t i) const { return i + 3 < index_.size() && index_[i + 3] < 0; }

  void add(FaceCutter& cutter, const FaceReader& reader) {
    const std::span<const std::uint32_t> corners = reader.corners();
    for (const std::uint32_t corner : corners) used_[reader.vertex(corner)] = 1;
    cutter.cut(corners, [&](std::uint32_t i, std::uint32_t j, std::uint32_t k) {
      out_.triangle(reader.vertex(corners[i]), reader.vertex(corners[j]), reader.vertex(corners[k]));
    });
  }

  /// Reads the plain triangles at the front, each with its end marker; returns how many. Large meshes are made of these.
  [[nodiscard]] std::size_t read_triangles(std::span<const std::int32_t> from) {
    const auto count = static_cast<std::uint32_t>(vertices_.count());
    const bool ccw = faces_.ccw;
    std::uint8_t* used = used_.data();
    std::size_t i = 0;
    for (; i + 3 < from.size() && from[i + 3] < 0; i += 4) {
      const auto a = static_cast<std::uint32_t>(from[i]), b = static_cast<std::uint32_t>(from[i + 1]),
                 c = static_cast<std::uint32_t>(from[i + 2]);
      if (a >= count || b >= count || c >= count || a == b || b == c || c == a) break;
      used[a] = used[b] = used[c] = 1;
      out_.triangle(a, ccw ? b : c, ccw ? c : b);
    }
    return i / 4;
  }

  const FaceSet& faces_;
  std::span<const std::int32_t> index_;
  const UsableVertices& vertices_;
  std::vector<std::uint8_t> used_;
  IndexWriter out_;
};

/// The mesh in all other cases: a vertex for each different corner.
class CornerBuilder {
 public:
  CornerBuilder(const FaceSet& faces, std::span<const std::int32_t> coord_index, const UsableVertices& vertices)
      : faces_(faces), index_(coord_index), vertices_(vertices), welder_(faces.points.size(), can_weld(faces)),
        out_(coord_index.size() / 4 * 3 + 3) {}

  [[nodiscard]] Mesh build() {
    FaceCutter cutter(faces_, index_);
    FaceReader reader(index_, vertices_, faces_.ccw);
    std::vector<std::uint32_t> made;
    while (reader.next()) {
      const std::span<const std::uint32_t> corners = reader.corners();
      made.clear();
      face_normal_ = kMissing;
      if (!add_corners(reader, made)) continue;
      cutter.cut(corners, [&](std::uint32_t i, std::uint32_t j, std::uint32_t k) {
        out_.triangle(made[i], made[j], made[k]);
      });
    }
    return gather_mesh();
  }

 private:
  /// Corners of different faces differ for certain where something belongs to one face only.
  [[nodiscard]] static bool can_weld(const FaceSet& faces) {
    return faces.normal.binding != Binding::none && faces.normal.binding != Binding::by_face &&
           faces.color.binding != Binding::by_face;
  }
  [[nodiscard]] bool add_corners(const FaceReader& reader, std::vector<std::uint32_t>& made);
  [[nodiscard]] bool set_normal(const FaceReader& reader, std::uint32_t corner, VertexParts& parts);
  [[nodiscard]] Mesh gather_mesh();

  const FaceSet& faces_;
  std::span<const std::int32_t> index_;
  const UsableVertices& vertices_;
  Welder welder_;
  IndexWriter out_;
  std::vector<glm::vec3> face_normals_;   // made for faces that lack some; named by places behind the given ones
  std::uint32_t face_normal_ = kMissing;  // that of the face at hand, once made
  std::vector<glm::vec3> scratch_;
};

bool CornerBuilder::add_corners(const FaceReader& reader, std::vector<std::uint32_t>& made) {
  for (const std::uint32_t corner : reader.corners()) {
    VertexParts parts;
    parts.position = reader.vertex(corner);
    if (!set_normal(reader, corner, parts)) return false;
    if (faces_.color.binding != Binding::none) {
      parts.color = faces_.color.find(corner, parts.position, reader.face());
      if (parts.color == kMissing)
        parts.color = std::min(parts.position, static_cast<std::uint32_t>(faces_.color.values.size() - 1));
    }
    parts.texture_coordinate = faces_.texture_coordinate.find(corner, parts.position, reader.face());
    made.push_back(welder_.add(parts));
  }
  return true;
}

bool CornerBuilder::set_normal(const FaceReader& reader, std::uint32_t corner, VertexParts& parts) {
  const std::uint32_t given = faces_.normal.find(corner, parts.position, reader.face());
  if (given != kMissing && has_direction(faces_.normal.values[given])) {
    parts.normal = given;
    return true;
  }
  if (face_normal_ == kMissing) {
    const glm::vec3 normal = face_normal(reader.corners(), index_, faces_.points.span(), scratch_);
    if (normal == glm::vec3(0)) return false;
    face_normal_ = static_cast<std::uint32_t>(faces_.normal.values.size() + face_normals_.size());
    face_normals_.push_back(normal);
  }
  parts.normal = face_normal_;
  return true;
}

Mesh CornerBuilder::gather_mesh() {
  Mesh mesh;
  mesh.indices = out_.finish();
  const std::span<const VertexParts> vertices = welder_.vertices();
  if (mesh.indices.empty()) return mesh;
  mesh.positions = gather(faces_.points, vertices, &VertexParts::position, glm::vec3(0));
  const std::size_t given = faces_.normal.values.size();
  glm::vec3* normal = mesh.normals.prepare(vertices.size());
  for (const VertexParts& vertex : vertices) {
    const glm::vec3 n = vertex.normal < given ? faces_.normal.values[vertex.normal] : face_normals_[vertex.normal - given];
    const float square = glm::dot(n, n);
    *normal++ = std::abs(square - 1) < kUnitTolerance ? n : n / std::sqrt(square);
  }
  mesh.normals.commit(vertices.size());
  if (faces_.color.binding != Binding::none)
    mesh.colors = gather(faces_.color.values, vertices, &VertexParts::color, Color{1, 1, 1});
  if (faces_.texture_coordinate.binding != Binding::none)
    mesh.texture_coordinates =
        gather(faces_.texture_coordinate.values, vertices, &VertexParts::texture_coordinate, glm::vec2(0));
  mesh.bounds = bounds_of(mesh.positions.span());
  return mesh;
}

/// Makes a copy of the used coordinates where one node uses few out of many.
void compact_points(FaceSet& faces) {
  const std::span<const std::int32_t> index = readable(faces.coord_index);
  if (!needs_compaction(faces.points.size(), index.size())) return;
  Compaction compaction = compact(index, faces.points.size());
  // Before the points, whose number says which colour is the last one.
  if (faces.color.binding == Binding::by_vertex)
    faces.color.values = gather(faces.color.values, compaction.kept, faces.color.values.back());
  if (faces.normal.binding == Binding::by_vertex)
    faces.normal.values = gather(faces.normal.values, compaction.kept, glm::vec3(0));
  if (faces.texture_coordinate.binding == Binding::by_vertex)
    faces.texture_coordinate.values = gather(faces.texture_coordinate.values, compaction.kept, glm::vec2(0));
  faces.points = gather(faces.points, compaction.kept, glm::vec3(0));
  faces.coord_index = std::move(compaction.index);
}

/// Makes by_vertex normals as many as the points and of unit length, without a copy where they are so
/// already. False when some used one is missing or has no direction.
[[nodiscard]] bool fit_normals(FaceSet& faces) {
  const std::size_t points = faces.points.size();
  if (faces.normal.values.size() < points) {
    std::int32_t largest = -1;
    for (const std::int32_t vertex : readable(faces.coord_index)) largest = std::max(largest, vertex);
    if (largest >= 0 && static_cast<std::size_t>(largest) >= faces.normal.values.size()) return false;
  }
  bool unit = true, usable = true;
  for (const glm::vec3& normal : faces.normal.values) {
    const float square = glm::dot(normal, normal);
    unit &= std::abs(square - 1) < kUnitTolerance;
    usable &= square > kShortestSquare && square < std::numeric_limits<float>::infinity();
  }
  if (!usable) return false;
  faces.normal.fit(points, glm::vec3(0, 0, 1));
  if (unit) return true;
  glm::vec3* normal = faces.normal.values.mutable_data();
  for (std::size_t i = 0; i < points; ++i) normal[i] /= std::sqrt(glm::dot(normal[i], normal[i]));
  return true;
}

[[nodiscard]] bool by_vertex_or_none(Binding binding) {
  return binding == Binding::by_vertex || binding == Binding::none;
}

}  // namespace

Mesh make_mesh(FaceSet faces) {
  Mesh mesh;
  if (!faces.coord_index.empty() && !faces.points.empty()) {
    faces.normal.simplify(faces.coord_index.span());
    faces.color.simplify(faces.coord_index.span());
    faces.texture_coordinate.simplify(faces.coord_index.span());
    compact_points(faces);
    const std::span<const std::int32_t> index = readable(faces.coord_index);
    const UsableVertices vertices(faces.points.span());
    if (faces.normal.binding == Binding::none && faces.crease_angle > 0)
      faces.normal = crease_normals(index, faces.points.span(), vertices, faces.ccw, faces.crease_angle);
    if (faces.normal.binding == Binding::by_vertex && by_vertex_or_none(faces.color.binding) &&
        by_vertex_or_none(faces.texture_coordinate.binding) && fit_normals(faces)) {
      if (faces.color.binding != Binding::none) faces.color.fit(faces.points.size(), faces.color.values.back());
      if (faces.texture_coordinate.binding != Binding::none) faces.texture_coordinate.fit(faces.points.size(), glm::vec2(0));
      mesh = SharedBuilder(faces, index, vertices).build();
    } else {
      mesh = CornerBuilder(faces, index, vertices).build();
    }
  }
  mesh.solid = faces.solid;
  if (mesh.indices.empty()) return Mesh{.solid = faces.solid};
  if (faces.default_texture_coordinates && mesh.texture_coordinates.empty())
    mesh.texture_coordinates = default_texture_coordinates(mesh.positions.span(), mesh.bounds);
  return mesh;
}

namespace {

template <class T>
void append_values(Array<T>& values, std::size_t count, const Array<T>& more, std::size_t more_count, const T& filling) {
  if (values.empty() && more.empty()) return;
  const auto fill = [&](std::size_t size) {
    for (std::size_t i = values.size(); i < size; ++i) values.push_back(filling);
  };
  values.reserve(count + more_count);
  fill(count);
  values.append(more.span());
  fill(count + more_count);
}

}  // namespace

void append(Mesh& mesh, const Mesh& more) {
  if (more.empty()) return;
  const std::size_t count = mesh.positions.size(), more_count = more.positions.size();
  append_values(mesh.normals, count, more.normals, more_count, glm::vec3(0));
  append_values(mesh.colors, count, more.colors, more_count, Color{1, 1, 1});
  append_values(mesh.texture_coordinates, count, more.texture_coordinates, more_count, glm::vec2(0));
  mesh.positions.append(more.positions.span());
  const std::size_t before = mesh.indices.size();
  mesh.indices.append(more.indices.span());
  std::uint32_t* indices = mesh.indices.mutable_data();
  for (std::size_t i = before; i < mesh.indices.size(); ++i) indices[i] += static_cast<std::uint32_t>(count);
  mesh.bounds.add(more.bounds);
}

}  // namespace gs::vrml
