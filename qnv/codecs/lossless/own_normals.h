#pragma once

#include "qnv/codecs/lossless/exact_mesh.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv::exact {

/// Normals that a source file states for the corners of a mesh, if no shading rule reproduces them. FORMAT.md,
/// "Normals".
inline constexpr int kOwnNormalBits = 9, kMinNormalBits = 4, kMaxNormalBits = 14;

/// Encodes the normals of corners. `mesh` must be as a decoder obtains it. Index 3 t + k of `shaded` and `own` is for
/// corner k of triangle t. `shaded` has the unit normals by the shading rule, `own` those of the source file.
[[nodiscard]] std::vector<std::byte> encode_normals(const ExactMesh& mesh, std::span<const glm::vec3> shaded,
                                                    std::span<const glm::vec3> own, int bits = kOwnNormalBits);
/// Decodes the unit normals of all corners. Returns nullopt if the bytes do not belong to this mesh. Safe for untrusted
/// bytes; time is proportional to the number of corners.
[[nodiscard]] std::optional<std::vector<glm::vec3>> decode_normals(std::span<const std::byte> bytes,
                                                                   const ExactMesh& mesh,
                                                                   std::span<const glm::vec3> shaded);

/// Computes the normals of a mesh's corners by a shading rule.
[[nodiscard]] std::vector<glm::vec3> shaded_normals(const ExactMesh& mesh, const Shading& shading);
/// Returns the distance between two sets of normals: the root mean square of the differences.
[[nodiscard]] double distance_of(std::span<const glm::vec3> shaded, std::span<const glm::vec3> own);

}  // namespace gs::qnv::exact
