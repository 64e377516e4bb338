#include "vrml/mesh/corner_normals.h"

#include "vrml/mesh/face_reader.h"
#include "vrml/mesh/polygon.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace gs::vrml {
namespace {

constexpr std::size_t kMaxPairs = 256;  // maximum number of faces around a vertex for pairwise comparison
constexpr std::size_t kMaxSearched = 32;  // maximum number of values that a new one is compared with
constexpr glm::vec3 kNoNormal{0, 0, 1};  // used if a face and its vertex have no direction
constexpr int kGroupsAcross = 16;  // groups directions in 16 x 16 cells of an octahedral map

/// Normal of a face, weighted by its area. A face without area has the weight 0.
struct FaceNormal {
  glm::vec3 unit{0};
  float weight = 0;
};

/// Faces around the current vertex, in one array per component for vector loops.
struct Neighbours {
  std::vector<float> x, y, z, weight, chosen;

  void resize(std::size_t count) {
    if (x.size() >= count) return;
    for (std::vector<float>* values : {&x, &y, &z, &weight, &chosen}) values->resize(2 * count);
  }
  void set(std::size_t i, const FaceNormal& face) {
    x[i] = face.unit.x;
    y[i] = face.unit.y;
    z[i] = face.unit.z;
    weight[i] = face.weight;
  }
  [[nodiscard]] glm::vec3 unit(std::size_t i) const { return {x[i], y[i], z[i]}; }

  /// Returns the weighted sum of the normals near the normal with index `own`, among the first `count`. Near means a
  /// cosine above `cosine`; `own` is always included. Branch-free, because the selection is hard to predict.
  [[nodiscard]] glm::vec3 sum_near(std::size_t own, std::size_t count, float cosine) {
    const glm::vec3 axis = unit(own);
    for (std::size_t i = 0; i < count; ++i)
      chosen[i] = axis.x * x[i] + axis.y * y[i] + axis.z * z[i] > cosine ? weight[i] : 0.0f;
    chosen[own] = weight[own];
    glm::vec3 sum(0);
    for (std::size_t i = 0; i < count; ++i) sum += glm::vec3(x[i], y[i], z[i]) * chosen[i];
    return sum;
  }
};

struct FaceCorner {
  std::uint32_t corner;  // position in coordIndex
  std::uint32_t face;    // index in the list of FaceNormals
};

/// Returns the area vector of a face. If the vector is zero because the face crosses itself or is folded, returns the
/// area vector of the face's largest triangle.
[[nodiscard]] glm::dvec3 area_vector(std::span<const glm::vec3> polygon) {
  const glm::dvec3 sum = newell_vector(polygon);
  if (glm::dot(sum, sum) > 0 || polygon.size() == 3) return sum;
  glm::dvec3 largest(0);
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    const glm::vec3 triangle[] = {polygon[0], polygon[i - 1], polygon[i]};
    const glm::dvec3 area = newell_vector(triangle);
    if (glm::dot(area, area) > glm::dot(largest, largest)) largest = area;
  }
  return largest;
}

[[nodiscard]] glm::dvec3 area_vector(std::span<const std::uint32_t> corners, std::span<const std::int32_t> coord_index,
                                     std::span<const glm::vec3> points, std::vector<glm::vec3>& scratch) {
  const auto point = [&](std::size_t i) -> const glm::vec3& {
    return points[static_cast<std::size_t>(coord_index[corners[i]])];
  };
  if (corners.size() == 3) {
    const glm::dvec3 origin(point(0));
    return glm::cross(glm::dvec3(point(1)) - origin, glm::dvec3(point(2)) - origin);
  }
  scratch.resize(corners.size());
  for (std::size_t i = 0; i < corners.size(); ++i) scratch[i] = point(i);
  return area_vector(scratch);
}

/// Returns the unit vector in the direction of `v`; `other` if `v` has no direction.
[[nodiscard]] glm::vec3 unit_or(const glm::vec3& v, const glm::vec3& other) {
  const float square = glm::dot(v, v);
  return square > 1e-30f && std::isfinite(square) ? v / std::sqrt(square) : other;
}

class CreaseSmoother {
 public:
  CreaseSmoother(std::span<const std::int32_t> coord_index, std::span<const glm::vec3> points, float crease_angle)
      : coord_index_(coord_index), points_(points) {
    const double angle = std::min(static_cast<double>(crease_angle), std::numbers::pi);
    everything_ = crease_angle >= static_cast<float>(std::numbers::pi);
    cosine_ = static_cast<float>(std::cos(angle));
    half_cosine_ = static_cast<float>(std::cos(angle / 2)) + 1e-6f;
  }

