#pragma once

#include "qnv/container/container.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace gs::qnv {

/// Chunk to be written. `entry` is complete except for the offset and the length.
struct OutgoingChunk {
  static constexpr std::uint32_t kNoChain = 0xffffffff;

  ChunkType type = ChunkType::packed;
  std::vector<std::byte> payload;
  DirectoryEntry entry;
  std::uint32_t replaced = 0;      // number of vectors in other chunks that this chunk replaces
  double gain = 0;                 // reduction of the squared error by this chunk, for protection against losses
  std::uint32_t chain = kNoChain;  // chunks of a chain need the earlier ones of the same chain
};

}  // namespace gs::qnv
