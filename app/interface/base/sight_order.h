#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace gs::app {

/// Line of text in visual order from left to right (Unicode Standard Annex 9), with Arabic letters joined.
struct SightOrder {
  static constexpr char32_t kNothing = 0xFEFF;  // placeholder for a letter that was merged into another one

  std::u32string characters;        // as many as in the text
  std::vector<std::size_t> places;  // visual index of each text character
  std::vector<bool> from_right;     // by visual index: right-to-left direction

  /// Returns the visual caret position before text character `index`, or after the last character. 0 is the left end.
  [[nodiscard]] std::size_t caret(std::size_t index) const;
  /// Returns the text index to insert at when the user clicks the left or right half of visual character `place`.
  [[nodiscard]] std::size_t index_at(std::size_t place, bool right_half) const;
};

/// Reports whether the text contains right-to-left characters.
[[nodiscard]] bool has_right_to_left(const std::u32string& text);
/// Computes the visual order. Very long lines (some thousand characters) keep their logical order.
[[nodiscard]] SightOrder sight_order(const std::u32string& text);

}  // namespace gs::app
