#include "app/interface/ui_state.h"
#include "app/session/documents/documents.h"

#include <imgui.h>

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <string>

// Menu bar: all actions of the action table, recent files and bookmarks.
namespace gs::app {
namespace {

constexpr std::size_t kMaxShown = 15;
constexpr float kRoomForTwo = 62;  // min window width at which a submenu fits beside its menu, in font heights

// Begins a window for one part of the row of menus.
void begin_row(const char* name, float left, float width, float height, const ImVec2& padding, bool menus) {
  ImGui::SetNextWindowPos({left, 0});
  ImGui::SetNextWindowSize({width, height});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 0);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, {1, 1});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, padding);
  ImGui::PushStyleColor(ImGuiCol_WindowBg, UiColors::kBar);
  ImGui::Begin(name, nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoFocusOnAppearing |
                   (menus ? ImGuiWindowFlags_MenuBar : ImGuiWindowFlags_None));
  ImGui::PopStyleColor();
  ImGui::PopStyleVar(4);
}

}  // namespace

float UiOverlay::State::menu_bar_height() const { return ImGui::GetFontSize() + 2 * std::round(6 * scale); }

bool UiOverlay::State::is_on(Action action, const UiModel& model) const {
  if (const auto mode = place_in(Action::examine, Action::look_at, action))
    return model.has_world && static_cast<int>(model.mode) == 1 + *mode;
  if (const auto display = place_in(Action::display_surface, Action::display_points, action))
    return model.has_world && static_cast<int>(model.style.display) == *display;
  if (const auto up = place_in(Action::up_auto, Action::up_minus_z, action))
    return model.has_world && static_cast<int>(model.style.up) == *up;
  switch (action) {
    case Action::headlight:
      return model.headlight;
    case Action::mute:
      return model.has_sounds && !model.muted;
    case Action::link:
      return model.linked;
    case Action::maximise:
      return model.maximised;
    case Action::statistics:
      return statistics;
    case Action::orthographic:
      return model.style.parallel;
    case Action::grid:
      return model.style.grid;
    case Action::backdrop:
      return model.settings.backdrop;
    case Action::axes:
      return model.settings.axes;
    case Action::bookmark:
      return model.bookmark.has_value();
    default:
      return panel_of(action) && dock.dock().is_open(*panel_of(action));
  }
}

bool UiOverlay::State::is_possible(Action action, const UiModel& model) {
  switch (action) {
    case Action::back:
      return model.can_go_back;
    case Action::forward:
      return model.can_go_forward;
    case Action::next_file:
    case Action::previous_file:
      return model.files.size() > 1;
    case Action::split_right:
    case Action::split_below:
      return true;
    case Action::maximise:
    case Action::swap_viewports:
    case Action::even_out:
    case Action::next_pane:
    case Action::previous_pane:
    case Action::close_viewport:
      return model.panes > 1;
    case Action::next_viewpoint:
    case Action::previous_viewpoint:
      return model.viewpoints.size() > 1;
    case Action::bookmark:
      return !model.address.empty();
    case Action::undo:
      return model.can_undo;
    case Action::redo:
      return model.can_redo;
    case Action::fit:
    case Action::side_front:
    case Action::side_back:
    case Action::side_left:
    case Action::side_right:
    case Action::side_top:
    case Action::side_bottom:
    case Action::straighten:
    case Action::seek:
      return model.has_world && model.mode != NavigationMode::none;
    case Action::mute:
    case Action::louder:
    case Action::softer:
      return model.has_sounds;
    default:
      break;
  }
  const ActionRow& row = row_of(action);
  const int mode = 1 + static_cast<int>(action) - static_cast<int>(Action::examine);
  if (action >= Action::examine && action <= Action::look_at)
    return model.has_world && model.rules.allows(static_cast<NavigationMode>(mode));
  return !row.of_world || model.has_world;
}

