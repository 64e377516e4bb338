#include "app/formats/common/byte_order.h"
#include "app/formats/export/export.h"

#include <glm/geometric.hpp>

#include <cmath>
#include <cstring>
#include <limits>
#include <string>

namespace gs::app {

Exported export_stl(const qnv::Geometry& geometry, const ExportOptions& options) {
  constexpr std::size_t kHeaderBytes = 80, kFacetBytes = 50, kTitleBytes = 60;
  const auto* mesh = geometry.as<qnv::IndexedMesh>();
  if (!mesh || mesh->triangles.empty()) return std::string(kNoTriangles);
  const std::size_t facets = mesh->triangles.size() / 3;
  if (facets > std::numeric_limits<std::uint32_t>::max())
    return "an STL file holds no more than 4,294,967,295 triangles: the mesh has " + std::to_string(facets);
  std::vector<std::byte> bytes;
  bytes.reserve(kHeaderBytes + 4 + facets * kFacetBytes);
  // The header must not begin with "solid", which marks text.
  std::string header = "GhostSpace " + options.title.substr(0, kTitleBytes);
  header.resize(kHeaderBytes, ' ');
  bytes.resize(kHeaderBytes);
  std::memcpy(bytes.data(), header.data(), kHeaderBytes);
  put_little(bytes, static_cast<std::uint32_t>(facets));
  const glm::dvec3& origin = mesh->description.origin;
  const auto put = [&](const glm::vec3& v) {
    for (int k = 0; k < 3; ++k) put_little(bytes, v[k]);
  };
  for (std::size_t i = 0; i + 2 < mesh->triangles.size(); i += 3) {
    const glm::dvec3 a(mesh->positions[mesh->triangles[i]]), b(mesh->positions[mesh->triangles[i + 1]]),
        c(mesh->positions[mesh->triangles[i + 2]]);
    const glm::dvec3 across = glm::cross(b - a, c - a);
    const double length = glm::length(across);
    put(length > 0 ? glm::vec3(across / length) : glm::vec3(0));
    for (const glm::dvec3& corner : {a, b, c}) put(glm::vec3(origin + corner));
    put_little(bytes, std::uint16_t{0});
  }
  return bytes;
}

}  // namespace gs::app
