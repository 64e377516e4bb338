#pragma once

#include "qnv/codecs/shared/encode_options.h"
#include "qnv/codecs/shared/gaussian_source.h"

#include <cstddef>
#include <variant>

namespace gs::qnv::gaussians {

/// Encodes Gaussians in parts of at most `most` splats. The result does not depend on the numbers of threads and of
/// ranks.
[[nodiscard]] std::variant<EncodedStream, EncodeError> encode_in_parts(const GaussianSource& source, std::size_t most,
                                                                       const EncodeOptions& options,
                                                                       Progress* progress);

}  // namespace gs::qnv::gaussians
