#include "app/interface/dock_view.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace gs::app {
namespace {

constexpr ImGuiWindowFlags kAreaFlags = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                        ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus |
                                        ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoNav;
constexpr const char* kAreaNames[kDockSides] = {"##dock-left", "##dock-right", "##dock-bottom"};
constexpr const char* kDividerNames[kDockSides] = {"##divider-left", "##divider-right", "##divider-bottom"};
constexpr const char* kMoveNames[kDockSides] = {"Move left", "Move right", "Move below"};

std::vector<DockSide> first_sides() {
  std::vector<DockSide> sides;
  for (const PanelRow& row : panel_rows()) sides.push_back(row.side);
  return sides;
}

bool begin_area(const char* name, const DockRectangle& place, const ImVec4& color, const ImVec2& padding) {
  ImGui::SetNextWindowPos({place.left, place.top});
  ImGui::SetNextWindowSize({place.width, place.height});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 0);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, {1, 1});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, padding);
  ImGui::PushStyleColor(ImGuiCol_WindowBg, color);
  const bool visible = ImGui::Begin(name, nullptr, kAreaFlags);
  ImGui::PopStyleColor();
  ImGui::PopStyleVar(4);
  return visible;
}

}  // namespace

DockView::DockView() : dock_(first_sides()) {
  for (const PanelRow& row : panel_rows()) panels_.push_back(row.make());
}

void DockView::lay_out(const DockRectangle& whole, float scale) {
  whole_ = whole;
  layout_ = dock_.lay_out(whole, scale);
}

void DockView::build(const PanelFrame& frame, const UiModel& model, UiActions& actions) {
  for (const DockSide side : {DockSide::left, DockSide::right, DockSide::bottom}) {
    const auto index = static_cast<std::size_t>(side);
    if (!layout_.areas[index]) {
      shown_[index].reset();
      continue;
    }
    area(side, frame, model, actions);
    divider(side, frame.scale);
  }
}

bool DockView::close_one() {
  for (const auto& shown : shown_)
    if (shown && panels_[*shown]->close_one()) return true;
  return false;
}

void DockView::area(DockSide side, const PanelFrame& frame, const UiModel& model, UiActions& actions) {
  const auto index = static_cast<std::size_t>(side);
  const float gap = std::round(4 * frame.scale);
  if (begin_area(kAreaNames[index], layout_.areas[index]->place, UiColors::kPanel, {gap, gap}))
    tabs(side, frame, model, actions);
  ImGui::End();
}

void DockView::tabs(DockSide side, const PanelFrame& frame, const UiModel& model, UiActions& actions) {
  const auto index = static_cast<std::size_t>(side);
  std::optional<std::size_t>& shown = shown_[index];
  if (!ImGui::BeginTabBar("##tabs", ImGuiTabBarFlags_Reorderable | ImGuiTabBarFlags_FittingPolicyScroll |
                                        ImGuiTabBarFlags_NoCloseWithMiddleMouseButton))
    return;
  // True if a key or menu changed the front tab. A click changes it in the tab bar, where it is read below.
  const bool told = shown != dock_.front_at(side);
  const std::vector<std::size_t> open = dock_.open_at(side);  // a copy, because closing tabs changes the list
  for (const std::size_t panel : open) {
    const PanelRow& row = panel_rows()[panel];
    const bool front = dock_.is_front(panel);
    bool stays = true;
    const std::string label = std::string(row.title) + "###" + std::string(row.id);
    const ImGuiTabItemFlags flags = told && front ? ImGuiTabItemFlags_SetSelected : ImGuiTabItemFlags_None;
    const bool visible = ImGui::BeginTabItem(label.c_str(), &stays, flags);
    tab_menu(panel);
    if (visible) {
      if (!told || front) shown = panel;
      const float padding = std::round(6 * frame.scale);
      ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {padding, padding});
      if (ImGui::BeginChild("##content", {0, 0}, false, ImGuiWindowFlags_AlwaysUseWindowPadding))
        panels_[panel]->draw(frame, model, actions);
      ImGui::EndChild();
      ImGui::PopStyleVar();
      ImGui::EndTabItem();
    }
    if (!stays) dock_.close(panel);
  }
  if (!told && shown && dock_.is_open(*shown) && dock_.side_of(*shown) == side) dock_.open(*shown);
  ImGui::EndTabBar();
}

void DockView::tab_menu(std::size_t panel) {
  if (!ImGui::BeginPopupContextItem()) return;
  for (std::size_t i = 0; i < kDockSides; ++i) {
    const auto side = static_cast<DockSide>(i);
    if (side != dock_.side_of(panel) && ImGui::MenuItem(kMoveNames[i])) dock_.move(panel, side);
  }
  if (ImGui::MenuItem("Close")) dock_.close(panel);
  ImGui::EndPopup();
}

void DockView::divider(DockSide side, float scale) {
  const auto index = static_cast<std::size_t>(side);
  const DockRectangle& place = layout_.areas[index]->divider;
  const bool upright = side != DockSide::bottom;
  if (begin_area(kDividerNames[index], place, UiColors::kBar, {0, 0}) && place.width >= 1 && place.height >= 1) {
    ImGui::InvisibleButton("##line", {place.width, place.height});
    const float pointer = upright ? ImGui::GetIO().MousePos.x : ImGui::GetIO().MousePos.y;
    const float middle = upright ? place.left + place.width / 2 : place.top + place.height / 2;
    if (ImGui::IsItemActivated()) grabbed_[index] = middle - pointer;
    const bool active = ImGui::IsItemActive();
    if (active && ImGui::IsMouseDragging(ImGuiMouseButton_Left, 0))
      dock_.set_size(side, Dock::size_for(side, pointer + grabbed_[index], whole_, scale));
    if (active || ImGui::IsItemHovered()) {
      ImGui::SetMouseCursor(upright ? ImGuiMouseCursor_ResizeEW : ImGuiMouseCursor_ResizeNS);
      ImGui::GetWindowDrawList()->AddRectFilled({place.left, place.top},
                                                {place.left + place.width, place.top + place.height},
                                                ImGui::GetColorU32(UiColors::kAccent));
    }
  }
  ImGui::End();
}

}  // namespace gs::app
