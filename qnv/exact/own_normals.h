#pragma once

#include "qnv/exact/exact_mesh.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv::exact {

/// Normals that corners of a mesh have in its file, where no rule of shading gives them. FORMAT.md, "Normals".
inline constexpr int kOwnNormalBits = 9, kLeastNormalBits = 4, kMostNormalBits = 14;

/// `mesh`: as it is decoded. `shaded`, `own`: of each of its corners 3 t + k, unit: as the rule of its shading has it,
/// and in the file.
[[nodiscard]] std::vector<std::byte> encode_normals(const ExactMesh& mesh, std::span<const glm::vec3> shaded,
                                                    std::span<const glm::vec3> own, int bits = kOwnNormalBits);
/// The normals of all corners, unit. Nothing where the bytes are none of this mesh. Safe for untrusted bytes; time is
/// in proportion to the corners.
[[nodiscard]] std::optional<std::vector<glm::vec3>> decode_normals(std::span<const std::byte> bytes,
                                                                   const ExactMesh& mesh,
                                                                   std::span<const glm::vec3> shaded);

/// Normals of the corners of a mesh by the rule of its shading.
[[nodiscard]] std::vector<glm::vec3> shaded_normals(const ExactMesh& mesh, const Shading& shading);
/// How far normals are apart, as the root of the mean square of chords.
[[nodiscard]] double distance_of(std::span<const glm::vec3> shaded, std::span<const glm::vec3> own);

}  // namespace gs::qnv::exact
