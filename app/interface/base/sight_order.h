#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace gs::app {

/// Line of text in visual order from left to right (Unicode Standard Annex 9). Arabic letters are replaced by their
/// joined forms.
struct SightOrder {
  static constexpr char32_t kNothing = 0xFEFF;  // placeholder for a letter that was merged into another one

  std::u32string characters;  // in visual order; the number is that of the text
  std::vector<std::size_t> places;  // visual index of each text character
  std::vector<bool> from_right;  // by visual index: the direction is right to left

  /// Returns the visual position of a caret before text character `index`. For the number of characters, the caret is
  /// after the last one. 0 is the left end.
  [[nodiscard]] std::size_t caret(std::size_t index) const;
  /// Returns the text index at which to insert after a click on the left or right half of visual character `place`.
  [[nodiscard]] std::size_t index_at(std::size_t place, bool right_half) const;
};

/// Reports whether the text contains right-to-left characters.
[[nodiscard]] bool has_right_to_left(const std::u32string& text);
/// Computes the visual order of a text. A line of more than some thousand characters keeps its logical order.
[[nodiscard]] SightOrder sight_order(const std::u32string& text);

}  // namespace gs::app
