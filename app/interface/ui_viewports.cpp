#include "app/interface/base/fonts.h"
#include "app/interface/base/start_layout.h"
#include "app/interface/base/viewport_area.h"
#include "app/interface/ui_state.h"
#include "app/interface/viewport_widgets.h"
#include "app/session/documents/documents.h"
#include "app/settings/user_folders.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace gs::app {
namespace {

constexpr struct LayoutRow {
  ViewportLayout layout;
  const char* id;
  const char* tip;
  int columns, rows;
} kLayouts[] = {
    {ViewportLayout::one, "##one", "One viewport (F6)", 1, 1},
    {ViewportLayout::two, "##two", "Two viewports (F6)", 2, 1},
    {ViewportLayout::four, "##four", "Four viewports (F6)", 2, 2},
};

/// Draws a button with a symbol of the layout.
bool layout_button(const LayoutRow& row, bool on, float scale) {
  const float height = ImGui::GetFrameHeight();
  // The button gets its size from the padding, because its label is empty; the symbol is drawn over it.
  ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, {height * 0.6f, ImGui::GetStyle().FramePadding.y});
  const bool pressed = switch_button(row.id, on);
  ImGui::PopStyleVar();
  const ImVec2 lower = ImGui::GetItemRectMin(), upper = ImGui::GetItemRectMax();
  const ImVec2 half(std::round(7 * scale), std::round(5 * scale));
  const ImVec2 center(std::round((lower.x + upper.x) / 2), std::round((lower.y + upper.y) / 2));
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  const ImU32 color = ImGui::GetColorU32(ImGuiCol_Text);
  const float line = std::max(1.0f, std::round(1.2f * scale));
  draw.AddRect({center.x - half.x, center.y - half.y}, {center.x + half.x + line, center.y + half.y + line}, color, 0,
               0, line);
  if (row.columns > 1)
    draw.AddRectFilled({center.x, center.y - half.y}, {center.x + line, center.y + half.y + line}, color);
  if (row.rows > 1)
    draw.AddRectFilled({center.x - half.x, center.y}, {center.x + half.x + line, center.y + line}, color);
  return pressed;
}

}  // namespace

void UiOverlay::State::layout_buttons(const UiModel& model, UiActions& actions, bool all, bool with_link) {
  if (!all) {
    const ViewportLayout present = model.layout.value_or(ViewportLayout::four);
    for (const LayoutRow& row : kLayouts)
      if (row.layout == present && layout_button(row, false, scale)) actions.layout = next_layout(present);
    tooltip("One, two or four viewports (F6)");
  } else {
    for (const LayoutRow& row : kLayouts) {
      if (row.layout != ViewportLayout::one) ImGui::SameLine(0, 1);
      if (layout_button(row, row.layout == model.layout, scale)) actions.layout = row.layout;
      tooltip(row.tip);
    }
  }
  if (!with_link || model.panes < 2) return;
  ImGui::SameLine(0, 1);
  if (switch_button("Link", model.linked)) actions.run = Action::link;
  tooltip("Link viewports (L)");
}

void ViewportWidgets::viewport_marks(const UiModel& model) const {
  if (model.viewports.size() < 2) return;
  ImDrawList& draw = *ImGui::GetBackgroundDrawList();
  const float line = std::max(1.0f, std::round(scale_));
  for (const UiViewport& viewport : model.viewports) {
    const ViewportArea area = area_of(viewport.place);
    draw.AddRect(area.lower, area.upper, ImGui::GetColorU32(UiColors::kBar), 0, 0, 2 * line);
  }
  for (const UiViewport& viewport : model.viewports) {
    if (!viewport.active) continue;
    const ViewportArea area = area_of(viewport.place);
    draw.AddRect({area.lower.x + line, area.lower.y + line}, {area.upper.x - line, area.upper.y - line},
                 ImGui::GetColorU32(UiColors::kAccent), 0, 0, 2 * line);
  }
}

void ViewportWidgets::loading_line(const UiViewport& viewport, std::size_t index, UiActions& actions) {
  const ViewportArea area = area_of(viewport.place);
  const float thickness = std::round(3 * scale_);
  // Draw a progress bar along the upper edge. It moves while the end is unknown.
  ImDrawList& draw = *ImGui::GetBackgroundDrawList();
  float from = area.lower.x, to = area.lower.x;
  if (viewport.loaded) {
    to += static_cast<float>(*viewport.loaded) * area.width();
    draw.AddRectFilled(area.lower, {area.upper.x, area.lower.y + thickness}, ImGui::GetColorU32(UiColors::kBar));
  } else {
    const float phase = static_cast<float>(std::fmod(now_ * 0.8, 1.0));
    from += (phase * 1.3f - 0.3f) * area.width();
    to = std::min(area.upper.x, from + 0.3f * area.width());
    from = std::max(area.lower.x, from);
  }
  draw.AddRectFilled({from, area.lower.y}, {to, area.lower.y + thickness}, ImGui::GetColorU32(UiColors::kAccent));
  ImGui::SetNextWindowPos({std::floor((area.lower.x + area.upper.x) / 2), area.lower.y + std::round(46 * scale_)},
                          ImGuiCond_Always, {0.5f, 0});
  ImGui::SetNextWindowSizeConstraints({0, 0}, {std::max(area.width() - 16 * scale_, 40.0f), area.height()});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {12 * scale_, 5 * scale_});
  ImGui::Begin(("##loading" + std::to_string(index)).c_str(), nullptr, kLineFlags);
  ImGui::PopStyleVar();
  ImGui::AlignTextToFramePadding();
  text("Loading " + shortened(viewport.loading, 60) + "...");
  ImGui::SameLine();
  if (ImGui::SmallButton("x")) actions.cancel_loading = index;
  tooltips_.show("Stop loading (Esc)");
  ImGui::End();
}

