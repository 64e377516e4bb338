#pragma once

#include <cstdint>

namespace gs::render {

/// Stereo format. side_by_side: left and right half for each eye. anaglyph: the left eye in red, the right eye in green
/// and blue.
enum class Stereo : std::uint8_t { none, side_by_side, anaglyph };

}  // namespace gs::render
