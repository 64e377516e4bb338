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

constexpr std::size_t kMostPairs = 256;  // faces around a vertex that are compared one by one
constexpr int kGroupsAcross = 16;        // directions are grouped on a map of the sphere of 16 x 16

/// A face of no area has weight 0 and no say.
struct FaceNormal {
  glm::vec3 unit{0};
  float weight = 0;
};

struct FaceCorner {
  std::uint32_t corner;  // place in coordIndex
  std::uint32_t face;    // place in the list of FaceNormals
};

/// Area vector of the face; where that vanishes (it crosses itself or turns back) that of its largest triangle.
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

/// The unit vector along `v`; `other` where v has no direction.
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
    sort_corners();
    values_.resize(points_.size());
    std::fill_n(values_.mutable_data(), points_.size(), glm::vec3(0, 0, 1));
    for (std::size_t vertex = 0; vertex < points_.size(); ++vertex) {
      const std::span<const FaceCorner> around(corners_.data() + ends_[vertex], ends_[vertex + 1] - ends_[vertex]);
      if (!around.empty()) smooth(static_cast<std::uint32_t>(vertex), around);
    }
    return {std::move(values_), true, std::move(index_)};
  }

 private:
  void read_faces(const UsableVertices& vertices, bool ccw);
  void sort_corners();
  void smooth(std::uint32_t vertex, std::span<const FaceCorner> around);
  [[nodiscard]] bool smooth_all(std::uint32_t vertex);
  void smooth_pairs(std::uint32_t vertex, std::span<const FaceCorner> around);
  void smooth_groups(std::uint32_t vertex, std::span<const FaceCorner> around);
  [[nodiscard]] std::uint32_t add(std::uint32_t vertex, const glm::vec3& normal);
  void use(std::uint32_t corner, std::uint32_t value);

  std::span<const std::int32_t> coord_index_;
  std::span<const glm::vec3> points_;
  bool everything_ = false;
  float cosine_ = 1, half_cosine_ = 1;

  std::vector<FaceNormal> faces_;
  std::vector<FaceCorner> unsorted_;   // in the order of the faces
  std::vector<FaceCorner> corners_;    // in the order of the vertices
  std::vector<std::uint32_t> ends_;    // those of vertex v are [ends_[v], ends_[v + 1])
  std::vector<FaceNormal> near_;       // the faces around the vertex at hand
  std::vector<std::uint32_t> own_;     // values made for it
  Array<glm::vec3> values_;
  MFInt32 index_;
};

void CreaseSmoother::read_faces(const UsableVertices& vertices, bool ccw) {
  Bounds bounds;
  for (std::size_t i = 0; i < points_.size(); ++i)
    if (vertices.all() || vertices.contains(static_cast<std::uint32_t>(i))) bounds.add(points_[i]);
  const glm::dvec3 size = bounds.empty() ? glm::dvec3(1) : glm::dvec3(bounds.upper) - glm::dvec3(bounds.lower);
  const double largest = std::max({size.x, size.y, size.z});
  const double scale = largest > 0 ? 1 / (largest * largest) : 1;

  ends_.assign(points_.size() + 1, 0);
  faces_.reserve(coord_index_.size() / 4 + 1);
  unsorted_.reserve(coord_index_.size());
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
    for (const std::uint32_t corner : reader.corners()) {
      unsorted_.push_back({corner, static_cast<std::uint32_t>(faces_.size())});
      ++ends_[reader.vertex(corner) + 1];
    }
    faces_.push_back(face);
  }
}

void CreaseSmoother::sort_corners() {
  for (std::size_t i = 1; i < ends_.size(); ++i) ends_[i] += ends_[i - 1];
  corners_.resize(unsorted_.size());
  std::vector<std::uint32_t> next(ends_.begin(), ends_.end() - 1);
  for (const FaceCorner& corner : unsorted_)
    corners_[next[static_cast<std::size_t>(coord_index_[corner.corner])]++] = corner;
  unsorted_ = {};
}

/// The first value of a vertex has the vertex's own place.
std::uint32_t CreaseSmoother::add(std::uint32_t vertex, const glm::vec3& normal) {
  std::uint32_t place = vertex;
  if (own_.empty()) {
    values_.mutable_data()[vertex] = normal;
  } else {
    place = static_cast<std::uint32_t>(values_.size());
    values_.push_back(normal);
  }
  own_.push_back(place);
  return place;
}

