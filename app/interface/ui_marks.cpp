#include "app/interface/base/fonts.h"
#include "app/interface/ui_state.h"
#include "app/interface/viewport_widgets.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace gs::app {
namespace {

constexpr ImU32 kMarkColor = IM_COL32(255, 214, 64, 255), kMarkShade = IM_COL32(16, 17, 20, 200);

struct MarkArea {
  ImVec2 from, to;
};

ImVec2 units_of(const glm::vec2& pixels) {
  const ImVec2 scale = ImGui::GetIO().DisplayFramebufferScale;
  return {pixels.x / std::max(scale.x, 0.01f), pixels.y / std::max(scale.y, 0.01f)};
}

void draw_label(ImDrawList& draw, const ImVec2& at, const std::string& label, float scale) {
  const ImVec2 size = ImGui::CalcTextSize(label.c_str());
  draw.AddRectFilled({at.x - 4 * scale, at.y - 2 * scale}, {at.x + size.x + 4 * scale, at.y + size.y + 2 * scale},
                     kMarkShade, 3 * scale);
  draw.AddText(at, ImGui::GetColorU32(UiColors::kOnPicture), label.c_str());
}

void draw_ruler(ImDrawList& draw, const UiTools& tools, float scale) {
  for (std::size_t i = 0; i + 1 < tools.points.size(); ++i) {
    if (!tools.points[i] || !tools.points[i + 1]) continue;
    const ImVec2 from = units_of(*tools.points[i]), to = units_of(*tools.points[i + 1]);
    draw.AddLine(from, to, kMarkShade, 4 * scale);
    draw.AddLine(from, to, kMarkColor, 1.8f * scale);
  }
  for (const auto& point : tools.points) {
    if (!point) continue;
    draw.AddCircleFilled(units_of(*point), 4.5f * scale, kMarkShade);
    draw.AddCircleFilled(units_of(*point), 3 * scale, kMarkColor);
  }
  for (std::size_t i = 0; i < tools.legs.size(); ++i) {
    if (!tools.points[i] || !tools.points[i + 1]) continue;
    const ImVec2 from = units_of(*tools.points[i]), to = units_of(*tools.points[i + 1]);
    draw_label(draw, {(from.x + to.x) / 2 + 8 * scale, (from.y + to.y) / 2 - 8 * scale}, tools.legs[i], scale);
  }
}

void draw_crop(ImDrawList& draw, const UiSplats& splats, float scale) {
  for (const auto& [from, to] : splats.edges) draw.AddLine(units_of(from), units_of(to), kMarkColor, 1.5f * scale);
}

void draw_slice_edge(ImDrawList& draw, const UiTools& tools, float scale) {
  for (std::size_t i = 0; i < tools.slice_edge.size(); ++i)
    draw.AddLine(units_of(tools.slice_edge[i]), units_of(tools.slice_edge[(i + 1) % tools.slice_edge.size()]),
                 kMarkColor, 2.5f * scale);
}

void draw_bar(ImDrawList& draw, const ColorBar& bar, const MarkArea& area, float scale) {
  const float em = ImGui::GetFontSize(), width = 1.1f * em;
  const float height = std::min((area.to.y - area.from.y) * 0.5f, 20 * em);
  if (height < 4 * em) return;
  const auto ticks = nice_ticks(bar.range, static_cast<std::size_t>(std::max(2.0f, height / (2 * em))));
  float labels = 0;
  for (const Tick& tick : ticks) labels = std::max(labels, ImGui::CalcTextSize(tick.label.c_str()).x);
  const std::string title_text = shown(bar.title);
  const float title = title_text.empty() ? 0 : ImGui::CalcTextSize(title_text.c_str()).x;
  const ImVec2 size(std::max(width + 0.9f * em + labels, title) + 1.2f * em,
                    height + (bar.title.empty() ? 1.4f : 2.9f) * em);
  if (size.x > area.to.x - area.from.x) return;
  const ImVec2 corner(area.to.x - size.x - 10 * scale, (area.from.y + area.to.y - size.y) / 2);
  draw.AddRectFilled(corner, {corner.x + size.x, corner.y + size.y}, kMarkShade, 4 * scale);
  ImVec2 at(corner.x + 0.6f * em, corner.y + 0.7f * em);
  const ImU32 color = ImGui::GetColorU32(UiColors::kOnPicture);
  if (!bar.title.empty()) {
    draw.AddText({at.x, at.y - 0.3f * em}, color, title_text.c_str());
    at.y += 1.5f * em;
  }
  for (float y = 0; y < height; ++y) {
    const qnv::Rgb8 c = transfer_at(bar.colors, 1 - (y + 0.5f) / height).color;
    draw.AddRectFilled({at.x, at.y + y}, {at.x + width, at.y + y + 1}, IM_COL32(c.r, c.g, c.b, 255));
  }
  for (const Tick& tick : ticks) {
    const float y = at.y + height * static_cast<float>(1 - tick.place);
    draw.AddLine({at.x + width, y}, {at.x + width + 0.3f * em, y}, color, std::max(1.0f, scale));
    draw.AddText({at.x + width + 0.55f * em, y - 0.5f * em}, color, tick.label.c_str());
  }
}

}  // namespace

// Draws ruler and colour bar over the active viewport.
void ViewportWidgets::tool_marks(const UiModel& model) const {
  const auto active = std::find_if(model.viewports.begin(), model.viewports.end(),
                                   [](const UiViewport& viewport) { return viewport.active; });
  if (active == model.viewports.end()) return;
  const Viewport& place = active->place;
  const MarkArea area{units_of(glm::vec2(place.left, place.top)),
                      units_of(glm::vec2(place.left + place.width, place.top + place.height))};
  ImDrawList& draw = *ImGui::GetBackgroundDrawList();
  draw.PushClipRect(area.from, area.to, true);
  if (model.tools.color_bar && model.tools.bar) draw_bar(draw, *model.tools.bar, area, scale_);
  draw_crop(draw, model.splats, scale_);
  draw_slice_edge(draw, model.tools, scale_);
  draw_ruler(draw, model.tools, scale_);
  if (model.tools.measuring)
    draw_label(draw, {area.from.x + 12 * scale_, area.to.y - 2 * ImGui::GetFontSize()}, model.tools.measured, scale_);
  draw.PopClipRect();
}

}  // namespace gs::app
