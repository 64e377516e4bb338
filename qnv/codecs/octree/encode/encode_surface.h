#pragma once

#include "qnv/codecs/shared/encode_options.h"

#include <variant>

namespace gs::qnv {

/// Encodes a surface as an octree (paper, section 3.1). Clips the triangles at the voxels of the octree; the moments of
/// the pieces give exact areas, mean normals and mean colours. Reads the source twice. Memory grows with the number of
/// vectors, not of triangles. The bytes depend only on the input, the options and the seed, not on threads or the
/// compiler.
[[nodiscard]] std::variant<EncodedStream, EncodeError> encode_surface(const TriangleSource& source,
                                                                      const EncodeOptions& options,
                                                                      Progress* progress = nullptr);

/// Encodes the vectors of encode_surface() as records.
[[nodiscard]] std::variant<EncodedStream, EncodeError> encode_surface_records(const TriangleSource& source,
                                                                              const EncodeOptions& options,
                                                                              Progress* progress = nullptr);

/// Encodes vectors on a surface, such as the points of a scan, as an octree. Each vector counts as a square with the
/// vector's area. There are about as many voxels as vectors. Intermediate pictures need fewer bytes than with the
/// records payload. But the final picture is less exact, because a voxel does not store the positions inside it.
[[nodiscard]] std::variant<EncodedStream, EncodeError> encode_points(const VectorView& vectors,
                                                                     const EncodeOptions& options,
                                                                     Progress* progress = nullptr);

}  // namespace gs::qnv
