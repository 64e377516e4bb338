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

constexpr float kUnitTolerance = 0.01f;  // tolerance of the squared length; files often give three or four digits
constexpr float kShortestSquare = 1e-24f;
constexpr std::size_t kStretch =
    4096;  // number of coordIndex entries that are read before the capacity is tested again

/// Returns the number of indices if all `entries` entries of a coordIndex belong to triangles, plus a margin.
[[nodiscard]] std::size_t expected_indices(std::size_t entries) {
  return entries / 4 * 3 + std::min(entries, kStretch) / 2 + 12;
}

[[nodiscard]] bool has_direction(const glm::vec3& v) {
  const float square = glm::dot(v, v);
  return square > kShortestSquare && square < std::numeric_limits<float>::infinity();
}

/// Appends indices and grows the array as needed.
class IndexWriter {
 public:
  explicit IndexWriter(std::size_t expected) { grow(expected); }

  void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    std::uint32_t* next = claim(3);
    next[0] = a;
    next[1] = b;
    next[2] = c;
    next_ = next + 3;
  }
  /// Returns memory for `count` indices, for loops that track the position themselves. Pass the end position to
  /// release().
  [[nodiscard]] std::uint32_t* claim(std::size_t count) {
    if (static_cast<std::size_t>(end_ - next_) < count) grow(static_cast<std::size_t>(next_ - begin_) + count);
    return next_;
  }
  void release(std::uint32_t* next) { next_ = next; }

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

/// Triangulator of faces.
class FaceCutter {
 public:
  FaceCutter(const FaceSet& faces, std::span<const std::int32_t> coord_index) : faces_(faces), index_(coord_index) {}

  /// Calls emit(i, j, k) for each triangle, with indices of `corners`.
  template <class Emit>
  void cut(std::span<const std::uint32_t> corners, const Emit& emit) {
    const auto count = static_cast<std::uint32_t>(corners.size());
    if (count == 3 || faces_.convex) {
      for (std::uint32_t i = 2; i < count; ++i) emit(0u, i - 1, i);
      return;
    }
    polygon_.resize(count);
    for (std::uint32_t i = 0; i < count; ++i) polygon_[i] = faces_.points[static_cast<std::size_t>(index_[corners[i]])];
    const std::span<const std::uint32_t> triangles = triangulator_.triangulate(polygon_);
    for (std::size_t i = 0; i < triangles.size(); i += 3) emit(triangles[i], triangles[i + 1], triangles[i + 2]);
  }

 private:
  const FaceSet& faces_;
  std::span<const std::int32_t> index_;
  std::vector<glm::vec3> polygon_;
  PolygonTriangulator triangulator_;
};

/// Builder of the mesh if every corner takes all attributes by its vertex. The mesh has the unchanged arrays, plus
/// indices.
class SharedBuilder {
 public:
  SharedBuilder(const FaceSet& faces, std::span<const std::int32_t> coord_index, const UsableVertices& vertices)
      : faces_(faces),
        index_(coord_index),
        vertices_(vertices),
        used_(faces.points.size(), 0),
        out_(expected_indices(coord_index.size())) {}

  [[nodiscard]] Mesh build() {
    FaceCutter cutter(faces_, index_);
    FaceReader reader(index_, vertices_, faces_.ccw);
    std::size_t next_look = 0;
    bool stopped = false;
    while (reader.position() < index_.size() && !stopped) {
      if (reader.position() >= next_look) {
        stopped = faces_.budget && faces_.budget->stopped();
        next_look = reader.position() + kStretch;
      }
      if (vertices_.all()) {
        std::size_t faces = 0;
        const std::size_t position = read_plain_faces(reader.position(), faces);
        reader.skip_to(position, faces);
        if (position >= index_.size()) break;
      }
      if (reader.read()) add(cutter, reader);
    }
    Mesh mesh;
    mesh.positions = faces_.points;
    mesh.normals = faces_.normal.values;
    mesh.colors = faces_.color.values;
    mesh.opacities = faces_.opacities;
    mesh.fog_depths = faces_.fog_depths;
    mesh.texture_coordinates = faces_.texture_coordinate.values;
    mesh.coordinate_sets = faces_.coordinate_sets;
    mesh.indices = out_.finish();
    mesh.bounds = bounds_of(faces_.points.span(), used_);
    mesh.limited = stopped;
    return mesh;
  }