void UiOverlay::State::MenuBar::menu_item(const ActionRow& row, const UiModel& model, UiActions& actions) {
  // The menu item of a panel has the title of the panel's tab.
  const auto panel = panel_of(row.action);
  const std::string_view words = panel ? panel_rows()[*panel].title : row.help;
  const ImVec2 place = ImGui::GetCursorScreenPos();
  const float line = ImGui::GetTextLineHeight();
  if (ImGui::MenuItem(("      " + label_of(words, row.help)).c_str(), keys_of(row).c_str(),
                      ui_.is_on(row.action, model), ui_.is_possible(row.action, model)))
    actions.run = row.action;
  if (const auto icon = icon_of(row.action))
    draw_icon(*ImGui::GetWindowDrawList(), *icon, {place.x, place.y + std::round(line * 0.02f)}, line,
              ImGui::GetColorU32(UiColors::kQuiet));
}

// Begins a menu. Its height is limited to the window below the menu bar; a longer menu scrolls.
bool UiOverlay::State::MenuBar::begin_menu(const std::string& label, bool enabled) {
  const float below = ImGui::GetIO().DisplaySize.y - ui_.menu_bar_height() - ImGui::GetStyle().DisplaySafeAreaPadding.y;
  ImGui::SetNextWindowSizeConstraints({0, 0}, {FLT_MAX, std::max(below, ui_.menu_bar_height())});
  return ImGui::BeginMenu(label.c_str(), enabled);
}

// Begins a submenu. In a narrow window, a submenu would cover its parent; then its items are added to the parent. Call
// end_part() if this function returns true.
bool UiOverlay::State::MenuBar::begin_part(const std::string& title, bool enabled) {
  const std::string label = "      " + title;
  if (ImGui::GetIO().DisplaySize.x >= kRoomForTwo * ImGui::GetFontSize()) return begin_menu(label, enabled);
  if (!enabled) return false;
  ImGui::Separator();
  colored_text(UiColors::kQuiet, label);
  return true;
}
void UiOverlay::State::MenuBar::end_part() {
  if (ImGui::GetIO().DisplaySize.x >= kRoomForTwo * ImGui::GetFontSize())
    ImGui::EndMenu();
  else
    ImGui::Separator();
}

void UiOverlay::State::MenuBar::recent_menu(const UiModel& model, UiActions& actions) {
  if (!begin_part("Open recent", !model.recent.empty())) return;
  for (std::size_t i = 0; i < std::min(model.recent.size(), kMaxShown); ++i)
    if (ImGui::MenuItem(("      " + label_of(shortened(without_home(model.recent[i]), 90), std::to_string(i))).c_str()))
      actions.open = model.recent[i];
  end_part();
}

void UiOverlay::State::MenuBar::bookmark_menu(const UiModel& model, UiActions& actions) {
  if (!begin_menu("Bookmarks")) return;
  menu_item(row_of(Action::bookmark), model, actions);
  if (!model.bookmarks.empty()) ImGui::Separator();
  for (std::size_t i = 0; i < model.bookmarks.size(); ++i) {
    const Bookmark& one = model.bookmarks[i];
    ImGui::PushID(static_cast<int>(i));
    if (ImGui::MenuItem(("      " + label_of(shortened(one.title, 80), "bookmark")).c_str())) actions.open_bookmark = i;
    ui_.tooltip(without_home(one.place) + (one.viewpoint.empty() ? "" : "\n" + one.viewpoint) +
                "\nRight-click to remove");
    if (ImGui::BeginPopupContextItem("##remove")) {
      if (ImGui::MenuItem("Remove bookmark")) actions.remove_bookmark = i;
      ImGui::EndPopup();
    }
    ImGui::PopID();
  }
  ImGui::EndMenu();
}

