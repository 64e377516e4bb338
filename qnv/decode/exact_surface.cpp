#include "qnv/decode/exact_surface.h"

#include "qnv/base/finite.h"
#include "qnv/decode/triangle_weights.h"
#include "qnv/displaced/surface.h"
#include "qnv/exact/exact_tail.h"

#include <glm/geometric.hpp>

#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

namespace gs::qnv {
namespace {

using displaced::kNone;

/// Corners, numbered 3 t + k, that are shaded as one: those beside an edge that is no crease.
std::vector<std::uint32_t> shaded_together(const exact::ExactMesh& mesh, const std::vector<glm::vec3>& faces) {
  std::vector<std::uint32_t> sets(3 * mesh.triangles.size());
  std::iota(sets.begin(), sets.end(), 0u);
  const auto find = [&](std::uint32_t i) {
    while (sets[i] != i) i = sets[i] = sets[sets[i]];
    return i;
  };
  const auto next = [](std::uint32_t side) { return side % 3 == 2 ? side - 2 : side + 1; };
  const auto cosine = static_cast<float>(std::cos((mesh.crease_angle + 0.01) * std::numbers::pi / 180));
  const bool smooth = mesh.crease_angle >= 180;
  for (std::uint32_t side = 0; side < sets.size(); ++side) {
    const std::uint32_t twin = mesh.twins[side];
    if (twin == kNone || twin < side) continue;
    // What has no area has no direction, and is no crease.
    const glm::vec3 &n = faces[side / 3], &m = faces[twin / 3];
    const float lengths = glm::length(n) * glm::length(m);
    if (!smooth && lengths > 0 && glm::dot(n, m) < cosine * lengths) continue;
    sets[find(side)] = find(next(twin));
    sets[find(next(side))] = find(twin);
  }
  for (std::uint32_t i = 0; i < sets.size(); ++i) sets[i] = find(i);
  return sets;
}

}  // namespace

void ExactSurface::add(std::span<const std::byte> payload, const Box& box, std::size_t most_vectors) {
  if (done_) return;
  if (!pieces_.add(payload)) {
    ++count_.refused;
    return;
  }
  if (const auto tail = pieces_.take()) make(*tail, box, most_vectors);
}

void ExactSurface::make(std::span<const std::byte> tail, const Box& box, std::size_t most_vectors) {
  done_ = true;
  const auto size = exact::tail_size(tail);
  if (size && (size->vertices > most_vectors || size->triangles / 2 > most_vectors)) {
    count_.full = true;
    return;
  }
  const auto mesh = exact::decode_tail(tail, most_vectors);
  if (!mesh) {
    ++count_.refused;
    return;
  }
  std::vector<glm::vec3> faces;
  faces.reserve(mesh->triangles.size());
  for (const displaced::Corners& t : mesh->triangles) {
    const glm::vec3 a(mesh->vertices[t[0]]);
    faces.push_back(glm::cross(glm::vec3(mesh->vertices[t[1]]) - a, glm::vec3(mesh->vertices[t[2]]) - a));
  }
  const std::vector<std::uint32_t> sets = shaded_together(*mesh, faces);
  std::vector<std::uint32_t> numbers(sets.size(), kNone);
  const displaced::Frame frame(box);
  const float step = frame.size / static_cast<float>((1 << mesh->bits) - 1);
  triangles_.reserve(sets.size());
  for (std::uint32_t corner = 0; corner < sets.size(); ++corner) {
    std::uint32_t& number = numbers[sets[corner]];
    if (number == kNone) {
      const std::uint32_t v = mesh->triangles[corner / 3][corner % 3];
      number = static_cast<std::uint32_t>(positions_.size());
      const glm::vec3 p = frame.lower + glm::vec3(mesh->vertices[v]) * step;
      positions_.push_back(finite(p) ? p : frame.lower);
      normals_.emplace_back(0.0f);
      if (!mesh->colors.empty()) colors_.push_back(mesh->colors[v]);
    }
    normals_[number] += faces[corner / 3];
    triangles_.push_back(number);
  }
  if (positions_.size() > most_vectors) {
    count_.full = true;
    positions_ = normals_ = {};
    colors_ = {};
    triangles_ = {};
    return;
  }
  for (glm::vec3& n : normals_) {
    const float length = glm::length(n);
    n = length > 0 ? n / length : glm::vec3(0, 0, 1);
  }
  whole_ = true;
  bits_ = mesh->bits;
  count_.vectors = positions_.size();
  ++count_.taken;
}

void ExactSurface::append(Cloud& cloud, bool colored) const {
  const auto start = static_cast<std::uint32_t>(cloud.positions.size());
  const std::size_t first = cloud.triangles.size();
  cloud.positions.insert(cloud.positions.end(), positions_.begin(), positions_.end());
  cloud.normals.insert(cloud.normals.end(), normals_.begin(), normals_.end());
  if (colored && colors_.empty()) cloud.colors.resize(cloud.positions.size(), cloud.color);
  if (colored) cloud.colors.insert(cloud.colors.end(), colors_.begin(), colors_.end());
  cloud.triangles.reserve(first + triangles_.size());
  for (const std::uint32_t corner : triangles_) cloud.triangles.push_back(start + corner);
  weigh_by_triangles(cloud, start, first);
}

}  // namespace gs::qnv