 private:
  void add(FaceCutter& cutter, const FaceReader& reader) {
    const std::span<const std::uint32_t> corners = reader.corners();
    cutter.cut(corners, [&](std::uint32_t i, std::uint32_t j, std::uint32_t k) {
      const std::uint32_t a = reader.vertex(corners[i]), b = reader.vertex(corners[j]), c = reader.vertex(corners[k]);
      used_[a] = used_[b] = used_[c] = 1;
      out_.triangle(a, b, c);
    });
  }

  /// Reads triangles and convex quadrilaterals, which large meshes consist of. Stops at the first other or invalid face
  /// and returns its position.
  [[nodiscard]] std::size_t read_plain_faces(std::size_t position, std::size_t& faces);

  const FaceSet& faces_;
  std::span<const std::int32_t> index_;
  const UsableVertices& vertices_;
  std::vector<std::uint8_t> used_;
  IndexWriter out_;
};

std::size_t SharedBuilder::read_plain_faces(std::size_t position, std::size_t& faces) {
  const auto count = static_cast<std::uint32_t>(vertices_.count());
  const bool ccw = faces_.ccw, convex = faces_.convex;
  const std::int32_t* from = index_.data();
  const std::size_t size = index_.size();
  std::uint8_t* used = used_.data();
  std::size_t i = position, read = 0;
  for (bool plain = true; plain && i + 3 < size;) {
    std::uint32_t* out = out_.claim(std::min(kStretch, size - i) * 6 / 5 + 6);
    const std::size_t end = std::min(i + kStretch - 5, size - 3);
    while (i < end) {
      const auto a = static_cast<std::uint32_t>(from[i]), b = static_cast<std::uint32_t>(from[i + 1]),
                 c = static_cast<std::uint32_t>(from[i + 2]);
      plain = a < count && b < count && c < count && a != b && b != c && c != a;
      if (!plain) break;
      if (from[i + 3] < 0) {
        i += 4;
      } else {
        const auto d = static_cast<std::uint32_t>(from[i + 3]);
        plain = convex && i + 4 < size && from[i + 4] < 0 && d < count && d != a && d != b && d != c;
        if (!plain) break;
        used[d] = 1;
        out[0] = a;
        out[1] = ccw ? c : d;
        out[2] = ccw ? d : c;
        out += 3;
        i += 5;
      }
      used[a] = used[b] = used[c] = 1;
      out[0] = a;
      out[1] = ccw ? b : c;
      out[2] = ccw ? c : b;
      out += 3;
      ++read;
    }
    out_.release(out);
  }
  faces = read;
  return i;
}

/// Writer of vertices into the arrays of a mesh.
class VertexWriter {
 public:
  /// Reserves room for at most `count` vertices.
  VertexWriter(const FaceSet& faces, std::size_t count) : faces_(&faces) {
    position_ = mesh_.positions.prepare(count);
    normal_ = mesh_.normals.prepare(count);
    if (faces.color.binding != Binding::none) color_ = mesh_.colors.prepare(count);
    if (color_ && !faces.opacities.empty()) opacity_ = mesh_.opacities.prepare(count);
    if (!faces.fog_depths.empty()) fog_depth_ = mesh_.fog_depths.prepare(count);
    if (faces.texture_coordinate.binding != Binding::none) coordinate_ = mesh_.texture_coordinates.prepare(count);
    mesh_.coordinate_sets.resize(faces.coordinate_sets.size());
    for (CoordinateSet& set : mesh_.coordinate_sets) sets_.push_back(set.prepare(count));
  }

  std::uint32_t write(const VertexParts& parts, const glm::vec3& normal) {
    *position_ = faces_->points[parts.position];
    mesh_.bounds.add(*position_++);
    const float square = glm::dot(normal, normal);
    *normal_++ = std::abs(square - 1) < kUnitTolerance ? normal : normal / std::sqrt(square);
    if (color_) *color_++ = faces_->color.values[parts.color];
    if (opacity_) *opacity_++ = faces_->opacities[parts.color];
    if (fog_depth_) *fog_depth_++ = faces_->fog_depths[parts.position];
    if (coordinate_)
      *coordinate_++ = parts.texture_coordinate == kMissing
                           ? glm::vec2(0)
                           : faces_->texture_coordinate.values[parts.texture_coordinate];
    for (std::size_t i = 0; i < sets_.size(); ++i) {
      const CoordinateSet& from = faces_->coordinate_sets[i];
      *sets_[i]++ = parts.texture_coordinate < from.size() ? from[parts.texture_coordinate] : glm::vec4(0, 0, 0, 1);
    }
    return count_++;
  }

