#pragma once

#include "qnv/codecs/shared/encode_options.h"

#include <variant>

namespace gs::qnv {

/// Encodes a surface (paper, section 3.1): clips the triangles at the voxels of an octree, and computes exact areas,
/// mean normals and mean colours from their moments. Reads the source twice. Memory grows with the vectors, not with
/// the triangles. The bytes depend only on the input, the options and the seed, not on threads or the compiler.
[[nodiscard]] std::variant<EncodedStream, EncodeError> encode_surface(const TriangleSource& source,
                                                                      const EncodeOptions& options,
                                                                      Progress* progress = nullptr);

/// Encodes vectors on a surface, such as the points of a scan, as an octree. Each vector counts as a square of its
/// area, and there are about as many voxels as vectors. Intermediate pictures need fewer bytes than with records, but
/// the last is less exact: a voxel does not store the positions inside it.
[[nodiscard]] std::variant<EncodedStream, EncodeError> encode_points(const VectorView& vectors,
                                                                     const EncodeOptions& options,
                                                                     Progress* progress = nullptr);

}  // namespace gs::qnv
