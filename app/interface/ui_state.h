#pragma once

#include "app/base/text.h"
#include "app/interface/interface_input.h"
#include "app/interface/notices.h"
#include "app/interface/ui_clouds.h"
#include "app/interface/ui_overlay.h"

#include <imgui.h>

#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// What the panels remember between frames; shared by the ui_*.cpp files only.
struct UiOverlay::State {
  float scale = 1;
  double now = 0;
  bool help = false, statistics = false, log = false, open_panel = false;
  ImFont* small = nullptr;

  // The Open panel.
  bool open_panel_appears = false;
  std::string folder;
  struct FolderEntry {
    std::string name;
    bool is_folder = false;
  };
  std::vector<FolderEntry> folder_entries;
  std::string folder_problem;
  bool all_files = false;  // not only those that some content type calls its own
  char path[4096] = {};
  bool opening = false;             // what was chosen is being read, and nothing of it shows yet
  std::string open_problem;         // why it could not be
  int text_waits = 0;               // frames until the text field takes the keys
  std::vector<std::string> recent;  // newest first

  Notices notices;
  InterfaceInput input;

  // Whether a question stands, and whether a key has answered it.
  bool question = false, question_refused = false;

  // What the pointer rests on: the item's upper left corner.
  ImVec2 hovered{-1, -1};
  double hovered_since = 0;
  bool hovers = false;

  CloudPanel clouds;

  // The log panel.
  bool show_errors = true, show_warnings = true, show_notes = true;

  void top_bar(const UiModel& model, UiActions& actions);
  void mode_buttons(const UiModel& model, UiActions& actions, bool as_list);
  void viewpoint_list(const UiModel& model, UiActions& actions, float width, bool with_arrows);
  void status_bar(const UiModel& model);
  void log_panel(const UiModel& model);
  void log_rows(const std::vector<const vrml::Diagnostic*>& rows);
  /// The upper edge of the log panel, or of the status bar where it is closed.
  [[nodiscard]] float log_top() const;
  void help_panel();
  void open_files_panel(UiActions& actions);
  void question_panel(const UiModel& model, UiActions& actions);
  void notice_lines();
  void view_buttons(const UiModel& model, UiActions& actions, bool home, bool with_fit, bool whole_word);
  void layout_buttons(const UiModel& model, UiActions& actions, bool all, bool with_link);
  void viewport_marks(const UiModel& model);
  void loading_line(const UiViewport& viewport, std::size_t index, UiActions& actions);
  void welcome(const UiViewport& viewport, std::size_t index);
  void travel_mark(const UiModel& model);

  [[nodiscard]] float top_bar_height() const;     // in the units of Dear ImGui
  [[nodiscard]] float status_bar_height() const;  // 0 when it is off
  void read_folder();
  /// Says more about the item before, once the pointer rests on it.
  void tooltip(std::string_view text);
  void opened(const std::string& path_or_url, UiActions& actions);
};

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

/// A button that shows whether what it stands for is on: a state of the view, or only an open panel.
bool switch_button(const char* label, bool on, bool is_panel = false);
void text(std::string_view text);
void colored_text(const ImVec4& color, std::string_view text);

}  // namespace gs::app
