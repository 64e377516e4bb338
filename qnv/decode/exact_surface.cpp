#include "qnv/decode/exact_surface.h"

#include "qnv/base/finite.h"
#include "qnv/decode/triangle_weights.h"
#include "qnv/displaced/surface.h"
#include "qnv/exact/exact_tail.h"

#include <glm/geometric.hpp>

#include <utility>

namespace gs::qnv {

using displaced::kNone;

void ExactSurface::add(std::span<const std::byte> payload, const Box& box, std::size_t most_vectors) {
  if (done_) return;
  if (!pieces_.add(payload)) {
    ++count_.refused;
    return;
  }
  if (auto tail = pieces_.take()) {
    tail_ = std::move(*tail);
    make(box, most_vectors);
  }
}

void ExactSurface::add_shading(std::span<const std::byte> payload, const Box& box, std::size_t most_vectors) {
  const auto shading = exact::decode_shading(payload);
  if (!shading || (shading_ && *shading_ != *shading)) {
    ++count_.refused;
    return;
  }
  if (shading_) return;
  shading_ = shading;
  if (whole_) make(box, most_vectors);
}

void ExactSurface::make(const Box& box, std::size_t most_vectors) {
  done_ = true;
  whole_ = false;
  count_.vectors = 0;
  const auto size = exact::tail_size(tail_);
  if (size && (size->vertices > most_vectors || size->triangles / 2 > most_vectors)) {
    count_.full = true;
    return;
  }
  const auto mesh = exact::decode_tail(tail_, most_vectors);
  if (!mesh) {
    ++count_.refused;
    return;
  }
  shade(*mesh, box);
  if (shading_) tail_ = {};
  if (positions_.size() > most_vectors) {
    count_.full = true;
    positions_ = normals_ = {};
    colors_ = {};
    triangles_ = {};
    return;
  }
  whole_ = true;
  bits_ = mesh->bits;
  count_.vectors = positions_.size();
  ++count_.taken;
}

void ExactSurface::shade(const exact::ExactMesh& mesh, const Box& box) {
  positions_ = normals_ = {};
  colors_ = {};
  triangles_.resize(3 * mesh.triangles.size());
  std::vector<glm::vec3> faces;
  faces.reserve(mesh.triangles.size());
  for (const displaced::Corners& t : mesh.triangles) {
    const glm::vec3 a(mesh.vertices[t[0]]);
    faces.push_back(glm::cross(glm::vec3(mesh.vertices[t[1]]) - a, glm::vec3(mesh.vertices[t[2]]) - a));
  }
  const exact::Shading own{exact::Shading::Rule::edges, mesh.crease_angle};
  const std::vector<glm::vec3> normals =
      exact::corner_normals({mesh.triangles, mesh.twins, faces, mesh.vertices.size()}, shading_ ? *shading_ : own);
  const displaced::Frame frame(box);
  const float step = frame.size / static_cast<float>((1 << mesh.bits) - 1);
  // Of each vertex the number that was given out last, and of each number the one before: most vertices have one.
  std::vector<std::uint32_t> last(mesh.vertices.size(), kNone), before;
  constexpr int kMostLooks = 16;
  for (std::uint32_t corner = 0; corner < triangles_.size(); ++corner) {
    const std::uint32_t v = mesh.triangles[corner / 3][corner % 3];
    std::uint32_t number = last[v];
    for (int looks = 0; number != kNone && normals_[number] != normals[corner];)
      number = ++looks < kMostLooks ? before[number] : kNone;
    if (number == kNone) {
      number = static_cast<std::uint32_t>(positions_.size());
      before.push_back(last[v]);
      last[v] = number;
      const glm::vec3 p = frame.lower + glm::vec3(mesh.vertices[v]) * step;
      positions_.push_back(finite(p) ? p : frame.lower);
      normals_.push_back(normals[corner]);
      if (!mesh.colors.empty()) colors_.push_back(mesh.colors[v]);
    }
    triangles_[corner] = number;
  }
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
