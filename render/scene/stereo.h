#pragma once

#include <cstdint>

namespace gs::render {

/// Pictures for two eyes: one half for each, left and right; or both in one, the left eye's as red and the right one's
/// as green and blue.
enum class Stereo : std::uint8_t { none, side_by_side, anaglyph };

}  // namespace gs::render