// Draws the submenu of a group. Does nothing unless `first` is the first row of the group.
void UiOverlay::State::MenuBar::group_menu(const ActionRow& first, const UiModel& model, UiActions& actions) {
  const ActionRow* before = &first == app::actions().data() ? nullptr : &first - 1;
  if (before && before->group == first.group && before->menu == first.menu) return;
  const bool possible = !first.of_world || model.has_world;
  if (!begin_part(std::string(first.group), possible)) return;
  for (const ActionRow& row : app::actions())
    if (row.group == first.group && row.menu == first.menu) menu_item(row, model, actions);
  end_part();
}

void UiOverlay::State::MenuBar::menus(const UiModel& model, UiActions& actions) {
  for (std::size_t i = 0; i < kMenus; ++i) {
    const auto menu = static_cast<Menu>(i);
    if (menu == Menu::help) bookmark_menu(model, actions);
    if (!begin_menu(std::string(title_of(menu)))) continue;
    for (const bool panels : {false, true}) {
      bool parted = !panels;
      for (const ActionRow& row : app::actions()) {
        if (row.menu != menu || panel_of(row.action).has_value() != panels) continue;
        if (row.action == Action::quit) continue;  // the caller adds it at the end
        if (!std::exchange(parted, true)) ImGui::Separator();
        if (!row.group.empty()) {
          group_menu(row, model, actions);
          continue;
        }
        menu_item(row, model, actions);
      }
    }
    if (row_of(Action::quit).menu == menu) {
      recent_menu(model, actions);
      ImGui::Separator();
      menu_item(row_of(Action::quit), model, actions);
    }
    ImGui::EndMenu();
  }
}

void UiOverlay::State::MenuBar::draw(const UiModel& model, UiActions& actions) {
  const float width = ImGui::GetIO().DisplaySize.x, height = ui_.menu_bar_height();
  const ImVec2 frame(8 * ui_.scale, std::round(6 * ui_.scale));
  ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, frame);
  begin_row("##menus", 0, ui_.menus_width > 0 ? std::min(ui_.menus_width, width) : width, height, {4 * ui_.scale, 0},
            true);
  if (ImGui::BeginMenuBar()) {
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, {8 * ui_.scale, std::round(4 * ui_.scale)});
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {10 * ui_.scale, 6 * ui_.scale});
    menus(model, actions);
    ui_.menus_width = std::round(ImGui::GetCursorPosX());
    ImGui::PopStyleVar(2);
    ImGui::EndMenuBar();
  }
  ImGui::End();
  ImGui::PopStyleVar();
  if (ui_.menus_width <= 0 || ui_.menus_width >= width) return;
  begin_row("##travel", ui_.menus_width, width - ui_.menus_width, height, {2 * ui_.scale, std::round(3 * ui_.scale)},
            false);
  ui_.places_of_travel(model, actions);
  ImGui::End();
}

// Draws the buttons Back, Forward, and Reload or Stop, the address bar and the bookmark button.
void UiOverlay::State::places_of_travel(const UiModel& model, UiActions& actions) {
  ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, {7 * scale, std::round(3 * scale)});
  const auto button = [&](Action action, Icon icon) {
    ImGui::BeginDisabled(!is_possible(action, model));
    if (icon_button(row_of(action).help, icon, "")) actions.run = action;
    ImGui::EndDisabled();
    tooltip(tooltip_of(action));
    ImGui::SameLine(0, 1);
  };
  button(Action::back, Icon::back);
  button(Action::forward, Icon::forward);
  if (model.loading)
    button(Action::close, Icon::stop);
  else
    button(Action::reload, Icon::reload);
  ImGui::SameLine(0, 6 * scale);
  const float star = icon_button_width("") + 10 * scale;
  const float room = ImGui::GetWindowWidth() - ImGui::GetCursorPosX() - star;
  if (room > 60 * scale) {
    address_bar(model, actions, room);
    ImGui::SameLine(0, 2 * scale);
    button(Action::bookmark, model.bookmark ? Icon::bookmarked : Icon::bookmark);
  }
  ImGui::PopStyleVar();
}

}  // namespace gs::app