  [[nodiscard]] Mesh finish(Array<std::uint32_t> indices) {
    finish(mesh_.positions);
    finish(mesh_.normals);
    if (color_) finish(mesh_.colors);
    if (opacity_) finish(mesh_.opacities);
    if (fog_depth_) finish(mesh_.fog_depths);
    if (coordinate_) finish(mesh_.texture_coordinates);
    for (CoordinateSet& set : mesh_.coordinate_sets) finish(set);
    mesh_.indices = std::move(indices);
    return std::move(mesh_);
  }

 private:
  template <class T>
  void finish(Array<T>& values) const {
    values.commit(count_);
    values.shrink_to_fit();
  }

  const FaceSet* faces_;
  Mesh mesh_;
  glm::vec3 *position_ = nullptr, *normal_ = nullptr;
  Color* color_ = nullptr;
  float *opacity_ = nullptr, *fog_depth_ = nullptr;
  glm::vec2* coordinate_ = nullptr;
  std::vector<glm::vec4*> sets_;  // next element of each set
  std::uint32_t count_ = 0;
};

/// Builder of the mesh in all other cases. It makes one vertex per distinct corner.
class CornerBuilder {
 public:
  /// Set `own_normals` if no two vertices share a normal. The normal then identifies a corner better than the vertex.
  CornerBuilder(const FaceSet& faces, std::span<const std::int32_t> coord_index, const UsableVertices& vertices,
                bool own_normals)
      : faces_(faces),
        index_(coord_index),
        vertices_(vertices),
        own_normals_(own_normals),
        weld_(can_weld(faces)),
        welder_(!weld_        ? 0
                : own_normals ? faces.normal.values.size()
                              : faces.points.size()),
        writer_(faces, weld_ ? 1 : coord_index.size()),
        out_(expected_indices(coord_index.size())) {}

  [[nodiscard]] Mesh build() {
    FaceCutter cutter(faces_, index_);
    FaceReader reader(index_, vertices_, faces_.ccw);
    std::vector<std::uint32_t> made;
    std::size_t next_look = 0;
    bool stopped = false;
    while (!stopped && reader.next()) {
      if (reader.position() >= next_look) {
        stopped = faces_.budget && faces_.budget->stopped();
        next_look = reader.position() + kStretch;
      }
      const std::span<const std::uint32_t> corners = reader.corners();
      made.clear();
      face_normal_ = kMissing;
      if (!add_corners(reader, made)) continue;
      cutter.cut(corners,
                 [&](std::uint32_t i, std::uint32_t j, std::uint32_t k) { out_.triangle(made[i], made[j], made[k]); });
    }
    Array<std::uint32_t> indices = out_.finish();
    if (indices.empty()) return {};
    if (weld_) {
      writer_ = VertexWriter(faces_, welder_.vertices().size());
      for (const VertexParts& vertex : welder_.vertices()) writer_.write(vertex, normal_of(vertex));
    }
    Mesh mesh = writer_.finish(std::move(indices));
    mesh.limited = stopped;
    return mesh;
  }

 private:
  /// Returns false if every face has its own value of an attribute. Corners of different faces then always differ.
  [[nodiscard]] static bool can_weld(const FaceSet& faces) {
    return faces.normal.binding != Binding::none && faces.normal.binding != Binding::by_face &&
           faces.color.binding != Binding::by_face;
  }
  [[nodiscard]] bool add_corners(const FaceReader& reader, std::vector<std::uint32_t>& made);
  [[nodiscard]] bool set_normal(const FaceReader& reader, std::uint32_t corner, VertexParts& parts);
  [[nodiscard]] const glm::vec3& normal_of(const VertexParts& vertex) const {
    const std::size_t given = faces_.normal.values.size();
    return vertex.normal < given ? faces_.normal.values[vertex.normal] : face_normals_[vertex.normal - given];
  }

