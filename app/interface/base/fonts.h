#pragma once

#include <imgui.h>

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

namespace gs::app {

/// Fonts of the interface: one font for common text, plus glyphs from system fonts (by Fontconfig), rendered on first
/// use. They belong to one Dear ImGui context and live in its font atlas.
class InterfaceFonts {
 public:
  static constexpr std::size_t kMaxGlyphs = 4000;  // max glyphs beyond the first font; further ones show as '?'

  InterfaceFonts();
  ~InterfaceFonts();
  InterfaceFonts(const InterfaceFonts&) = delete;
  InterfaceFonts& operator=(const InterfaceFonts&) = delete;

  /// Returns the fonts of the current context; null if it has none.
  [[nodiscard]] static InterfaceFonts* current();
  /// Sets the size in pixels. Call before the first frame or between frames.
  void set_size(float pixels);
  /// Reports whether text needs missing glyphs or another size.
  [[nodiscard]] bool stale() const;
  /// Rebuilds the font atlas; the caller must then recreate its texture. Call between frames.
  void build();

  /// Converts text to the form that Dear ImGui displays: right-to-left text in visual order with joined letters.
  /// Characters outside the BMP, which it cannot show, map to the private use area. Requests the glyphs needed.
  [[nodiscard]] std::string shown(std::string_view utf8);
  /// Converts one character of such a text and requests its glyph.
  [[nodiscard]] char32_t drawn(char32_t character);
  /// Requests the glyph of a character that the user types.
  void note(char32_t character);

 private:
  struct Glyphs;
  std::unique_ptr<Glyphs> glyphs_;
};

/// Calls InterfaceFonts::shown in the current context.
[[nodiscard]] std::string shown(std::string_view utf8);

}  // namespace gs::app
