#include "app/interface/base/icons.h"

#include "app/interface/base/ui_style.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>

namespace gs::app {
namespace {

/// Icon and its drawing in a square of 16 units, with y downwards. Commands: M x y moves; L x y draws a line; Z closes
/// the path; C x y r draws a circle; D x y r draws a filled circle; A x y r FROM TO draws an arc. Angles are in
/// degrees, clockwise from the right.
struct IconRow {
  Icon icon;
  const char* strokes;
};
constexpr IconRow kDrawings[] = {
    {Icon::open, "M1.5 13.5 L1.5 3 L6 3 L7.5 5 L13 5 L13 7.5 M1.5 13.5 L4 7.5 L15 7.5 L12.5 13.5 Z"},
    {Icon::back, "M9.5 3.5 L5 8 L9.5 12.5 M5 8 L13.5 8"},
    {Icon::forward, "M6.5 3.5 L11 8 L6.5 12.5 M11 8 L2.5 8"},
    {Icon::reload, "A8 8 5 -30 250 M12.8 2.2 L12.4 5.7 L9 5"},
    {Icon::stop, "M4 4 L12 12 M12 4 L4 12"},
    {Icon::bookmark, "M4 2.5 L12 2.5 L12 13.5 L8 10.5 L4 13.5 Z"},
    {Icon::bookmarked, "M4 2.5 L12 2.5 L12 13.5 L8 10.5 L4 13.5 Z M6 4.5 L6 10 M8 4.5 L8 8.5 M10 4.5 L10 10"},
    {Icon::search, "C7 7 4.2 M10.2 10.2 L14 14"},
    {Icon::home, "M2 8 L8 2.5 L14 8 M4 7 L4 13.5 L12 13.5 L12 7"},
    {Icon::fit, "M2 5.5 L2 2 L5.5 2 M10.5 2 L14 2 L14 5.5 M14 10.5 L14 14 L10.5 14 M5.5 14 L2 14 L2 10.5 C8 8 2.5"},
    {Icon::light,
     "C8 8 2.6 M8 1 L8 3 M8 13 L8 15 M1 8 L3 8 M13 8 L15 8 M3 3 L4.4 4.4 M11.6 11.6 L13 13 M3 13 L4.4 11.6 "
     "M11.6 4.4 L13 3"},
    {Icon::sound, "M2 6 L4.5 6 L8 3 L8 13 L4.5 10 L2 10 Z A8.5 8 2.5 -45 45 A8.5 8 5 -45 45"},
    {Icon::silence, "M2 6 L4.5 6 L8 3 L8 13 L4.5 10 L2 10 Z M10.5 6 L14 10 M14 6 L10.5 10"},
    {Icon::examine, "A8 8 5.5 200 500 M13.8 9.2 L12.6 12.2 L9.8 10.6 D8 8 1.4"},
    {Icon::fly, "M2 8.5 L14 2.5 L10 13.5 L7.5 9 Z M7.5 9 L14 2.5"},
    {Icon::walk, "D8.5 2.8 1.6 M8.5 5 L8 9.5 L10.5 14.5 M8 9.5 L5 14.5 M8.3 6 L5 8.5 M8.3 6 L11.5 8.5"},
    {Icon::pan,
     "M8 1.5 L8 14.5 M1.5 8 L14.5 8 M6 3.5 L8 1.5 L10 3.5 M6 12.5 L8 14.5 L10 12.5 M3.5 6 L1.5 8 L3.5 10 "
     "M12.5 6 L14.5 8 L12.5 10"},
    {Icon::look_at, "M1 8 L4.5 4.5 L8 3.5 L11.5 4.5 L15 8 L11.5 11.5 L8 12.5 L4.5 11.5 Z C8 8 2.2"},
    {Icon::log, "M3 2 L13 2 L13 14 L3 14 Z M5.5 5 L10.5 5 M5.5 8 L10.5 8 M5.5 11 L8.5 11"},
    {Icon::curve, "M2 2 L2 14 L14 14 M3.5 12 L6 11 L8 6 L10 4.5 L13.5 3.5 D6 11 1 D10 4.5 1"},
    {Icon::link, "A5.2 8 3 60 300 A10.8 8 3 240 480 M6 8 L10 8"},
    {Icon::help, "C8 8 6.3 A8 6.4 2 180 400 M8.6 8.2 L8 9.6 D8 12 0.8"},
    {Icon::settings, "M2 4.5 L14 4.5 M2 8 L14 8 M2 11.5 L14 11.5 D5 4.5 1.6 D11 8 1.6 D6.5 11.5 1.6"},
    {Icon::folder, "M1.5 13 L1.5 3.5 L6 3.5 L7.5 5.5 L14.5 5.5 L14.5 13 Z"},
    {Icon::file, "M3.5 1.5 L9.5 1.5 L12.5 4.5 L12.5 14.5 L3.5 14.5 Z M9.5 1.5 L9.5 4.5 L12.5 4.5"},
    {Icon::panel, "M1.5 2.5 L14.5 2.5 L14.5 13.5 L1.5 13.5 Z M9.5 2.5 L9.5 13.5"},
    {Icon::clock, "C8 8 6.2 M8 4.5 L8 8 L10.5 9.8"},
    {Icon::viewpoint, "M1.5 5 L4.5 5 L5.8 3 L10.2 3 L11.5 5 L14.5 5 L14.5 13 L1.5 13 Z C8 8.8 2.6"},
    {Icon::web, "C8 8 6.3 M1.7 8 L14.3 8 M8 1.7 L5.3 4.6 L5.3 11.4 L8 14.3 L10.7 11.4 L10.7 4.6 Z"},
    {Icon::split_right, "M2 3 L14 3 L14 13 L2 13 Z M8 3 L8 13 M11 6 L11 10 M9.5 8 L12.5 8"},
    {Icon::split_below, "M2 3 L14 3 L14 13 L2 13 Z M2 8 L14 8 M8 9 L8 12 M6.5 10.5 L9.5 10.5"},
    {Icon::maximise, "M3 3 L13 3 L13 13 L3 13 Z M3 4.5 L13 4.5"},
    {Icon::restore, "M5.5 5.5 L5.5 2.5 L13.5 2.5 L13.5 10.5 L10.5 10.5 M2.5 5.5 L10.5 5.5 L10.5 13.5 L2.5 13.5 Z"},
    {Icon::menu, "M3 4.5 L13 4.5 M3 8 L13 8 M3 11.5 L13 11.5"},
};
static_assert(std::size(kDrawings) == kIcons);

struct ActionIcon {
  Action action;
  Icon icon;
};
constexpr ActionIcon kActionIcons[] = {
    {Action::open_file, Icon::open},
    {Action::reload, Icon::reload},
    {Action::reset, Icon::home},
    {Action::fit, Icon::fit},
    {Action::headlight, Icon::light},
    {Action::mute, Icon::sound},
    {Action::examine, Icon::examine},
    {Action::fly, Icon::fly},
    {Action::walk, Icon::walk},
    {Action::pan, Icon::pan},
    {Action::look_at, Icon::look_at},
    {Action::log, Icon::log},
    {Action::transfer, Icon::curve},
    {Action::split_right, Icon::split_right},
    {Action::split_below, Icon::split_below},
    {Action::maximise, Icon::maximise},
    {Action::close_viewport, Icon::stop},
    {Action::link, Icon::link},
    {Action::help, Icon::help},
    {Action::close, Icon::stop},
    {Action::next_viewpoint, Icon::viewpoint},
};

float icon_size() { return std::round(ImGui::GetFontSize() * 1.05f); }

}  // namespace

void draw_icon(ImDrawList& draw, Icon icon, const ImVec2& place, float size, ImU32 color) {
  const float unit = size / 16, thickness = std::max(1.0f, 1.15f * unit);
  const char* at = kDrawings[static_cast<std::size_t>(icon)].strokes;
  const auto number = [&at] {
    char* end = nullptr;
    const float value = std::strtof(at, &end);
    at = end;
    return value;
  };
  const auto point = [&] {
    const float x = number(), y = number();
    return ImVec2(place.x + x * unit, place.y + y * unit);
  };
  const auto finish = [&](bool closed) {
    if (draw._Path.Size > 1)
      draw.PathStroke(color, closed ? ImDrawFlags_Closed : ImDrawFlags_None, thickness);
    else
      draw.PathClear();
  };
  while (*at) {
    const char stroke = *at++;
    if (stroke == 'M') {
      finish(false);
      draw.PathLineTo(point());
    } else if (stroke == 'L') {
      draw.PathLineTo(point());
    } else if (stroke == 'Z') {
      finish(true);
    } else if (stroke == 'C' || stroke == 'D') {
      finish(false);
      const ImVec2 center = point();
      const float radius = number() * unit;
      if (stroke == 'C')
        draw.AddCircle(center, radius, color, 0, thickness);
      else
        draw.AddCircleFilled(center, radius, color);
    } else if (stroke == 'A') {
      finish(false);
      const ImVec2 center = point();
      const float radius = number() * unit, degree = 3.14159265f / 180;
      const float from = number() * degree, to = number() * degree;
      draw.PathArcTo(center, radius, from, to, 24);
      finish(false);
    }
  }
  finish(false);
}

std::optional<Icon> icon_of(Action action) {
  for (const ActionIcon& row : kActionIcons)
    if (row.action == action) return row.icon;
  return std::nullopt;
}

float icon_button_width(std::string_view word) {
  const ImGuiStyle& style = ImGui::GetStyle();
  const float icon = icon_size();
  if (word.empty()) return icon + 2 * std::round(style.FramePadding.x * 0.7f);
  return icon + style.ItemInnerSpacing.x + ImGui::CalcTextSize(word.data(), word.data() + word.size()).x +
         2 * style.FramePadding.x;
}

bool icon_button(std::string_view id, Icon icon, std::string_view word, bool on) {
  const ImGuiStyle& style = ImGui::GetStyle();
  const float size = icon_size(), width = icon_button_width(word), height = ImGui::GetFrameHeight();
  if (on) {
    const ImVec4 color = with_alpha(UiColors::kAccent, 0.55f);
    ImGui::PushStyleColor(ImGuiCol_Button, color);
    ImGui::PushStyleColor(ImGuiCol_ButtonHovered, color);
  } else {
    ImGui::PushStyleColor(ImGuiCol_Button, ImVec4(0, 0, 0, 0));
    ImGui::PushStyleColor(ImGuiCol_ButtonHovered, with_alpha(UiColors::kContrast, 0.12f));
  }
  const bool pressed = ImGui::Button(("###" + std::string(id)).c_str(), {width, height});
  ImGui::PopStyleColor(2);
  const ImVec2 lower = ImGui::GetItemRectMin();
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  const ImU32 color = ImGui::GetColorU32(ImGuiCol_Text);
  const float padding = word.empty() ? std::round((width - size) / 2) : style.FramePadding.x;
  draw_icon(draw, icon, {lower.x + padding, lower.y + std::round((height - size) / 2)}, size, color);
  if (!word.empty())
    draw.AddText({lower.x + padding + size + style.ItemInnerSpacing.x,
                  lower.y + std::round((height - ImGui::GetFontSize()) / 2)},
                 color, word.data(), word.data() + word.size());
  return pressed;
}

void inline_icon(Icon icon) {
  const float size = icon_size(), line = ImGui::GetTextLineHeight();
  const ImVec2 place = ImGui::GetCursorScreenPos();
  draw_icon(*ImGui::GetWindowDrawList(), icon, {place.x, place.y + std::round((line - size) / 2)}, size,
            ImGui::GetColorU32(UiColors::kQuiet));
  ImGui::Dummy({size, line});
  ImGui::SameLine(0, ImGui::GetStyle().ItemInnerSpacing.x);
}

}  // namespace gs::app
