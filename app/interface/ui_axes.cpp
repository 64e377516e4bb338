#include "app/interface/ui_state.h"
#include "app/interface/viewport_widgets.h"

#include <imgui.h>

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

// Axes widget in a corner of the picture, and the label with the size of the grid squares.
namespace gs::app {
namespace {

struct AxisEnd {
  glm::vec3 along;
  glm::vec3 seen;  // in view space: right, up, towards the viewer
  int axis = 0;
  bool positive = true;
};

constexpr ImU32 kAxisColors[] = {IM_COL32(226, 84, 84, 255), IM_COL32(112, 190, 84, 255), IM_COL32(88, 144, 240, 255)};
constexpr const char* kAxisNames[] = {"X", "Y", "Z"};
constexpr float kAxesHalf = 3.2f;  // half size of the widget, in text heights

ImVec2 in_units(const glm::vec2& pixels) {
  const ImVec2 scale = ImGui::GetIO().DisplayFramebufferScale;
  return {pixels.x / std::max(scale.x, 0.01f), pixels.y / std::max(scale.y, 0.01f)};
}

/// Returns the action that views the world from the direction of `along`.
Action side_along(const glm::vec3& along, const Upright& upright) {
  const std::pair<glm::vec3, Action> sides[] = {
      {upright.front, Action::side_front},   {-upright.front, Action::side_back}, {-upright.right(), Action::side_left},
      {upright.right(), Action::side_right}, {upright.up, Action::side_top},      {-upright.up, Action::side_bottom}};
  return std::max_element(
             std::begin(sides), std::end(sides),
             [&](const auto& a, const auto& b) { return glm::dot(a.first, along) < glm::dot(b.first, along); })
      ->second;
}

std::array<AxisEnd, 6> axis_ends(const Pose& pose) {
  const glm::quat viewer_from_world = glm::conjugate(pose.orientation);
  std::array<AxisEnd, 6> ends;
  for (int i = 0; i < 6; ++i) {
    glm::vec3 along(0);
    along[i / 2] = i % 2 == 0 ? 1.0f : -1.0f;
    ends[static_cast<std::size_t>(i)] = {along, viewer_from_world * along, i / 2, i % 2 == 0};
  }
  std::sort(ends.begin(), ends.end(), [](const AxisEnd& a, const AxisEnd& b) { return a.seen.z < b.seen.z; });
  return ends;
}

void draw_axis(ImDrawList& draw, const AxisEnd& end, const ImVec2& center, const ImVec2& at, float dot, float scale) {
  const ImU32 color = kAxisColors[end.axis];
  if (!end.positive) return draw.AddCircleFilled(at, dot * 0.8f, (color & ~IM_COL32_A_MASK) | IM_COL32(0, 0, 0, 110));
  draw.AddLine(center, at, color, 2 * scale);
  draw.AddCircleFilled(at, dot, color);
  const ImVec2 text = ImGui::CalcTextSize(kAxisNames[end.axis]);
  draw.AddText({at.x - text.x / 2, at.y - text.y / 2}, IM_COL32(16, 17, 20, 255), kAxisNames[end.axis]);
}

}  // namespace

void ViewportWidgets::grid_line(const UiViewport& viewport, const std::string& grid) {
  const float em = ImGui::GetFontSize();
  const Viewport& place = viewport.place;
  const ImVec2 lower = in_units(glm::vec2(place.left, place.top + place.height));
  if (grid.empty() || in_units(place.size()).x <= 12 * em) return;
  ImDrawList& draw = *ImGui::GetBackgroundDrawList();
  const ImVec2 at(lower.x + (viewport.axes ? 2 * kAxesHalf * em : 0) + 0.8f * em, lower.y - 2 * em);
  draw.AddText({at.x + 1, at.y + 1}, IM_COL32(0, 0, 0, 160), grid.c_str());
  draw.AddText(at, ImGui::GetColorU32(UiColors::kOnPicture), grid.c_str());
}

void ViewportWidgets::axes_widget(const UiViewport& viewport, const UiModel& model, UiActions& actions) {
  if (viewport.active && model.has_world) grid_line(viewport, model.grid_text);
  const float em = ImGui::GetFontSize(), half = kAxesHalf * em;
  const Viewport& place = viewport.place;
  const ImVec2 lower = in_units(glm::vec2(place.left, place.top + place.height)), size = in_units(place.size());
  if (!viewport.axes || size.x < 6 * half || size.y < 5 * half) return;
  const ImVec2 center(lower.x + half, lower.y - half);
  const float length = half - 0.8f * em, dot = 0.58f * em;
  const auto place_of = [&](const AxisEnd& end) {
    return ImVec2(center.x + end.seen.x * length, center.y - end.seen.y * length);
  };
  if (!viewport.active) {
    // Draw without buttons, because a click there activates the viewport.
    for (const AxisEnd& end : axis_ends(viewport.pose))
      draw_axis(*ImGui::GetBackgroundDrawList(), end, center, place_of(end), dot, scale_);
    return;
  }
  ImGui::SetNextWindowPos({lower.x, lower.y - 2 * half});
  ImGui::SetNextWindowSize({2 * half, 2 * half});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {0, 0});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, {1, 1});
  ImGui::Begin("##axes", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_NoBackground | ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoFocusOnAppearing |
                   ImGuiWindowFlags_NoBringToFrontOnFocus);
  ImGui::PopStyleVar(2);
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  for (const AxisEnd& end : axis_ends(viewport.pose)) {
    const ImVec2 at = place_of(end);
    ImGui::SetCursorScreenPos({at.x - dot, at.y - dot});
    const std::string name = std::string(end.positive ? "+" : "-") + kAxisNames[end.axis];
    ImGui::PushID(name.c_str());
    if (ImGui::InvisibleButton("##end", {2 * dot, 2 * dot})) actions.run = side_along(end.along, model.upright);
    const bool hovered = ImGui::IsItemHovered();
    tooltips_.show("From " + name);
    ImGui::PopID();
    draw_axis(draw, end, center, at, dot, scale_);
    if (hovered) draw.AddCircle(at, dot + scale_, ImGui::GetColorU32(UiColors::kOnPicture), 0, 1.5f * scale_);
  }
  ImGui::End();
}

}  // namespace gs::app
