#pragma once

#include "app/base/text.h"
#include "app/interface/base/fonts.h"
#include "app/settings/user_settings.h"
#include "vrml/scene/diagnostic.h"

#include <imgui.h>

#include <optional>
#include <string>
#include <string_view>

namespace gs::app {

/// Colours of the interface, by the theme of the time.
struct UiColors {
  static inline ImVec4 kText, kQuiet, kAccent, kBar, kPanel, kPopup, kError, kWarning, kNote;
  /// Over pictures, on a dark ground in both themes.
  static inline const ImVec4 kOnPicture{0.88f, 0.89f, 0.91f, 1}, kQuietOnPicture{0.62f, 0.65f, 0.70f, 1};
  static inline ImVec4 kContrast;  // what buttons and lines are shades of: white on dark, black on light
};
[[nodiscard]] ImVec4 color_of(vrml::Severity severity);
[[nodiscard]] ImVec4 with_alpha(ImVec4 color, float alpha);

/// Letters at scale 1, in pixels.
inline constexpr float kFontSize = 14.5f;

/// Sizes, colours and corners of everything, for a screen of this scale.
void set_style(Theme theme, float scale);

/// A button that shows whether what it stands for is on: a state of the view, or only an open panel.
bool switch_button(const char* label, bool on, bool is_panel = false);
/// Any text, as InterfaceFonts shows it.
void text(std::string_view text);
void colored_text(const ImVec4& color, std::string_view text);
/// A label for Dear ImGui that shows `text`, whatever is in it, and is known by `id`.
[[nodiscard]] std::string label_of(std::string_view text, std::string_view id);

/// Says more about what the pointer rests on, after a while.
class Tooltips {
 public:
  /// Before any item of a frame. `wanted`: false where they would only be in the way.
  void begin(double now, bool wanted);
  /// Of the item before.
  void show(std::string_view text);
  void end();
  /// Seconds until one appears.
  [[nodiscard]] std::optional<double> next() const;

 private:
  ImVec2 item_{-1, -1};  // that the pointer rests on: its upper left corner
  double now_ = 0, since_ = 0;
  bool hovers_ = false, wanted_ = true;
};

}  // namespace gs::app
