#pragma once

#include "qnv/codecs/shared/encode_options.h"
#include "qnv/container/container.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace gs::qnv {

/// Chunk to be written; `entry` lacks only the offset and length.
struct OutgoingChunk {
  ChunkType type = ChunkType::packed;
  std::vector<std::byte> payload;
  DirectoryEntry entry;
  std::uint32_t replaced = 0;  // number of vectors in other chunks that its own replace
};

/// Returns the payload bytes that fit into a stream of at most `max_bytes`, for chunks of about 1,200 bytes.
[[nodiscard]] std::size_t payload_budget(const StreamHeader& header, std::size_t max_bytes);

/// Writes the header, the chunks in order and the directory. If the stream exceeds `max_bytes` (0: unlimited), drops
/// the last chunks, but never the first. Counts the header's vectors.
[[nodiscard]] EncodedStream write_stream(StreamHeader header, std::vector<OutgoingChunk> chunks, std::size_t max_bytes);

}  // namespace gs::qnv
