#pragma once

#include "vrml/mesh/text_shaper.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace gs::render {

/// Characters of one script and direction that are shaped together.
struct TextRun {
  std::size_t first = 0, end = 0;  // range of characters
  vrml::TextDirection direction = vrml::TextDirection::right;
  std::uint32_t script = 0;  // as in HarfBuzz
};

/// Returns the runs of a line in visual order, left to right or top to bottom. Removes control characters from `text`
/// and turns tabs and line ends into blanks.
///
/// Characters advance as VRML97 6.20.3 says. Hebrew, Arabic and similar scripts have their own direction; in a line
/// with such characters each run has its own direction (Unicode UAX #9, embedded in `direction`), right or left.
[[nodiscard]] std::vector<TextRun> runs_of(std::u32string& text, vrml::TextDirection direction);

}  // namespace gs::render
