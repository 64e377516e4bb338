#pragma once

#include "app/interface/base/icons.h"
#include "app/interface/base/interface_input.h"
#include "app/interface/base/notices.h"
#include "app/interface/base/places.h"
#include "app/interface/base/ui_style.h"
#include "app/interface/dock_view.h"
#include "app/interface/ui_overlay.h"
#include "app/settings/user_folders.h"
#include "base/text.h"

#include <imgui.h>

#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// State of the interface between frames. Only the ui_*.cpp files use it.
struct UiOverlay::State {
  UserSettings settings;  // copy of UiModel::settings
  Theme theme = Theme::dark;
  float screen_scale = 1, scale = 1;  // scale of the screen; that scale times the user's text size
  double now = 0;
  bool help = false, statistics = false, preferences = false;
  std::unique_ptr<InterfaceBackend> backend;
  std::unique_ptr<InterfaceFonts> fonts;
  int text_waits = 0;     // frames until a new text field gets the focus
  bool has_text = false;  // a text field has the focus
  std::size_t to_restore = 0;

  /// Row in the list below the address field.
  struct Suggestion {
    std::string place, label;
    Icon icon;
  };
  FolderListing listing;

  struct Address {
    std::string text;
    bool wanted = false, active = false, list_hovered = false;
    bool typed = false;                 // the user changed the text after the field got the focus
    std::string opening;                // text entered last; empty after any other input
    std::string retried;                // text that failed to open, shown again for correction
    std::optional<std::size_t> chosen;  // index in the list of suggestions
  } address;

  /// Row of the command palette.
  struct Command {
    std::string words, keys;
    std::optional<Icon> icon;
    std::function<void(UiActions&)> run;
  };
  struct Palette {
    bool open = false, appears = false, was_focused = false;
    std::string typed;
    int chosen = 0;
  } palette;

  struct OpenDialog {
    bool open = false, appears = false;
    bool saves = false;   // asks for a file to save
    std::string formats;  // formats of saved files, as text
    bool wanted = false;  // the text field requests the focus
    std::string typed;
    std::optional<std::size_t> chosen;  // index in the list of files
    bool all_files = false;             // also lists files of unknown type
    bool opening = false;               // the chosen file is loading but not displayed yet
    std::string problem;                // error message
  } dialog;

  Notices notices;
  InterfaceInput input;

  // A question is open; the user refused it by a key.
  bool question = false, question_refused = false;

  float menus_width = 0;  // width of the menu bar's items; 0 means unknown
  Tooltips tooltips;
  DockView dock;

  /// Menu bar of one frame.
  class MenuBar {
   public:
    explicit MenuBar(State& ui) : ui_(ui) {}
    void draw(const UiModel& model, UiActions& actions);

   private:
    void menus(const UiModel& model, UiActions& actions);
    [[nodiscard]] bool begin_menu(const std::string& label, bool enabled = true);
    [[nodiscard]] bool begin_part(const std::string& title, bool enabled);
    static void end_part();
    void group_menu(const ActionRow& first, const UiModel& model, UiActions& actions);
    void menu_item(const ActionRow& row, const UiModel& model, UiActions& actions);
    void recent_menu(const UiModel& model, UiActions& actions);
    void bookmark_menu(const UiModel& model, UiActions& actions);

    State& ui_;
  };

  void apply_appearance(bool at_first);

  void places_of_travel(const UiModel& model, UiActions& actions);
  [[nodiscard]] bool is_on(Action action, const UiModel& model) const;
  [[nodiscard]] static bool is_possible(Action action, const UiModel& model);

  void address_bar(const UiModel& model, UiActions& actions, float width);
  [[nodiscard]] std::vector<Suggestion> suggestions(const UiModel& model, const std::string& typed);
  /// Draws the rows of suggestions. Returns the index of the clicked row.
  static std::optional<std::size_t> suggestion_rows(const std::vector<Suggestion>& rows,
                                                    std::optional<std::size_t> chosen);

  void tool_bar(const UiModel& model, UiActions& actions);
  void tool(Action action, Icon icon, bool with_word, const UiModel& model, UiActions& actions);
  void mode_buttons(const UiModel& model, UiActions& actions, bool words);
  void viewpoint_list(const UiModel& model, UiActions& actions, float width, bool with_arrows);
  void layout_buttons(const UiModel& model, UiActions& actions, bool all, bool with_link);
  void status_bar(const UiModel& model);
  void restore_line(const UiModel& model, UiActions& actions);

  void show_palette();
  [[nodiscard]] std::vector<Command> commands(const UiModel& model) const;
  void palette_dialog(const UiModel& model, UiActions& actions);
  void open_dialog(const UiModel& model, UiActions& actions);
  void choose_in_dialog(const std::string& typed, UiActions& actions);
  [[nodiscard]] std::vector<FolderListing::Entry> dialog_rows(const TypedPath& path);
  void preferences_dialog(const UiModel& model, UiActions& actions);
  void help_panel();
  void question_panel(const UiModel& model, UiActions& actions);
  void notice_lines();

  // Height in Dear ImGui units.
  [[nodiscard]] float menu_bar_height() const;
  [[nodiscard]] float tool_bar_height() const;
  [[nodiscard]] float restore_height() const {
    return to_restore > 0 ? ImGui::GetFrameHeight() + 2 * std::round(4 * scale) : 0.0f;
  }
  [[nodiscard]] float top_height() const { return menu_bar_height() + tool_bar_height() + restore_height(); }
  [[nodiscard]] float status_bar_height() const;  // 0 if the bar is hidden
  /// Sets the tooltip of the item drawn last.
  void tooltip(std::string_view text) { tooltips.show(text); }
};

}  // namespace gs::app
