#pragma once

#include "qnv/codecs/shared/encode_options.h"

#include <variant>

namespace gs::qnv {

/// Encodes vectors from any source, such as gradients of a volume or imported splats, as records.
[[nodiscard]] std::variant<EncodedStream, EncodeError> encode_vectors(const VectorView& vectors,
                                                                      const EncodeOptions& options,
                                                                      Progress* progress = nullptr);

}  // namespace gs::qnv
