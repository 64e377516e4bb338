#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace gs::app {

/// A line of text as it is seen from left to right (Unicode Standard Annex 9), Arabic letters joined.
struct SightOrder {
  static constexpr char32_t kNothing = 0xFEFF;  // in the place of a letter that has become a part of another

  std::u32string characters;        // as many as the text has
  std::vector<std::size_t> places;  // among them, of each character of the text
  std::vector<bool> from_right;     // whether what stands there is read from right to left

  /// Between which of the seen characters one stands who writes before character `index` of the text, or behind its
  /// last one: 0 is before the first of them.
  [[nodiscard]] std::size_t caret(std::size_t index) const;
  /// Before which character of the text one writes who points at the seen character `place`, at its left or right half.
  [[nodiscard]] std::size_t index_at(std::size_t place, bool right_half) const;
};

/// Whether anything of a text is written from right to left.
[[nodiscard]] bool has_right_to_left(const std::u32string& text);
/// Lines longer than some thousand characters keep their order.
[[nodiscard]] SightOrder sight_order(const std::u32string& text);

}  // namespace gs::app
