#pragma once

#include "app/window/window_event.h"

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace gs::app {

/// Command that the user can run by key, button, menu or command palette.
enum class Action : std::uint8_t {
  next_viewpoint,
  previous_viewpoint,
  reset,
  fit,
  headlight,
  examine,
  fly,
  walk,
  pan,
  look_at,
  ghost,
  faster,
  slower,
  open_file,
  save_as,
  next_file,
  previous_file,
  reload,
  next_layout,
  viewport_1,
  viewport_2,
  viewport_3,
  viewport_4,
  split_right,
  split_below,
  maximise,
  swap_viewports,
  even_out,
  next_pane,
  previous_pane,
  close_viewport,
  link,
  help,
  statistics,
  log,
  transfer,
  data,
  splats,
  scene_tree,
  inspector,
  routes,
  script_console,
  streams,
  pick,
  measure,
  ruler,
  take_picture,
  copy_picture,
  pictures,
  tour_view,
  mute,
  louder,
  softer,
  full_screen,
  palette,
  address,
  back,
  forward,
  bookmark,
  preferences,
  larger_text,
  smaller_text,
  normal_text,
  theme,
  side_front,
  side_back,
  side_left,
  side_right,
  side_top,
  side_bottom,
  straighten,
  seek,
  undo,
  redo,
  orthographic,
  display_surface,
  display_edges,
  display_wireframe,
  display_points,
  next_display,
  grid,
  backdrop,
  axes,
  copy_camera,
  copy_viewpoint,
  paste_camera,
  up_auto,
  up_x,
  up_minus_x,
  up_y,
  up_minus_y,
  up_z,
  up_minus_z,
  close,
  quit,
};

/// Returns the index of `action` among the consecutive actions from `first` to `last`. Returns nullopt if `action` is
/// not one of them.
[[nodiscard]] constexpr std::optional<int> place_in(Action first, Action last, Action action) {
  if (action < first || action > last) return std::nullopt;
  return static_cast<int>(action) - static_cast<int>(first);
}

/// Menu in the menu bar.
enum class Menu : std::uint8_t { file, view, navigate, window, help };
inline constexpr std::size_t kMenus = 5;
[[nodiscard]] std::string_view title_of(Menu menu);

/// Row of the action table. Menus, command palette, shortcuts, tooltips and the list of keys are built from it.
struct ActionRow {
  Action action;
  Key key;  // Key::unknown if the action has no key
  bool control = false, shift = false;
  bool of_world = false;   // acts on the active viewport; a focused text field or panel gets the key first
  std::string_view label;  // text on the button
  std::string_view help;   // one-line description; also the text of the menu item
  Menu menu = Menu::view;
  bool alt = false;                // the shortcut includes Alt
  std::string_view group = {};     // name of the submenu; empty means none. The rows of a submenu must be adjacent
  Key control_key = Key::unknown;  // this key with Control runs the action, too; Key::unknown if there is none
};
[[nodiscard]] std::span<const ActionRow> actions();
[[nodiscard]] const ActionRow& row_of(Action action);
/// Returns the row of the action that a key press runs; null if there is none. Shift is ignored unless a row has Shift.
[[nodiscard]] const ActionRow* action_of(const WindowEvent& event);
/// Returns the key with a name as in keys_of() (case is ignored), or the key that types a character. Returns nullopt if
/// there is no such key.
[[nodiscard]] std::optional<Key> find_key(std::string_view name);
/// Returns the shortcut of a row as text, such as "Ctrl+O" or "Page Down".
[[nodiscard]] std::string keys_of(const ActionRow& row);
/// Returns all shortcuts of a row, such as "Ctrl+Shift+Z, Ctrl+Y".
[[nodiscard]] std::string all_keys_of(const ActionRow& row);
/// Returns the tooltip of an action with its shortcut, such as "Open a file (Ctrl+O)".
[[nodiscard]] std::string tooltip_of(Action action);

}  // namespace gs::app
