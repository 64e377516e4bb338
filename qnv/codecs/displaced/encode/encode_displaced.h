#pragma once

#include "qnv/codecs/shared/encode_options.h"

#include <variant>

namespace gs::qnv {

/// Encodes a surface as base meshes and displacements along their normals (codecs/displaced/surface.h). Not for
/// unordered sets of triangles without a common surface. Stores all triangles in memory, about kDisplacedTriangleBytes
/// each. Reads a source with more than `most_triangles` triangles several times. If an exact tail follows
/// (codecs/lossless/exact_tail.h), fewer bytes precede it. The bytes depend only on the input and the options, not on
/// threads.
[[nodiscard]] std::variant<EncodedStream, EncodeError> encode_displaced(const TriangleSource& source,
                                                                        const EncodeOptions& options,
                                                                        Progress* progress = nullptr);

}  // namespace gs::qnv
