#pragma once

#include "qnv/exact/shading.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv::progressive {

// FORMAT.md, "Splits".
inline constexpr std::uint8_t kFrontMark = 255;  // where a stage has its depth
inline constexpr std::size_t kFrontBytes = 13;   // before the first mesh
inline constexpr std::size_t kSegmentHeaderBytes = 6;
/// A segment has at most so many visits a byte.
inline constexpr std::size_t kMostVisitsAByte = 64;

struct FrontHeader {
  int bits = 12;
  bool middles = false;  // of SplitGrowth
  exact::Shading shading;
  std::uint32_t vertices = 0, triangles = 0;  // in the end
};

}  // namespace gs::qnv::progressive
