#pragma once

#include "base/noncopyable.h"

#include <imgui.h>

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

namespace gs::app {

/// Fonts of the interface: one font for common text, and glyphs from system fonts (by Fontconfig) for other characters.
/// A glyph is rendered at its first use. The fonts belong to one Dear ImGui context and are stored in its font atlas.
class InterfaceFonts : NonCopyable {
 public:
  static constexpr std::size_t kMaxGlyphs = 4000;  // max glyphs from system fonts; characters beyond are drawn as '?'

  InterfaceFonts();
  ~InterfaceFonts();

  /// Returns the fonts of the current context; null if it has none.
  [[nodiscard]] static InterfaceFonts* current();
  /// Sets the size in pixels. Call before the first frame or between frames.
  void set_size(float pixels);
  /// Reports whether the atlas lacks requested glyphs or has another size than set_size() requested.
  [[nodiscard]] bool stale() const;
  /// Rebuilds the font atlas; the caller must then recreate its texture. Call between frames.
  void build();

  /// Converts text to the form that Dear ImGui can draw: right-to-left text in visual order with joined letters.
  /// Replaces characters outside the BMP by characters of the private use area. Requests the glyphs of the result.
  [[nodiscard]] std::string shown(std::string_view utf8);
  /// Converts one character of a text in visual order, as shown() does, and requests its glyph.
  [[nodiscard]] char32_t drawn(char32_t character);
  /// Requests the glyph of a character that the user types.
  void note(char32_t character);

 private:
  struct Glyphs;
  std::unique_ptr<Glyphs> glyphs_;
};

/// Calls InterfaceFonts::shown() of the current context.
[[nodiscard]] std::string shown(std::string_view utf8);

}  // namespace gs::app
