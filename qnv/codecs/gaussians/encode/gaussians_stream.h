#pragma once

#include "base/parallel.h"
#include "qnv/base/geometry.h"
#include "qnv/codecs/shared/encode_options.h"

#include <variant>

namespace gs::qnv {

/// Encodes Gaussians as a stream of the Gaussians payload. Blocks. Any thread. Fails if there are none, or if a number
/// is not finite. Of the options, uses `vectors`, `max_bytes`, `parity`, `metadata` and `threads`.
[[nodiscard]] std::variant<EncodedStream, EncodeError> encode_gaussians(const Gaussians& source,
                                                                        const EncodeOptions& options,
                                                                        Progress* progress = nullptr);

}  // namespace gs::qnv
