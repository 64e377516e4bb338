#include "qnv/codecs/values/encode/write_values.h"

#include <string>
#include <utility>

namespace gs::qnv {
namespace {

// Returns the size of a stream: its directory follows all chunks.
std::uint64_t bytes_of(const StreamHeader& header) {
  constexpr std::uint64_t kInOne = kMaxChunkBytes / kDirectoryEntryBytes;
  return header.directory + std::uint64_t{header.chunks} * kDirectoryEntryBytes +
         (header.chunks + kInOne - 1) / kInOne * kChunkHeaderBytes;
}

}  // namespace

Protection values_protection(const EncodeOptions& options) {
  return options.parity ? equal_protection(options) : Protection{Protection::Kind::unequal};
}

std::variant<EncodedStream, EncodeError> write_values(StreamHeader header, const ChunkList& chunks,
                                                      const EncodeOptions& options, std::string_view what) {
  EncodedStream stream;
  MemorySink memory_sink(stream.bytes);
  auto written = write_stream(std::move(header), chunks, options.max_bytes, options.sink ? *options.sink : memory_sink,
                              values_protection(options));
  if (auto* problem = std::get_if<EncodeError>(&written)) return std::move(*problem);
  stream.header = std::move(std::get<StreamHeader>(written));
  if (options.sink) stream.written = bytes_of(stream.header);
  if (options.max_bytes != 0 && stream.size() > options.max_bytes)
    return EncodeError{"a stream of the coarsest " + std::string(what) + " has " + std::to_string(stream.size()) +
                       " bytes; expected at most " + std::to_string(options.max_bytes)};
  return stream;
}

}  // namespace gs::qnv
