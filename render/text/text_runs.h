#pragma once

#include "vrml/mesh/text_shaper.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace gs::render {

/// Characters that are shaped together: of one script, in one direction.
struct TextRun {
  std::size_t first = 0, end = 0;  // of the characters
  vrml::TextDirection direction = vrml::TextDirection::right;
  std::uint32_t script = 0;  // as HarfBuzz has it
};

/// Runs of a line, in the order in which they are seen: from left to right, or from top to bottom. `text` loses what
/// cannot be seen: controls; tabulators and ends of lines become blanks.
///
/// Characters advance as VRML97 6.20.3 says. Hebrew, Arabic and the like have a direction of their own, so in a line
/// that has such characters each runs its own way (Unicode UAX #9, embedded in `direction`), be it right or left.
[[nodiscard]] std::vector<TextRun> runs_of(std::u32string& text, vrml::TextDirection direction);

}  // namespace gs::render
