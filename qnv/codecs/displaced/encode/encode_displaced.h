#pragma once

#include "qnv/codecs/shared/encode_options.h"

#include <variant>

namespace gs::qnv {

/// Encodes a surface as a base mesh and displacements along its normals (displaced/surface.h). Unsuited for unordered
/// heaps of triangles. Holds all triangles in memory, about kDisplacedTriangleBytes each. Reads a source with more than
/// `most_triangles` several times. An exact tail (exact/exact_tail.h) shortens the part before it. The bytes depend
/// only on the input and the options, not on threads.
[[nodiscard]] std::variant<EncodedStream, EncodeError> encode_displaced(const TriangleSource& source,
                                                                        const EncodeOptions& options,
                                                                        Progress* progress = nullptr);

}  // namespace gs::qnv
