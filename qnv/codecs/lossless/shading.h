#pragma once

#include "qnv/mesh/manifold.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv::exact {

/// Rule that selects the faces that contribute to a corner's normal. The weight of a face is its area.
struct Shading {
  enum class Rule : std::uint8_t {
    edges = 0,  // faces that are connected over edges with at most `angle` between both faces
    faces = 1,  // faces with at most `angle` between them and the corner's own face
  };
  Rule rule = Rule::edges;
  int angle = 180;  // degrees, 0 to 180
  friend bool operator==(const Shading&, const Shading&) = default;
};

/// Encodes the payload of a shading chunk. Rule::edges needs no chunk: the tail contains its angle.
[[nodiscard]] std::vector<std::byte> encode_shading(const Shading& shading);
/// Decodes the payload of a shading chunk. Returns nullopt if it is invalid. Safe for untrusted bytes.
[[nodiscard]] std::optional<Shading> decode_shading(std::span<const std::byte> payload);

/// Returns for each side the same edge's side in the adjacent triangle; kNone on a rim. Side 3 t + k runs from corner k
/// of triangle t to the next corner.
[[nodiscard]] std::vector<std::uint32_t> twins_of(std::span<const displaced::Corners> triangles);

/// Mesh with the data that corner_normals() needs.
struct ShadedMesh {
  std::span<const displaced::Corners> triangles;
  std::span<const std::uint32_t> twins;  // result of twins_of()
  std::span<const glm::vec3> faces;      // normal of each triangle; its length is twice the area
  std::size_t vertices = 0;
};
/// Returns the unit normal of corner k of triangle t at index 3 t + k; +z if undefined. Returns zero for corners at
/// vertices that are not `wanted`; if `wanted` is empty, computes all corners. Time is proportional to the number of
/// corners.
[[nodiscard]] std::vector<glm::vec3> corner_normals(const ShadedMesh& mesh, const Shading& shading,
                                                    const std::vector<bool>& wanted = {});

/// Returns the shading rule that reproduces a mesh's normals best. `edges_angle` is the angle of Rule::edges.
[[nodiscard]] Shading shading_of(const displaced::SurfaceMesh& mesh, int edges_angle);

}  // namespace gs::qnv::exact
