#include "app/encode/mesh_joiner.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

namespace gs::app {
namespace {

// Returns the bits of a number. Both zeros have the same bits.
std::uint32_t bits_of(float number) { return std::bit_cast<std::uint32_t>(number + 0.0f); }

}  // namespace

std::size_t MeshJoiner::Hash::operator()(const Corner& corner) const {
  std::uint64_t hash = 0;
  for (const std::uint32_t part : corner) hash = (hash ^ part) * 0x9e3779b97f4a7c15u + (hash >> 29);
  return static_cast<std::size_t>(hash ^ (hash >> 32));
}

void MeshJoiner::add(const qnv::Triangle& triangle, const std::optional<std::array<glm::vec2, 3>>& at) {
  const auto& [a, b, c] = triangle.positions;
  const glm::dvec3 across = glm::cross(glm::dvec3(b) - glm::dvec3(a), glm::dvec3(c) - glm::dvec3(a));
  const double length = glm::length(across);
  if (!(length > 0) || !std::isfinite(length)) return;
  const auto area = static_cast<float>(length / 2);
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::vec3 position = triangle.positions[k];
    const glm::vec3 normal = triangle.normals[k] == glm::vec3(0) ? glm::vec3(across / length) : triangle.normals[k];
    const qnv::Rgb8 color = triangle.colors[k];
    const glm::vec2 place = at ? (*at)[k] : glm::vec2(0);
    const Corner corner{bits_of(position.x),
                        bits_of(position.y),
                        bits_of(position.z),
                        bits_of(normal.x),
                        bits_of(normal.y),
                        bits_of(normal.z),
                        std::uint32_t{color.r} << 16 | std::uint32_t{color.g} << 8 | color.b,
                        bits_of(place.x),
                        bits_of(place.y)};
    const auto [known, is_new] = vertices_.try_emplace(corner, static_cast<std::uint32_t>(mesh_.size()));
    if (is_new) {
      mesh_.positions.push_back(position);
      mesh_.normals.push_back(normal);
      mesh_.weights.push_back(0);
      mesh_.colors.push_back(color);
      if (at) mesh_.texture_coordinates.push_back(place);
      mesh_.description.box.add(position);
    }
    mesh_.weights[known->second] += area / 3;
    mesh_.triangles.push_back(known->second);
  }
  mesh_.description.total += length / 2;
}

qnv::IndexedMesh MeshJoiner::take() {
  vertices_.clear();
  std::vector<qnv::Rgb8>& colors = mesh_.colors;
  if (!colors.empty() &&
      std::all_of(colors.begin(), colors.end(), [&](const auto& c) { return c == colors.front(); })) {
    mesh_.color = colors.front();
    colors.clear();
  }
  return std::exchange(mesh_, {});
}

}  // namespace gs::app
