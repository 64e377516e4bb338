#pragma once

#include "qnv/codecs/shared/encode_options.h"
#include "qnv/codecs/shared/stream_writer.h"

#include <string_view>
#include <variant>

namespace gs::qnv {

/// Returns the protection of a stream of values: that of the options, else parity where it reduces the error most.
[[nodiscard]] Protection values_protection(const EncodeOptions& options);

/// Writes a stream of values with its protection. Uses `max_bytes`, `parity` and `sink` of EncodeOptions. Returns an
/// error if the sink or a chunk fails, or if the first chunk does not fit. `what` names the coarsest content.
[[nodiscard]] std::variant<EncodedStream, EncodeError> write_values(StreamHeader header, const ChunkList& chunks,
                                                                    const EncodeOptions& options,
                                                                    std::string_view what);

}  // namespace gs::qnv
