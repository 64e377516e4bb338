#pragma once

#include "vrml/mesh/text_shaper.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace gs::render {

/// Range of characters with one script and direction, which are shaped together.
struct TextRun {
  std::size_t first = 0, end = 0;  // range of characters
  vrml::TextDirection direction = vrml::TextDirection::right;
  std::uint32_t script = 0;  // ISO 15924 tag as in HarfBuzz
};

/// Returns the runs of a line in visual order: left to right or top to bottom. Removes control characters from `text`.
/// Replaces tabs and line ends by blanks.
///
/// Characters advance as in VRML97 6.20.3. Hebrew, Arabic and similar scripts have an own direction. In a line with
/// such characters, each run goes right or left by Unicode UAX #9, with `direction` as the base direction.
[[nodiscard]] std::vector<TextRun> runs_of(std::u32string& text, vrml::TextDirection direction);

}  // namespace gs::render
