#pragma once

#include "app/interface/base/fonts.h"
#include "app/settings/user_settings.h"
#include "base/diagnostic.h"
#include "base/text.h"

#include <imgui.h>

#include <optional>
#include <string>
#include <string_view>

namespace gs::app {

/// Interface colours of the present theme.
struct UiColors {
  static inline ImVec4 kText, kQuiet, kAccent, kBar, kPanel, kPopup, kError, kWarning, kNote;
  /// Colours of text over pictures, which has a dark background in both themes.
  static inline const ImVec4 kOnPicture{0.88f, 0.89f, 0.91f, 1}, kQuietOnPicture{0.62f, 0.65f, 0.70f, 1};
  static inline ImVec4 kContrast;  // colour of button and line shades: white in dark theme, black in light theme
};
[[nodiscard]] ImVec4 color_of(Severity severity);
[[nodiscard]] ImVec4 with_alpha(ImVec4 color, float alpha);

/// Font size in pixels at scale 1.
inline constexpr float kFontSize = 14.5f;

/// Sets sizes, colours and corner radii for a screen scale.
void set_style(Theme theme, float scale);

/// Draws a toggle button that shows whether it is `on`. `is_panel` means that it opens a panel rather than changes the
/// view.
bool switch_button(const char* label, bool on, bool is_panel = false);
/// Draws text through InterfaceFonts.
void text(std::string_view text);
void colored_text(const ImVec4& color, std::string_view text);
/// Builds a Dear ImGui label that shows any `text` and has the ID `id`.
[[nodiscard]] std::string label_of(std::string_view text, std::string_view id);

/// Tooltips of all items. A tooltip appears when the pointer has rested on an item for kTooltipDelay.
class Tooltips {
 public:
  /// Starts a frame. Call before any item is drawn. If `wanted` is false, no tooltips appear in this frame.
  void begin(double now, bool wanted);
  /// Sets the tooltip of the previous item.
  void show(std::string_view text);
  void end();
  /// Returns the seconds until a tooltip appears; nullopt if none will.
  [[nodiscard]] std::optional<double> next() const;

 private:
  ImVec2 item_{-1, -1};  // upper left corner of the hovered item
  double now_ = 0, since_ = 0;
  bool hovers_ = false, wanted_ = true;
};

}  // namespace gs::app
