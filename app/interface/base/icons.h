#pragma once

#include "app/view/actions.h"

#include <imgui.h>

#include <cstdint>
#include <optional>
#include <string_view>

namespace gs::app {

/// Small drawings beside words.
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

/// Draws it in a square of this size, whose upper left corner is `place`, in the colour of text.
void draw_icon(ImDrawList& draw, Icon icon, const ImVec2& place, float size, ImU32 color);
/// The icon of what an action does; nothing: it has none.
[[nodiscard]] std::optional<Icon> icon_of(Action action);

/// A button with an icon and, unless `word` is empty, a word behind it. `id`: what Dear ImGui knows it by.
bool icon_button(std::string_view id, Icon icon, std::string_view word, bool on = false);
/// How wide that is.
[[nodiscard]] float icon_button_width(std::string_view word);
/// An icon in a line of text; the cursor goes on behind it.
void inline_icon(Icon icon);

}  // namespace gs::app
