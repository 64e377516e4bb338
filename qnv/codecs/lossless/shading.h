#pragma once

#include "qnv/mesh/manifold.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv::exact {

/// Rule for the faces that contribute to a corner's normal, weighted by area.
struct Shading {
  enum class Rule : std::uint8_t {
    edges = 0,  // faces connected over edges with at most the angle between both faces
    faces = 1,  // faces within the angle of the corner's own face
  };
  Rule rule = Rule::edges;
  int angle = 180;  // degrees, 0 to 180
  friend bool operator==(const Shading&, const Shading&) = default;
};

/// Returns the payload of a chunk that states a rule. Rule::edges needs no chunk; the tail has its angle.
[[nodiscard]] std::vector<std::byte> encode_shading(const Shading& shading);
/// Returns nullopt if the payload is invalid. Safe for untrusted bytes.
[[nodiscard]] std::optional<Shading> decode_shading(std::span<const std::byte> payload);

/// Returns for each side 3 t + k, from corner k to the next one, the adjacent side; kNone on a rim.
[[nodiscard]] std::vector<std::uint32_t> twins_of(std::span<const displaced::Corners> triangles);

/// Mesh for computing normals.
struct ShadedMesh {
  std::span<const displaced::Corners> triangles;
  std::span<const std::uint32_t> twins;  // as returned by twins_of()
  std::span<const glm::vec3> faces;      // normal of each triangle; its length is twice the area
  std::size_t vertices = 0;
};
/// Returns a unit normal for each corner 3 t + k; +z if undefined. Skips vertices that are not `wanted` and returns
/// zero for them; if `wanted` is empty, none is skipped. Time is proportional to the corners.
[[nodiscard]] std::vector<glm::vec3> corner_normals(const ShadedMesh& mesh, const Shading& shading,
                                                    const std::vector<bool>& wanted = {});

/// Returns the shading closest to a mesh's normals, given the angle of Rule::edges.
[[nodiscard]] Shading shading_of(const displaced::SurfaceMesh& mesh, int edges_angle);

}  // namespace gs::qnv::exact
