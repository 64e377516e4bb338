#pragma once

#include <cstdint>

namespace gs::app {

// Magic numbers of a GLB file, little-endian (glTF 2.0 4.4).
inline constexpr std::uint32_t kGlbMagic = 0x46546c67;     // "glTF"
inline constexpr std::uint32_t kJsonChunk = 0x4e4f534a;    // "JSON"
inline constexpr std::uint32_t kBinaryChunk = 0x004e4942;  // "BIN" and a zero byte

}  // namespace gs::app
