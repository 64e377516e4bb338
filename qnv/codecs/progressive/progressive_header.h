#pragma once

#include "qnv/codecs/lossless/shading.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv::progressive {

// Byte layout of fronts and segments: FORMAT.md, "Splits".
inline constexpr std::uint8_t kFrontMark = 255;  // at the byte where a stage has its depth
inline constexpr std::size_t kFrontBytes = 13;  // bytes of a front before the first mesh
inline constexpr std::size_t kSegmentHeaderBytes = 6;
/// Maximum number of vertex visits per byte of a segment.
inline constexpr std::size_t kMaxVisitsAByte = 64;

struct FrontHeader {
  int bits = 12;
  bool middles = false;  // see SplitGrowth
  exact::Shading shading;
  std::uint32_t vertices = 0, triangles = 0;  // numbers of the complete mesh
};

}  // namespace gs::qnv::progressive
