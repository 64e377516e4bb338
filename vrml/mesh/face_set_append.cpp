#include "vrml/mesh/face_set.h"

#include <algorithm>
#include <utility>

// Joins meshes.
namespace gs::vrml {
namespace {

template <class T>
void append_values(Array<T>& values, std::size_t count, const Array<T>& more, std::size_t more_count,
                   const T& filling) {
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
  mesh.limited = mesh.limited || more.limited;
  if (more.empty()) return;
  const std::size_t count = mesh.positions.size(), more_count = more.positions.size();
  append_values(mesh.normals, count, more.normals, more_count, glm::vec3(0));
  append_values(mesh.colors, count, more.colors, more_count, Color{1, 1, 1});
  append_values(mesh.opacities, count, more.opacities, more_count, 1.0f);
  append_values(mesh.fog_depths, count, more.fog_depths, more_count, 0.0f);
  mesh.translucent = mesh.translucent || more.translucent;
  append_values(mesh.texture_coordinates, count, more.texture_coordinates, more_count, glm::vec2(0));
  mesh.coordinate_sets.resize(std::max(mesh.coordinate_sets.size(), more.coordinate_sets.size()));
  for (std::size_t i = 0; i < mesh.coordinate_sets.size(); ++i)
    append_values(mesh.coordinate_sets[i], count,
                  i < more.coordinate_sets.size() ? more.coordinate_sets[i] : CoordinateSet{}, more_count,
                  glm::vec4(0, 0, 0, 1));
  mesh.positions.append(more.positions.span());
  const std::size_t before = mesh.indices.size();
  mesh.indices.append(more.indices.span());
  std::uint32_t* indices = mesh.indices.mutable_data();
  for (std::size_t i = before; i < mesh.indices.size(); ++i) indices[i] += static_cast<std::uint32_t>(count);
  mesh.bounds.add(more.bounds);
}

}  // namespace gs::vrml
