#include "qnv/codecs/lossless/decode/shaded_mesh.h"

#include "base/finite.h"
#include "qnv/codecs/displaced/surface.h"
#include "qnv/codecs/lossless/shading.h"
#include "qnv/mesh/triangle_weights.h"

#include <glm/geometric.hpp>

namespace gs::qnv {

using displaced::kNone;

ShadedVertices shaded_vertices(const exact::ExactMesh& mesh, std::span<const glm::vec3> normals, const Box& box) {
  ShadedVertices out;
  out.triangles.resize(3 * mesh.triangles.size());
  const displaced::Frame frame(box);
  const float step = frame.size / static_cast<float>((1 << mesh.bits) - 1);
  // Linked list of the output vertices of each mesh vertex: `last` has the newest, `before` the previous one. Most have
  // one.
  std::vector<std::uint32_t> last(mesh.vertices.size(), kNone), before;
  std::vector<glm::ivec2> coordinates;  // of output vertices
  const bool textured = !mesh.coordinates.empty();
  constexpr int kMaxLooks = 16;
  for (std::uint32_t corner = 0; corner < out.triangles.size(); ++corner) {
    const std::uint32_t v = mesh.triangles[corner / 3][corner % 3];
    std::uint32_t number = last[v];
    const glm::ivec2 q = textured ? mesh.coordinates[corner / 3][corner % 3] : glm::ivec2(0);
    for (int looks = 0;
         number != kNone && (out.normals[number] != normals[corner] || (textured && coordinates[number] != q));)
      number = ++looks < kMaxLooks ? before[number] : kNone;
    if (number == kNone) {
      number = static_cast<std::uint32_t>(out.positions.size());
      before.push_back(last[v]);
      last[v] = number;
      const glm::vec3 p = frame.lower + glm::vec3(mesh.vertices[v]) * step;
      out.positions.push_back(finite(p) ? p : frame.lower);
      out.normals.push_back(normals[corner]);
      if (!mesh.colors.empty()) out.colors.push_back(mesh.colors[v]);
      if (textured) coordinates.push_back(q);
    }
    out.triangles[corner] = number;
  }
  for (const glm::ivec2& q : coordinates) out.texture_coordinates.push_back(mesh.texture.at(q));
  return out;
}

void ShadedVertices::append(Cloud& cloud, bool with_colors) const {
  const auto start = static_cast<std::uint32_t>(cloud.positions.size());
  const std::size_t first = cloud.triangles.size();
  cloud.positions.insert(cloud.positions.end(), positions.begin(), positions.end());
  cloud.normals.insert(cloud.normals.end(), normals.begin(), normals.end());
  if (with_colors && colors.empty()) cloud.colors.resize(cloud.positions.size(), cloud.color);
  if (with_colors) cloud.colors.insert(cloud.colors.end(), colors.begin(), colors.end());
  cloud.texture_coordinates.insert(cloud.texture_coordinates.end(), texture_coordinates.begin(),
                                   texture_coordinates.end());
  cloud.triangles.reserve(first + triangles.size());
  for (const std::uint32_t corner : triangles) cloud.triangles.push_back(start + corner);
  weigh_by_triangles(cloud, start, first);
}

}  // namespace gs::qnv