  const FaceSet& faces_;
  std::span<const std::int32_t> index_;
  const UsableVertices& vertices_;
  bool own_normals_;
  bool weld_;
  Welder welder_;
  VertexWriter writer_;
  IndexWriter out_;
  // Normals generated for faces with missing normals. Their indices follow those of the given normals. If vertices are
  // written at once, only the last normal is stored.
  std::vector<glm::vec3> face_normals_;
  std::uint32_t face_normal_ = kMissing;  // index of the current face's normal, if generated
  std::vector<glm::vec3> scratch_;
};

bool CornerBuilder::add_corners(const FaceReader& reader, std::vector<std::uint32_t>& made) {
  for (const std::uint32_t corner : reader.corners()) {
    VertexParts parts;
    parts.position = reader.vertex(corner);
    if (!set_normal(reader, corner, parts)) return false;
    parts.color = faces_.color.find_or_nearest(corner, parts.position, reader.face());
    parts.texture_coordinate = faces_.texture_coordinate.find(corner, parts.position, reader.face());
    made.push_back(weld_ ? welder_.add(parts, own_normals_ ? parts.normal : parts.position)
                         : writer_.write(parts, normal_of(parts)));
  }
  return true;
}

bool CornerBuilder::set_normal(const FaceReader& reader, std::uint32_t corner, VertexParts& parts) {
  const std::uint32_t given = faces_.normal.find(corner, parts.position, reader.face());
  if (given != kMissing && (own_normals_ || has_direction(faces_.normal.values[given]))) {
    parts.normal = given;
    return true;
  }
  if (face_normal_ == kMissing) {
    glm::vec3 normal = face_normal(reader.corners(), index_, faces_.points.span(), scratch_);
    if (normal == glm::vec3(0)) {
      if (faces_.normal.binding == Binding::none) return false;
      normal = {0, 0, 1};
    }
    if (!weld_) face_normals_.clear();
    face_normal_ = static_cast<std::uint32_t>(faces_.normal.values.size() + face_normals_.size());
    face_normals_.push_back(normal);
  }
  parts.normal = face_normal_;
  return true;
}

/// Copies the used coordinates if the node uses only a few of many.
void compact_points(FaceSet& faces) {
  const std::span<const std::int32_t> index = readable(faces.coord_index);
  if (!needs_compaction(faces.points.size(), index.size())) return;
  Compaction compaction = compact(index, faces.points.size());
  // Handles colours first, because the number of points determines the last colour.
  if (faces.color.binding == Binding::by_vertex) {
    faces.color.values = gather(faces.color.values, compaction.kept, faces.color.values.back());
    if (!faces.opacities.empty()) faces.opacities = gather(faces.opacities, compaction.kept, faces.opacities.back());
  }
  if (!faces.fog_depths.empty()) faces.fog_depths = gather(faces.fog_depths, compaction.kept, faces.fog_depths.back());
  if (faces.normal.binding == Binding::by_vertex)
    faces.normal.values = gather(faces.normal.values, compaction.kept, glm::vec3(0));
  if (faces.texture_coordinate.binding == Binding::by_vertex)
    faces.texture_coordinate.values = gather(faces.texture_coordinate.values, compaction.kept, glm::vec2(0));
  if (faces.texture_coordinate.binding == Binding::by_vertex)
    for (CoordinateSet& set : faces.coordinate_sets) set = gather(set, compaction.kept, glm::vec4(0, 0, 0, 1));
  faces.points = gather(faces.points, compaction.kept, glm::vec3(0));
  faces.coord_index = std::move(compaction.index);
}

/// Resizes by_vertex normals to the number of points and normalises them, without a copy if possible. Returns false if
/// a used normal is missing or has no direction.
[[nodiscard]] bool fit_normals(FaceSet& faces) {
  const std::size_t points = faces.points.size();
  if (faces.normal.values.size() < points) {
    std::int32_t largest = -1;
    for (const std::int32_t vertex : readable(faces.coord_index)) largest = std::max(largest, vertex);
    if (largest >= 0 && static_cast<std::size_t>(largest) >= faces.normal.values.size()) return false;
  }
  std::uint32_t other = 0;  // not bool, so that the loop vectorizes
  for (const glm::vec3& normal : faces.normal.values)
    other |= static_cast<std::uint32_t>(!(std::abs(glm::dot(normal, normal) - 1) < kUnitTolerance));
  const bool unit = other == 0;
  if (!unit && !std::all_of(faces.normal.values.begin(), faces.normal.values.end(), has_direction)) return false;
  faces.normal.fit(points, glm::vec3(0, 0, 1));
  if (unit) return true;
  glm::vec3* normal = faces.normal.values.mutable_data();
  for (std::size_t i = 0; i < points; ++i) normal[i] /= std::sqrt(glm::dot(normal[i], normal[i]));
  return true;
}

