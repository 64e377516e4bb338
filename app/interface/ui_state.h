#pragma once

#include "app/base/text.h"
#include "app/interface/base/interface_input.h"
#include "app/interface/base/notices.h"
#include "app/interface/base/ui_style.h"
#include "app/interface/dock_view.h"
#include "app/interface/ui_overlay.h"

#include <imgui.h>

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// What the panels remember between frames; shared by the ui_*.cpp files only.
struct UiOverlay::State {
  float scale = 1;
  double now = 0;
  bool help = false, statistics = false, open_panel = false;
  std::unique_ptr<InterfaceBackend> backend;

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

  Tooltips tooltips;
  DockView dock;

  void top_bar(const UiModel& model, UiActions& actions);
  void mode_buttons(const UiModel& model, UiActions& actions, bool as_list);
  void viewpoint_list(const UiModel& model, UiActions& actions, float width, bool with_arrows);
  void status_bar(const UiModel& model);
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
  void tool_marks(const UiModel& model) const;

  [[nodiscard]] float top_bar_height() const;     // in the units of Dear ImGui
  [[nodiscard]] float status_bar_height() const;  // 0 when it is off
  void read_folder();
  /// Says more about the item before, once the pointer rests on it.
  void tooltip(std::string_view text) { tooltips.show(text); }
  bool toggle_panel(Action action);
  [[nodiscard]] bool panel_shows(Action action) const;
  void opened(const std::string& path_or_url, UiActions& actions);
};

}  // namespace gs::app
