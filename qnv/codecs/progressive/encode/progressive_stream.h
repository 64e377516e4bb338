#pragma once

#include "qnv/codecs/lossless/exact_mesh.h"
#include "qnv/codecs/shared/encode_options.h"

#include <cstddef>
#include <optional>
#include <variant>

namespace gs::qnv {

/// log2 of the lattice positions per axis of a progressive mesh.
inline constexpr int kProgressiveBits = 12;

/// Encodes an exact mesh as a progressive stream. `header` must be complete except for the front. Returns nullopt if
/// the coarsest mesh does not fit into the first kilobyte, or if the mesh has colours.
[[nodiscard]] std::optional<EncodedStream> encode_splits(const exact::ExactMesh& mesh, StreamHeader header,
                                                         std::size_t max_bytes);

/// Encodes a surface with few triangles, planes and sharp edges as a progressive stream. Returns an error with
/// `unsuited` for other surfaces. Stores all triangles in memory. The bytes depend only on the input and the options.
[[nodiscard]] std::variant<EncodedStream, EncodeError> encode_progressive(const TriangleSource& source,
                                                                          const EncodeOptions& options,
                                                                          Progress* progress = nullptr);

}  // namespace gs::qnv
