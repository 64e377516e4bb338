#pragma once

#include "qnv/codecs/shared/encode_options.h"
#include "qnv/codecs/shared/outgoing_chunk.h"
#include "qnv/codecs/shared/parity_writer.h"
#include "qnv/codecs/shared/stream_sink.h"
#include "qnv/container/container.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace gs::qnv {

/// Returns the number of payload bytes that fit into a stream of at most `max_bytes`, if chunks have about 1,200 bytes.
[[nodiscard]] std::size_t payload_budget(const StreamHeader& header, std::size_t max_bytes);

/// Puts `metadata` before those of the description, and drops the pairs of the description with the same keys.
void add_metadata(const std::vector<std::pair<std::string, std::string>>& metadata, Description& about);

/// Returns the protection that EncodeOptions::parity requests; none by default.
[[nodiscard]] Protection equal_protection(const EncodeOptions& options);

/// Chunks that list the other chunks of a stream.
struct Listing {
  ChunkType type = ChunkType::directory;
  std::vector<std::vector<std::byte>> payloads;
};

/// Chunks of a stream that are made when they are written, so that they need no memory together.
class ChunkList {
 public:
  virtual ~ChunkList() = default;
  [[nodiscard]] virtual std::size_t size() const = 0;
  /// Returns nullopt if the payload cannot be read.
  [[nodiscard]] virtual std::optional<OutgoingChunk> chunk(std::size_t i) const = 0;
  /// Returns a chunk without reading its payload. The payload has the right length, but undefined bytes.
  [[nodiscard]] virtual std::optional<OutgoingChunk> outline(std::size_t i) const { return chunk(i); }
  /// Returns a compact directory, or nullopt for a general one. `entries` are those of the first chunks, with offsets
  /// and lengths; `box` is that of the stream.
  [[nodiscard]] virtual std::optional<Listing> listing(std::span<const DirectoryEntry> /*entries*/,
                                                       const Box& /*box*/) const {
    return std::nullopt;
  }
  /// Returns the most bytes of the directory for each chunk.
  [[nodiscard]] virtual std::size_t entry_bytes() const { return kDirectoryEntryBytes; }
};

/// Writes a stream to a sink, like write_stream() below. Returns the header, or an error if the sink or a chunk fails.
[[nodiscard]] std::variant<StreamHeader, EncodeError> write_stream(StreamHeader header, const ChunkList& chunks,
                                                                   std::size_t max_bytes, StreamSink& sink,
                                                                   const Protection& protection = {});
/// Writes a stream to the sink of the options, or to memory. With several ranks, each rank writes a part of the chunks,
/// and all ranks pass equal lists. Uses these options: max_bytes, sink, ranks.
[[nodiscard]] std::variant<EncodedStream, EncodeError> write_together(StreamHeader header, const ChunkList& chunks,
                                                                      const EncodeOptions& options,
                                                                      const Protection& protection);
/// Writes the header, the chunks in the given order with their parity, and the directory, which omits the parity. If
/// the stream exceeds `max_bytes` (0 means unlimited), drops chunks from the end, but never the first. Sets the
/// header's number of vectors.
[[nodiscard]] EncodedStream write_stream(StreamHeader header, std::vector<OutgoingChunk> chunks, std::size_t max_bytes,
                                         const Protection& protection = {});

}  // namespace gs::qnv
