#pragma once

#include <imgui.h>

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

namespace gs::app {

/// The letters of the interface: one font for what most texts have, and glyphs of others that the system has (by
/// Fontconfig) for whatever else is to be shown, drawn when they are needed first. They belong to the context of Dear
/// ImGui of the time, which keeps them in its font atlas.
class InterfaceFonts {
 public:
  static constexpr std::size_t kMostGlyphs = 4000;  // besides those of the first font; what comes later shows as '?'

  InterfaceFonts();
  ~InterfaceFonts();
  InterfaceFonts(const InterfaceFonts&) = delete;
  InterfaceFonts& operator=(const InterfaceFonts&) = delete;

  /// Of the context that is current; null: it has none of ours.
  [[nodiscard]] static InterfaceFonts* current();
  /// Letters of so many pixels. Before the first frame, and between frames.
  void set_size(float pixels);
  /// Whether texts need glyphs that are not there yet, or another size.
  [[nodiscard]] bool stale() const;
  /// Makes the font atlas anew; whoever has its texture must make that anew. Between frames.
  void build();

  /// `utf8` as Dear ImGui is to be given it: what is written from right to left is in the order in which it is seen,
  /// its letters joined; characters beyond the first plane of Unicode, which it cannot show, stand for themselves in
  /// the private area. Notes which glyphs that needs.
  [[nodiscard]] std::string shown(std::string_view utf8);
  /// One character of such a text, as Dear ImGui is to be given it; notes that it is needed.
  [[nodiscard]] char32_t drawn(char32_t character);
  /// Notes a character that the user types.
  void note(char32_t character);

 private:
  struct Glyphs;
  std::unique_ptr<Glyphs> glyphs_;
};

/// InterfaceFonts::shown of the current context.
[[nodiscard]] std::string shown(std::string_view utf8);

}  // namespace gs::app
