#pragma once

#include "qnv/encode/encode_surface.h"
#include "qnv/stream/container.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace gs::qnv {

/// A chunk on its way into a stream; `entry` lacks only what its place decides.
struct OutgoingChunk {
  ChunkType type = ChunkType::packed;
  std::vector<std::byte> payload;
  DirectoryEntry entry;
  std::uint32_t replaced = 0;  // vectors of other chunks in whose place its own are shown
};

/// How many bytes of payload may go into a stream of at most `max_bytes`, of chunks of about 1,200 bytes.
[[nodiscard]] std::size_t payload_budget(const StreamHeader& header, std::size_t max_bytes);

/// Header, chunks in their order, directory. Of more than `max_bytes` (0: no limit) the last chunks are left out, but
/// never the first. Counts the header's vectors.
[[nodiscard]] EncodedStream write_stream(StreamHeader header, std::vector<OutgoingChunk> chunks, std::size_t max_bytes);

}  // namespace gs::qnv
