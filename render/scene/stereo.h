#pragma once

#include <cstdint>

namespace gs::render {

/// Format of a stereo image. side_by_side: left half for the left eye, right half for the right eye. anaglyph: red for
/// the left eye, green and blue for the right eye.
enum class Stereo : std::uint8_t { none, side_by_side, anaglyph };

}  // namespace gs::render
