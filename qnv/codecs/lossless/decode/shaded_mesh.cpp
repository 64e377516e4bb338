#include "qnv/codecs/lossless/decode/shaded_mesh.h"

#include "base/finite.h"
#include "qnv/codecs/displaced/surface.h"
#include "qnv/codecs/lossless/shading.h"
#include "qnv/mesh/triangle_weights.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <vector>

namespace gs::qnv {

using displaced::kNone;

IndexedMesh shaded_mesh(const exact::ExactMesh& mesh, std::span<const glm::vec3> normals, const Box& box) {
  IndexedMesh out;
  out.triangles.resize(3 * mesh.triangles.size());
  const displaced::Frame frame(box);
  const float step = frame.size / static_cast<float>((1 << mesh.bits) - 1);
  // Linked lists of the output vertices of each mesh vertex. `last` is the newest one; `before` leads to the previous
  // one. Most mesh vertices have one output vertex.
  std::vector<std::uint32_t> last(mesh.vertices.size(), kNone), before;
  std::vector<glm::ivec2> coordinates;  // texture coordinates of the output vertices
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

void append_mesh(const IndexedMesh& part, IndexedMesh& mesh, bool with_colors) {
  const auto start = static_cast<std::uint32_t>(mesh.size());
  const std::size_t first = mesh.triangles.size();
  const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  append(mesh.positions, part.positions);
  append(mesh.normals, part.normals);
  if (with_colors && part.colors.empty()) mesh.colors.resize(mesh.size(), mesh.color);
  if (with_colors) append(mesh.colors, part.colors);
  append(mesh.texture_coordinates, part.texture_coordinates);
  mesh.triangles.reserve(first + part.triangles.size());
  for (const std::uint32_t corner : part.triangles) mesh.triangles.push_back(start + corner);
  weigh_by_triangles(mesh, start, first);
}

}  // namespace gs::qnv
