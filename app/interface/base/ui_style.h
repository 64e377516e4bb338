#pragma once

#include "app/base/text.h"
#include "vrml/scene/diagnostic.h"

#include <imgui.h>

#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace gs::app {

/// Colours of the interface.
struct UiColors {
  static inline const ImVec4 kText{0.88f, 0.89f, 0.91f, 1};
  static inline const ImVec4 kQuiet{0.58f, 0.61f, 0.66f, 1};
  static inline const ImVec4 kAccent{0.30f, 0.58f, 0.90f, 1};
  static inline const ImVec4 kBar{0.125f, 0.135f, 0.150f, 1};
  static inline const ImVec4 kPanel{0.145f, 0.155f, 0.172f, 0.97f};
  static inline const ImVec4 kError{0.96f, 0.42f, 0.40f, 1};
  static inline const ImVec4 kWarning{0.95f, 0.76f, 0.34f, 1};
  static inline const ImVec4 kNote{0.52f, 0.72f, 0.95f, 1};
};
[[nodiscard]] ImVec4 color_of(vrml::Severity severity);

/// Sizes, colours and corners of everything, for a screen of this scale.
void set_style(float scale);
void load_font(float scale);

/// A button that shows whether what it stands for is on: a state of the view, or only an open panel.
bool switch_button(const char* label, bool on, bool is_panel = false);
void text(std::string_view text);
void colored_text(const ImVec4& color, std::string_view text);

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
