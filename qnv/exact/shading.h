#pragma once

#include "qnv/displaced/manifold.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv::exact {

/// Which faces round a vertex a corner's normal is made of; each counts by its area.
struct Shading {
  enum class Rule : std::uint8_t {
    edges = 0,  // those that edges join across which faces are no farther apart than the angle
    faces = 1,  // those no farther apart from the corner's own than the angle
  };
  Rule rule = Rule::edges;
  int angle = 180;  // degrees, to 180
  friend bool operator==(const Shading&, const Shading&) = default;
};

/// The payload of a chunk that says so of a rule other than the first, which the tail itself has.
[[nodiscard]] std::vector<std::byte> encode_shading(const Shading& shading);
/// Nothing where it is none. Safe for untrusted bytes.
[[nodiscard]] std::optional<Shading> decode_shading(std::span<const std::byte> payload);

/// Of each side 3 t + k, from corner k to the next one, that beside it; kNone where the mesh ends.
[[nodiscard]] std::vector<std::uint32_t> twins_of(std::span<const displaced::Corners> triangles);

/// Triangles round whose vertices normals are made.
struct ShadedMesh {
  std::span<const displaced::Corners> triangles;
  std::span<const std::uint32_t> twins;  // as twins_of has them
  std::span<const glm::vec3> faces;      // a triangle's normal, twice its area long
  std::size_t vertices = 0;
};
/// A normal of each corner 3 t + k, unit; +z where there is none. Of vertices for which `wanted` is not set they are
/// zero; empty: all are wanted. Time is in proportion to the corners.
[[nodiscard]] std::vector<glm::vec3> corner_normals(const ShadedMesh& mesh, const Shading& shading,
                                                    const std::vector<bool>& wanted = {});

/// The shading that comes nearest to that of a mesh, given which angle the first rule has.
[[nodiscard]] Shading shading_of(const displaced::SurfaceMesh& mesh, int edges_angle);

}  // namespace gs::qnv::exact