void fit_set(CoordinateSet& set, std::size_t count) {
  const std::size_t had = set.size();
  if (had == count) return;
  set.resize(count);
  glm::vec4* const all = set.mutable_data();
  for (std::size_t i = had; i < count; ++i) all[i] = glm::vec4(0, 0, 0, 1);
}

[[nodiscard]] bool by_vertex_or_none(Binding binding) {
  return binding == Binding::by_vertex || binding == Binding::none;
}

// Maximum bytes of each method, per entry of coordIndex and per point.
struct Cost {
  std::uint64_t entry, point;
};
constexpr Cost kSmoothing{24, 20}, kWelding{92, 24}, kSharing{12, 1}, kCompaction{40, 0};

[[nodiscard]] bool draw(Share& share, const FaceSet& faces, const Cost& cost) {
  return share.grow(faces.coord_index.size() * cost.entry + faces.points.size() * cost.point);
}

[[nodiscard]] Mesh limited_mesh() {
  Mesh mesh;
  mesh.limited = true;
  return mesh;
}

[[nodiscard]] Mesh make_triangles(FaceSet faces) {
  if (faces.coord_index.empty() || faces.points.empty()) return {};
  if (faces.texture_coordinate.binding == Binding::none) faces.coordinate_sets.clear();
  faces.normal.simplify(faces.coord_index.span());
  faces.color.simplify(faces.coord_index.span());
  faces.texture_coordinate.simplify(faces.coord_index.span());
  Share share(faces.budget, Resource::meshes);
  if (!draw(share, faces, kCompaction)) return limited_mesh();
  compact_points(faces);
  share.shrink_to(0);
  if (faces.points.empty()) return {};
  fit_values(faces.fog_depths, faces.points.size());
  const std::span<const std::int32_t> index = readable(faces.coord_index);
  const UsableVertices vertices(faces.points.span());
  const bool smooth = faces.normal.binding == Binding::none && faces.crease_angle > 0;
  if (smooth && !draw(share, faces, kSmoothing)) return limited_mesh();
  if (smooth) faces.normal = crease_normals(index, faces.points.span(), vertices, faces.ccw, faces.crease_angle);
  const bool shared = faces.normal.binding == Binding::by_vertex && by_vertex_or_none(faces.color.binding) &&
                      by_vertex_or_none(faces.texture_coordinate.binding) && fit_normals(faces);
  share.shrink_to(faces.normal.values.size() * sizeof(glm::vec3));
  if (!draw(share, faces, shared ? kSharing : kWelding)) return limited_mesh();
  if (!shared) return CornerBuilder(faces, index, vertices, smooth).build();
  if (faces.color.binding != Binding::none) faces.color.fit(faces.points.size(), faces.color.values.back());
  fit_values(faces.opacities, faces.points.size());
  if (faces.texture_coordinate.binding != Binding::none)
    faces.texture_coordinate.fit(faces.points.size(), glm::vec2(0));
  for (CoordinateSet& set : faces.coordinate_sets) fit_set(set, faces.points.size());
  return SharedBuilder(faces, index, vertices).build();
}

}  // namespace

Mesh make_mesh(FaceSet faces) {
  const bool solid = faces.solid, map_texture = faces.default_texture_coordinates;
  Mesh mesh = make_triangles(std::move(faces));
  if (mesh.indices.empty()) mesh = mesh.limited ? limited_mesh() : Mesh{};
  mesh.solid = solid;
  mesh.translucent = is_translucent(mesh.opacities.span());
  if (map_texture && !mesh.empty() && mesh.texture_coordinates.empty())
    mesh.texture_coordinates = default_texture_coordinates(mesh.positions.span(), mesh.bounds);
  return mesh;
}

}  // namespace gs::vrml