  [[nodiscard]] Attribute<glm::vec3> run(const UsableVertices& vertices, bool ccw) {
    read_faces(vertices, ccw);
    sort_corners(vertices, ccw);
    first_ = values_.prepare(points_.size());
    values_.commit(points_.size());
    std::fill_n(first_, points_.size(), kNoNormal);
    for (std::size_t vertex = 0; vertex < points_.size(); ++vertex) {
      const std::span<const FaceCorner> around(corners_.data() + ends_[vertex], ends_[vertex + 1] - ends_[vertex]);
      if (!around.empty()) smooth(static_cast<std::uint32_t>(vertex), around);
    }
    values_.append(more_);
    return {std::move(values_), true, std::move(index_)};
  }

 private:
  struct Value {
    glm::vec3 normal;
    std::uint32_t place;
  };

  void read_faces(const UsableVertices& vertices, bool ccw);
  void sort_corners(const UsableVertices& vertices, bool ccw);
  void smooth(std::uint32_t vertex, std::span<const FaceCorner> around);
  [[nodiscard]] bool smooth_all(std::uint32_t vertex, std::span<const FaceCorner> around);
  void smooth_pairs(std::uint32_t vertex, std::span<const FaceCorner> around);
  void smooth_groups(std::uint32_t vertex, std::span<const FaceCorner> around);
  [[nodiscard]] std::uint32_t find_or_add(std::uint32_t vertex, const glm::vec3& normal);
  [[nodiscard]] std::uint32_t add(std::uint32_t vertex, const glm::vec3& normal);
  void use(std::uint32_t corner, std::uint32_t value);

  std::span<const std::int32_t> coord_index_;
  std::span<const glm::vec3> points_;
  bool everything_ = false;
  float cosine_ = 1, half_cosine_ = 1;

  std::vector<FaceNormal> faces_;
  std::vector<FaceCorner> corners_;  // sorted by vertex
  std::vector<std::uint32_t> ends_;  // the corners of vertex v are ends_[v] to ends_[v + 1], excluded
  Neighbours near_;
  std::vector<Value> own_;  // values that were made for the current vertex
  Array<glm::vec3> values_;  // first value of each vertex
  glm::vec3* first_ = nullptr;  // pointer into values_
  std::vector<glm::vec3> more_;  // further values, which are appended at the end
  MFInt32 index_;
};

void CreaseSmoother::read_faces(const UsableVertices& vertices, bool ccw) {
  Box bounds;
  for (std::size_t i = 0; i < points_.size(); ++i)
    if (vertices.all() || vertices.contains(static_cast<std::uint32_t>(i))) bounds.add(points_[i]);
  const glm::dvec3 size = bounds.empty() ? glm::dvec3(1) : glm::dvec3(bounds.upper) - glm::dvec3(bounds.lower);
  const double largest = std::max({size.x, size.y, size.z});
  const double scale = largest > 0 ? 1 / (largest * largest) : 1;

  ends_.assign(points_.size() + 1, 0);
  faces_.reserve(coord_index_.size() / 4 + 1);
  std::vector<glm::vec3> scratch;
  FaceReader reader(coord_index_, vertices, ccw);
  while (reader.next()) {
    const glm::dvec3 area = area_vector(reader.corners(), coord_index_, points_, scratch);
    const double length = glm::length(area);
    FaceNormal face;
    if (length > 0) {
      face.unit = glm::vec3(area / length);
      face.weight = static_cast<float>(std::clamp(length * scale, 1e-12, 1e12));
    }
    for (const std::uint32_t corner : reader.corners()) ++ends_[reader.vertex(corner) + 1];
    faces_.push_back(face);
  }
}

/// Sorts the corners by vertex. Reads the faces a second time, which is cheaper than storing their corners.
void CreaseSmoother::sort_corners(const UsableVertices& vertices, bool ccw) {
  for (std::size_t i = 1; i < ends_.size(); ++i) ends_[i] += ends_[i - 1];
  corners_.resize(ends_.back());
  std::vector<std::uint32_t> next(ends_.begin(), ends_.end() - 1);
  FaceReader reader(coord_index_, vertices, ccw);
  for (std::uint32_t face = 0; reader.next(); ++face)
    for (const std::uint32_t corner : reader.corners()) corners_[next[reader.vertex(corner)]++] = {corner, face};
}

std::uint32_t CreaseSmoother::add(std::uint32_t vertex, const glm::vec3& normal) {
  std::uint32_t place = vertex;
  if (own_.empty()) {
    first_[vertex] = normal;
  } else {
    place = static_cast<std::uint32_t>(points_.size() + more_.size());
    more_.push_back(normal);
  }
  own_.push_back({normal, place});
  return place;
}

void CreaseSmoother::use(std::uint32_t corner, std::uint32_t value) {
  if (value == static_cast<std::uint32_t>(coord_index_[corner])) return;
  if (index_.empty()) index_ = MFInt32(coord_index_);
  index_.mutable_data()[corner] = static_cast<std::int32_t>(value);
}

