#include "app/formats/datasets/module/unpack_chunk.h"

#include <blosc.h>
#include <bzlib.h>
#include <lz4.h>
#include <lzma.h>

#include <cstdint>
#include <limits>

namespace gs::app {

bool unpack_chunk(ChunkCodec codec, std::span<const std::byte> from, std::span<std::byte> to) {
  switch (codec) {
    case ChunkCodec::blosc: {
      std::size_t size = 0;
      if (blosc_cbuffer_validate(from.data(), from.size(), &size) < 0 || size != to.size()) return false;
      if (size == 0) return true;
      const int unpacked = blosc_decompress_ctx(from.data(), to.data(), to.size(), 1);
      return unpacked >= 0 && static_cast<std::size_t>(unpacked) == to.size();
    }
    case ChunkCodec::lz4:
    case ChunkCodec::lz4_block: {
      // numcodecs: the length in 4 bytes, then one LZ4 block.
      const std::size_t length = codec == ChunkCodec::lz4 ? 4 : 0;
      constexpr std::size_t kMost = std::numeric_limits<int>::max();
      if (from.size() < length || from.size() > kMost || to.size() > kMost) return false;
      const int unpacked =
          LZ4_decompress_safe(reinterpret_cast<const char*>(from.data() + length), reinterpret_cast<char*>(to.data()),
                              static_cast<int>(from.size() - length), static_cast<int>(to.size()));
      return unpacked >= 0 && static_cast<std::size_t>(unpacked) == to.size();
    }
    case ChunkCodec::bzip2: {
      auto size = static_cast<unsigned>(to.size());
      if (from.size() > std::numeric_limits<unsigned>::max()) return false;
      // The library takes a pointer without const, and does not write there.
      char* const source = const_cast<char*>(reinterpret_cast<const char*>(from.data()));
      return BZ2_bzBuffToBuffDecompress(reinterpret_cast<char*>(to.data()), &size, source,
                                        static_cast<unsigned>(from.size()), 0, 0) == BZ_OK &&
             size == to.size();
    }
    case ChunkCodec::xz: {
      constexpr std::uint64_t kMostMemory = std::uint64_t{256} << 20;
      std::uint64_t memory = kMostMemory;
      std::size_t at = 0, made = 0;
      return lzma_stream_buffer_decode(&memory, 0, nullptr, reinterpret_cast<const std::uint8_t*>(from.data()), &at,
                                       from.size(), reinterpret_cast<std::uint8_t*>(to.data()), &made,
                                       to.size()) == LZMA_OK &&
             made == to.size();
    }
  }
  return false;
}

}  // namespace gs::app
