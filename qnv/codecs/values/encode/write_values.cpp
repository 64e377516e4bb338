#include "qnv/codecs/values/encode/write_values.h"

#include <string>
#include <utility>

namespace gs::qnv {
Protection values_protection(const EncodeOptions& options) {
  return options.parity ? equal_protection(options) : Protection{Protection::Kind::unequal};
}

std::variant<EncodedStream, EncodeError> write_values(StreamHeader header, const ChunkList& chunks,
                                                      const EncodeOptions& options, std::string_view what) {
  auto written = write_together(std::move(header), chunks, options, values_protection(options));
  const auto* const stream = std::get_if<EncodedStream>(&written);
  if (stream && options.max_bytes != 0 && stream->size() > options.max_bytes)
    return EncodeError{"a stream of the coarsest " + std::string(what) + " has " + std::to_string(stream->size()) +
                       " bytes; expected at most " + std::to_string(options.max_bytes)};
  return written;
}

}  // namespace gs::qnv