void CreaseSmoother::smooth(std::uint32_t vertex, std::span<const FaceCorner> around) {
  own_.clear();
  if (smooth_all(vertex, around)) return;
  near_.resize(around.size());
  for (std::size_t i = 0; i < around.size(); ++i) near_.set(i, faces_[around[i].face]);
  if (around.size() <= kMaxPairs)
    smooth_pairs(vertex, around);
  else
    smooth_groups(vertex, around);
}

/// Handles the usual case: the normals of all faces are within half the crease angle of their mean. Then any two
/// normals are within the crease angle.
bool CreaseSmoother::smooth_all(std::uint32_t vertex, std::span<const FaceCorner> around) {
  glm::vec3 sum(0);
  for (const FaceCorner& corner : around) sum += faces_[corner.face].unit * faces_[corner.face].weight;
  const glm::vec3 mean = unit_or(sum, glm::vec3(0));
  if (mean == glm::vec3(0)) return false;
  if (!everything_)
    for (const FaceCorner& corner : around) {
      const FaceNormal& face = faces_[corner.face];
      if (face.weight > 0 && !(glm::dot(face.unit, mean) > half_cosine_)) return false;
    }
  (void)add(vertex, mean);
  return true;
}

void CreaseSmoother::smooth_pairs(std::uint32_t vertex, std::span<const FaceCorner> around) {
  for (std::size_t i = 0; i < around.size(); ++i) {
    const glm::vec3 own = near_.unit(i);
    const glm::vec3 normal = unit_or(near_.sum_near(i, around.size(), cosine_), near_.weight[i] > 0 ? own : kNoNormal);
    use(around[i].corner, find_or_add(vertex, normal));
  }
}

/// Returns the index of an equal value, or adds the value. Faces with the same neighbours get equal sums.
std::uint32_t CreaseSmoother::find_or_add(std::uint32_t vertex, const glm::vec3& normal) {
  const std::size_t start = own_.size() > kMaxSearched ? own_.size() - kMaxSearched : 0;
  for (std::size_t i = start; i < own_.size(); ++i) {
    const glm::vec3 difference = own_[i].normal - normal;
    if (glm::dot(difference, difference) < 1e-11f) return own_[i].place;
  }
  return add(vertex, normal);
}

/// Returns the index of a direction's cell on the octahedral map.
[[nodiscard]] std::size_t group_of(const glm::vec3& unit) {
  const float sum = std::abs(unit.x) + std::abs(unit.y) + std::abs(unit.z);
  if (!(sum > 0)) return 0;
  float u = unit.x / sum, v = unit.y / sum;
  if (unit.z < 0) {
    const float folded = (1 - std::abs(v)) * (u < 0 ? -1.0f : 1.0f);
    v = (1 - std::abs(u)) * (v < 0 ? -1.0f : 1.0f);
    u = folded;
  }
  const auto cell = [](float x) {
    return std::clamp(static_cast<int>((x + 1) * (kGroupsAcross / 2)), 0, kGroupsAcross - 1);
  };
  return static_cast<std::size_t>(cell(v) * kGroupsAcross + cell(u));
}

void CreaseSmoother::smooth_groups(std::uint32_t vertex, std::span<const FaceCorner> around) {
  constexpr std::size_t kGroups = kGroupsAcross * kGroupsAcross;
  std::array<glm::vec3, kGroups> sums{};
  for (std::size_t i = 0; i < around.size(); ++i) {
    const FaceNormal& face = faces_[around[i].face];
    sums[group_of(face.unit)] += face.unit * face.weight;
  }
  std::array<std::size_t, kGroups> groups{};  // indices of the groups that are not empty
  std::size_t count = 0;
  for (std::size_t i = 0; i < kGroups; ++i) {
    const float length = glm::length(sums[i]);
    if (!(length > 0)) continue;
    near_.set(count, {sums[i] / length, length});  // always fits, because there are more faces than groups
    groups[count++] = i;
  }
  std::array<std::uint32_t, kGroups> values{};
  values.fill(vertex);
  for (std::size_t i = 0; i < count; ++i)
    values[groups[i]] = find_or_add(vertex, unit_or(near_.sum_near(i, count, cosine_), near_.unit(i)));
  for (const FaceCorner& corner : around) use(corner.corner, values[group_of(faces_[corner.face].unit)]);
}

}  // namespace

glm::vec3 face_normal(std::span<const std::uint32_t> corners, std::span<const std::int32_t> coord_index,
                      std::span<const glm::vec3> points, std::vector<glm::vec3>& scratch) {
  const glm::dvec3 area = area_vector(corners, coord_index, points, scratch);
  const double length = glm::length(area);
  return length > 0 ? glm::vec3(area / length) : glm::vec3(0);
}

Attribute<glm::vec3> crease_normals(std::span<const std::int32_t> coord_index, std::span<const glm::vec3> points,
                                    const UsableVertices& vertices, bool ccw, float crease_angle) {
  return CreaseSmoother(coord_index, points, crease_angle).run(vertices, ccw);
}

}  // namespace gs::vrml
