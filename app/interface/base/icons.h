#pragma once

#include "app/view/actions.h"

#include <imgui.h>

#include <cstdint>
#include <optional>
#include <string_view>

namespace gs::app {

/// Icon of a button or menu row.
enum class Icon : std::uint8_t {
  open,
  back,
  forward,
  reload,
  stop,
  bookmark,
  bookmarked,
  search,
  home,
  fit,
  light,
  sound,
  silence,
  examine,
  fly,
  walk,
  pan,
  look_at,
  log,
  curve,
  link,
  help,
  settings,
  folder,
  file,
  panel,
  clock,
  viewpoint,
  web,
  split_right,
  split_below,
  maximise,
  restore,
  menu,
};
inline constexpr std::size_t kIcons = 34;

/// Draws an icon in `color`, in a square with sides of `size` and its upper left corner at `place`.
void draw_icon(ImDrawList& draw, Icon icon, const ImVec2& place, float size, ImU32 color);
/// Returns the icon of an action; nullopt if it has none.
[[nodiscard]] std::optional<Icon> icon_of(Action action);

/// Draws a button with an icon and, unless `word` is empty, a label after it. `id` is the Dear ImGui ID.
bool icon_button(std::string_view id, Icon icon, std::string_view word, bool on = false);
/// Returns the width of an icon_button() with this label.
[[nodiscard]] float icon_button_width(std::string_view word);
/// Draws an icon at the Dear ImGui cursor and moves the cursor to the right of the icon, on the same line.
void inline_icon(Icon icon);

}  // namespace gs::app