void ViewportWidgets::welcome(const UiViewport& viewport, std::size_t index, const UiModel& model, UiActions& actions) {
  const ViewportArea area = area_of(viewport.place);
  if (area.height() < 3 * ImGui::GetTextLineHeight()) return;
  static constexpr const char* kFirst = "Drop a file here";
  static constexpr const char* kSecond = "or press Ctrl+O to open one.  F1 lists all keys.";
  const float least = ImGui::CalcTextSize(kFirst).x + 24 * scale_;
  if (area.width() < least) return;
  const StartLayout layout = start_layout(viewport.place, model.recent.size(), scale_);
  const ImVec2 unit = units_of_pixel();
  const float middle = layout.thumbnails.empty() ? area.lower.y + area.height() * 0.45f
                                                 : static_cast<float>(layout.top) * unit.y - 45 * scale_;
  ImGui::SetNextWindowPos({(area.lower.x + area.upper.x) / 2, middle}, ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::SetNextWindowSizeConstraints({0, 0}, {area.width(), area.height()});
  ImGui::Begin(("##welcome" + std::to_string(index)).c_str(), nullptr,
               kLineFlags | ImGuiWindowFlags_NoBackground | ImGuiWindowFlags_NoInputs);
  colored_text(UiColors::kOnPicture, kFirst);
  if (area.width() >= ImGui::CalcTextSize(kSecond).x + 24 * scale_) colored_text(UiColors::kQuietOnPicture, kSecond);
  ImGui::End();
  for (std::size_t i = 0; i < layout.thumbnails.size(); ++i)
    recent_card(area_of(layout.thumbnails[i]), "##recent" + std::to_string(index) + "/" + std::to_string(i),
                model.recent[i], actions);
}

void ViewportWidgets::recent_card(const ViewportArea& area, const std::string& id, const std::string& place,
                                  UiActions& actions) {
  const float line = ImGui::GetTextLineHeight();
  ImGui::SetNextWindowPos(area.lower);
  ImGui::SetNextWindowSize({area.width(), area.height() + line + 8 * scale_});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {0, 0});
  ImGui::Begin(id.c_str(), nullptr, (kLineFlags & ~ImGuiWindowFlags_AlwaysAutoResize) | ImGuiWindowFlags_NoBackground);
  ImGui::PopStyleVar();
  if (ImGui::InvisibleButton("##open", {area.width(), area.height() + line + 8 * scale_})) actions.open = place;
  const bool hovered = ImGui::IsItemHovered();
  tooltips_.show(shortened(shown(without_home(place)), 400));
  ImDrawList& draw = *ImGui::GetBackgroundDrawList();  // the window would clip the frame
  draw.AddRect(area.lower, area.upper, ImGui::GetColorU32(hovered ? UiColors::kAccent : UiColors::kQuietOnPicture), 0,
               0, std::max(1.0f, std::round(scale_)));
  const std::string name = shown(file_label(place));
  draw.PushClipRect(area.lower, {area.upper.x, area.upper.y + line + 8 * scale_});
  draw.AddText({area.lower.x, area.upper.y + 5 * scale_}, ImGui::GetColorU32(UiColors::kOnPicture), name.c_str());
  draw.PopClipRect();
  ImGui::End();
}

void ViewportWidgets::first_steps(const UiViewport& viewport, const UiModel& model, UiActions& actions) {
  static constexpr struct {
    const char *keys, *text;
  } kSteps[] = {
      {"Drag, wheel", "turn and zoom; a hand pointer marks sensors to click: the gate, the lantern, the tower"},
      {"Page Down", "next viewpoint; the last ones show a surface, a volume and a rock as streams"},
      {"Drop a file", "or press Ctrl+O to open your own; Ctrl+Shift+P finds commands, F1 lists all keys"},
  };
  const ViewportArea area = area_of(viewport.place);
  float keys = 0, width = 0;
  for (const auto& step : kSteps) keys = std::max(keys, ImGui::CalcTextSize(step.keys).x);
  for (const auto& step : kSteps) width = std::max(width, ImGui::CalcTextSize(step.text).x);
  keys += 16 * scale_;
  const float close = ImGui::CalcTextSize("Got it").x + 2 * ImGui::GetStyle().FramePadding.x;
  width += keys + close + 36 * scale_;
  const float height = 3 * ImGui::GetTextLineHeightWithSpacing() + 12 * scale_;
  if (area.width() < width + 16 * scale_ || area.height() < 3 * height) return;
  ImGui::SetNextWindowPos({area.lower.x + 12 * scale_, area.upper.y - 12 * scale_}, ImGuiCond_Always, {0, 1});
  ImGui::SetNextWindowSize({width, height});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {12 * scale_, 8 * scale_});
  ImGui::SetNextWindowBgAlpha(0.8f);
  ImGui::Begin("##first steps", nullptr, kLineFlags & ~ImGuiWindowFlags_AlwaysAutoResize);
  ImGui::PopStyleVar();
  const float left = ImGui::GetCursorPosX();
  for (const auto& step : kSteps) {
    colored_text(UiColors::kAccent, step.keys);
    ImGui::SameLine(left + keys);
    ImGui::TextUnformatted(step.text);
  }
  ImGui::SetCursorPos({width - close - 8 * scale_, 6 * scale_});
  if (ImGui::SmallButton("Got it")) {
    actions.settings = model.settings;
    actions.settings->first_steps = false;
  }
  tooltips_.show("Hides the first steps; the preferences (Ctrl+,) show them again");
  ImGui::End();
}

}  // namespace gs::app
