#pragma once

#include "app/window/window_event.h"

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace gs::app {

/// Command that the user can trigger by key, button, menu or palette.
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
  clouds,
  scene_tree,
  inspector,
  routes,
  script_console,
  streams,
  pick,
  measure,
  ruler,
  take_picture,
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
  undo_move,
  redo_move,
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

/// Returns the index of `action` in a group of choices, consecutive from `first` to `last`; nullopt if it is outside.
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
  Key key;  // unknown means no key
  bool control = false, shift = false;
  bool of_world = false;   // acts on the active viewport; text fields and panels get the key first
  std::string_view label;  // button label
  std::string_view help;   // one-line description, used in menus
  Menu menu = Menu::view;
  bool alt = false;             // Alt is held with the key
  std::string_view group = {};  // submenu; empty means none. Rows of a submenu must be adjacent
};
[[nodiscard]] std::span<const ActionRow> actions();
[[nodiscard]] const ActionRow& row_of(Action action);
/// Returns the action of a key press with its modifiers; null if there is none. Ignores Shift unless a row needs it.
[[nodiscard]] const ActionRow* action_of(const WindowEvent& event);
/// Returns the key for a name as `keys_of` prints it (ignoring case), or for the character that it types. Returns
/// nullopt if there is no such key.
[[nodiscard]] std::optional<Key> find_key(std::string_view name);
/// Returns the shortcut as text: "Ctrl+O", "Page Down".
[[nodiscard]] std::string keys_of(const ActionRow& row);
/// Returns the tooltip with the shortcut: "Open a file (Ctrl+O)".
[[nodiscard]] std::string tooltip_of(Action action);

}  // namespace gs::app
