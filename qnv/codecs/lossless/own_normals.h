#pragma once

#include "qnv/codecs/lossless/exact_mesh.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv::exact {

/// Normals of a mesh's corners from its file, if no shading rule reproduces them. FORMAT.md, "Normals".
inline constexpr int kOwnNormalBits = 9, kMinNormalBits = 4, kMaxNormalBits = 14;

/// Encodes normals. `mesh` is as decoded. `shaded` and `own` are the unit normals of each corner 3 t + k: by its
/// shading rule, and from the file.
[[nodiscard]] std::vector<std::byte> encode_normals(const ExactMesh& mesh, std::span<const glm::vec3> shaded,
                                                    std::span<const glm::vec3> own, int bits = kOwnNormalBits);
/// Returns the unit normals of all corners, or nullopt if the bytes do not belong to this mesh. Safe for untrusted
/// bytes; time is proportional to the corners.
[[nodiscard]] std::optional<std::vector<glm::vec3>> decode_normals(std::span<const std::byte> bytes,
                                                                   const ExactMesh& mesh,
                                                                   std::span<const glm::vec3> shaded);

/// Returns the normals of a mesh's corners by a shading rule.
[[nodiscard]] std::vector<glm::vec3> shaded_normals(const ExactMesh& mesh, const Shading& shading);
/// Returns the distance between normals, as the root mean square of chords.
[[nodiscard]] double distance_of(std::span<const glm::vec3> shaded, std::span<const glm::vec3> own);

}  // namespace gs::qnv::exact
