#pragma once

#include "base/parallel.h"
#include "qnv/base/description.h"
#include "qnv/codecs/shared/encode_options.h"

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

  /// Returns a source of the triangles, without normals. Refers to this object.
  [[nodiscard]] TriangleSource source() const;
};

/// Reduces a surface that is too large for memory to at most `most` triangles, close to that number. All corners in a
/// grid cell become one, at the position nearest to the planes of their triangles, so that edges stay sharp (P.
/// Lindstrom, Out-of-core simplification of large polygonal models, 2000). Details smaller than a cell vanish. Reads
/// the source three to six times without storing it; needs about 130 bytes per triangle of `most`. Deterministic.
[[nodiscard]] std::variant<ThinnedSurface, EncodeError> thin_surface(const TriangleSource& source, std::size_t most,
                                                                     Progress* progress = nullptr);

}  // namespace gs::qnv
