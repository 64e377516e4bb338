#pragma once

#include "app/window/window_event.h"

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace gs::app {

/// What the user can have done: by a key, by a button.
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

/// The place of an action in a choice, whose actions stand beside each other from `first` to `last`; nothing: it is
/// none of them.
[[nodiscard]] constexpr std::optional<int> place_in(Action first, Action last, Action action) {
  if (action < first || action > last) return std::nullopt;
  return static_cast<int>(action) - static_cast<int>(first);
}

/// Where an action stands in the menu bar.
enum class Menu : std::uint8_t { file, view, navigate, window, help };
inline constexpr std::size_t kMenus = 5;
[[nodiscard]] std::string_view title_of(Menu menu);

/// A row of the table of actions: menus, the palette of commands, keys, tooltips and the list of keys are made of it.
struct ActionRow {
  Action action;
  Key key;  // unknown: it has none
  bool control = false, shift = false;
  bool of_world = false;   // of what the active viewport shows: a key that text fields and panels take first
  std::string_view label;  // on a button
  std::string_view help;   // what it does, in one line, as it stands in menus
  Menu menu = Menu::view;
  bool alt = false;             // with the key
  std::string_view group = {};  // the menu in the menu; empty: none. Rows of one stand together
};
[[nodiscard]] std::span<const ActionRow> actions();
[[nodiscard]] const ActionRow& row_of(Action action);
/// The action of a key that went down, with what was held. Shift counts where it tells rows apart or a row asks for it.
[[nodiscard]] const ActionRow* action_of(const WindowEvent& event);
/// The key of a name as `keys_of` has it, in letters of any case, or of the one character that it types. Nothing: there
/// is no such key.
[[nodiscard]] std::optional<Key> find_key(std::string_view name);
/// "Ctrl+O", "Page Down".
[[nodiscard]] std::string keys_of(const ActionRow& row);
/// "Open a file, or drop one on the window (Ctrl+O)".
[[nodiscard]] std::string tooltip_of(Action action);

}  // namespace gs::app
