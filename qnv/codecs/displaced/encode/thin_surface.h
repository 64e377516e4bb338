#pragma once

#include "base/parallel.h"
#include "qnv/base/description.h"
#include "qnv/codecs/shared/encode_options.h"
#include "qnv/codecs/shared/shared_records.h"
#include "qnv/mesh/survey.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <variant>
#include <vector>

namespace gs::qnv {

/// Surface with fewer triangles than its source.
struct ThinnedSurface {
  std::vector<glm::vec3> positions;  // units of the source
  std::vector<Rgb8> colors;          // one per position
  std::vector<std::array<std::uint32_t, 3>> triangles;

  /// Returns a source of the triangles, without normals. The source refers to this object, which must outlive it.
  [[nodiscard]] TriangleSource source() const;
};

/// Reduces a surface that is too large for memory to at most `most` triangles, and close to that number. Merges all
/// corners in a grid cell into one vertex. Edges stay sharp, because the vertex is at the position nearest to the
/// planes of the triangles (P. Lindstrom, Out-of-core simplification of large polygonal models, 2000). Details smaller
/// than a cell vanish. Usually reads the source twice without storing it. Needs about 160 bytes per triangle of `most`.
/// Deterministic: does not depend on the order of the triangles. Ranks share the reading; all get the result.
/// `survey` describes the whole source. Collective.
[[nodiscard]] std::variant<ThinnedSurface, EncodeError> thin_surface(EncodeRanks& shared, const TriangleSource& source,
                                                                     const SurfaceSurvey& survey, std::size_t most,
                                                                     Progress* progress = nullptr);

}  // namespace gs::qnv