void CreaseSmoother::use(std::uint32_t corner, std::uint32_t value) {
  if (value == static_cast<std::uint32_t>(coord_index_[corner])) return;
  if (index_.empty()) index_ = MFInt32(coord_index_);
  index_.mutable_data()[corner] = static_cast<std::int32_t>(value);
}

void CreaseSmoother::smooth(std::uint32_t vertex, std::span<const FaceCorner> around) {
  own_.clear();
  near_.clear();
  for (const FaceCorner& corner : around) near_.push_back(faces_[corner.face]);
  if (smooth_all(vertex)) return;
  if (around.size() <= kMostPairs)
    smooth_pairs(vertex, around);
  else
    smooth_groups(vertex, around);
}

/// The usual case: all faces lie within half the crease angle of their mean, so any two are within the whole.
bool CreaseSmoother::smooth_all(std::uint32_t vertex) {
  glm::vec3 sum(0);
  for (const FaceNormal& face : near_) sum += face.unit * face.weight;
  const glm::vec3 mean = unit_or(sum, glm::vec3(0));
  if (mean == glm::vec3(0)) return false;
  if (!everything_)
    for (const FaceNormal& face : near_)
      if (face.weight > 0 && !(glm::dot(face.unit, mean) > half_cosine_)) return false;
  (void)add(vertex, mean);
  return true;
}

void CreaseSmoother::smooth_pairs(std::uint32_t vertex, std::span<const FaceCorner> around) {
  for (std::size_t i = 0; i < around.size(); ++i) {
    const FaceNormal& own = near_[i];
    glm::vec3 sum = own.unit * own.weight;
    for (std::size_t j = 0; j < around.size(); ++j)
      if (j != i && (everything_ || glm::dot(own.unit, near_[j].unit) > cosine_)) sum += near_[j].unit * near_[j].weight;
    // Faces that take the same others come to nearly the same sum, but for its order: one value for them.
    const glm::vec3 normal = unit_or(sum, own.weight > 0 ? own.unit : glm::vec3(0, 0, 1));
    const auto same = [&](std::uint32_t place) {
      const glm::vec3 difference = values_[place] - normal;
      return glm::dot(difference, difference) < 1e-11f;
    };
    const auto found = std::find_if(own_.begin(), own_.end(), same);
    use(around[i].corner, found != own_.end() ? *found : add(vertex, normal));
  }
}

/// Where the octahedron map of the sphere puts a direction.
[[nodiscard]] std::size_t group_of(const glm::vec3& unit) {
  const float sum = std::abs(unit.x) + std::abs(unit.y) + std::abs(unit.z);
  if (!(sum > 0)) return 0;
  float u = unit.x / sum, v = unit.y / sum;
  if (unit.z < 0) {
    const float folded = (1 - std::abs(v)) * (u < 0 ? -1.0f : 1.0f);
    v = (1 - std::abs(u)) * (v < 0 ? -1.0f : 1.0f);
    u = folded;
  }
  const auto cell = [](float x) { return std::clamp(static_cast<int>((x + 1) * (kGroupsAcross / 2)), 0, kGroupsAcross - 1); };
  return static_cast<std::size_t>(cell(v) * kGroupsAcross + cell(u));
}

void CreaseSmoother::smooth_groups(std::uint32_t vertex, std::span<const FaceCorner> around) {
  std::array<glm::vec3, kGroupsAcross * kGroupsAcross> sums{}, units{};
  std::array<std::uint32_t, kGroupsAcross * kGroupsAcross> values{};
  for (const FaceNormal& face : near_) sums[group_of(face.unit)] += face.unit * face.weight;
  for (std::size_t i = 0; i < sums.size(); ++i) units[i] = unit_or(sums[i], glm::vec3(0));
  for (std::size_t i = 0; i < sums.size(); ++i) {
    if (units[i] == glm::vec3(0)) continue;
    glm::vec3 sum = sums[i];
    for (std::size_t j = 0; j < sums.size(); ++j)
      if (j != i && glm::dot(units[i], units[j]) > cosine_) sum += sums[j];
    values[i] = add(vertex, unit_or(sum, units[i]));
  }
  for (std::size_t i = 0; i < around.size(); ++i) {
    const std::size_t group = group_of(near_[i].unit);
    use(around[i].corner, units[group] == glm::vec3(0) ? vertex : values[group]);
  }
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
