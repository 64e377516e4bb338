#include "app/inspect/stream_list.h"
#include "app/interface/base/rate_choice.h"
#include "app/interface/base/viewport_area.h"
#include "app/interface/ui_state.h"
#include "app/interface/viewport_widgets.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

// Elements over the viewports: their bars and menus, dividers, and cards for errors.
namespace gs::app {
namespace {

constexpr float kHandle = 8;                            // width of a divider's handle, at scale 1
constexpr float kMinViewport = 96;                      // min width and height of a viewport, at scale 1
constexpr std::size_t kBarLabel = 40, kMenuLabel = 60;  // max bytes of a name

std::string name_of_pane(std::size_t pane, const std::string& label) {
  return std::to_string(pane + 1) + "  " + (label.empty() ? "empty" : label);
}

std::string percent(double share) {
  char buffer[16];
  std::snprintf(buffer, sizeof buffer, "%.0f %%", share * 100);
  return buffer;
}

std::string thousands(std::size_t count) {
  std::string digits = std::to_string(count);
  for (std::size_t i = digits.size(); i > 3; i -= 3) digits.insert(i - 3, " ");
  return digits;
}

// Formats the received rate and the limit: "180 kbit/s of 200 kbit/s".
std::string arriving_text(const UiViewport& viewport) {
  const std::string arriving = readable_rate(viewport.arriving);
  return viewport.rate > 0 ? arriving + " of " + readable_rate(static_cast<double>(viewport.rate)) : arriving;
}

PaneRequest wish(PaneRequest::Kind kind, const UiViewport& viewport, std::size_t other = 0) {
  return {kind, viewport.pane, other, viewport.weight, viewport.rate};
}

}  // namespace

void ViewportWidgets::divider_handles(const UiModel& model, UiActions& actions) {
  const ImVec2 unit = units_of_pixel();
  for (std::size_t i = 0; i < model.dividers.size(); ++i) {
    const SplitDivider& divider = model.dividers[i];
    const ViewportArea line = area_of(divider.place);
    const float handle = std::round(kHandle * scale_);
    const ImVec2 size = divider.upright ? ImVec2(handle, line.height()) : ImVec2(line.width(), handle);
    ImGui::SetNextWindowPos(divider.upright ? ImVec2(line.lower.x - handle / 2, line.lower.y)
                                            : ImVec2(line.lower.x, line.lower.y - handle / 2));
    ImGui::SetNextWindowSize(size);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {0, 0});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, {1, 1});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 0);
    ImGui::Begin(("##divider" + std::to_string(i)).c_str(), nullptr,
                 (kLineFlags & ~ImGuiWindowFlags_AlwaysAutoResize) | ImGuiWindowFlags_NoBackground);
    ImGui::PopStyleVar(3);
    if (size.x >= 1 && size.y >= 1) {
      (void)ImGui::InvisibleButton("##handle", size);
      const bool held = ImGui::IsItemActive();
      if (held || ImGui::IsItemHovered()) {
        ImGui::SetMouseCursor(divider.upright ? ImGuiMouseCursor_ResizeEW : ImGuiMouseCursor_ResizeNS);
        const float half = std::max(1.0f, std::round(1.5f * scale_));
        ImGui::GetForegroundDrawList()->AddRectFilled(
            {line.lower.x - (divider.upright ? half : 0), line.lower.y - (divider.upright ? 0 : half)},
            {line.upper.x + (divider.upright ? half : 0), line.upper.y + (divider.upright ? 0 : half)},
            ImGui::GetColorU32(UiColors::kAccent));
      }
      if (ImGui::IsItemHovered() && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left)) {
        actions.run = Action::even_out;
      } else if ((held || ImGui::IsItemDeactivated()) && ImGui::GetIO().MouseDragMaxDistanceSqr[0] > 1) {
        const ImVec2 pointer = ImGui::GetIO().MousePos;
        actions.divider = {divider,
                           static_cast<int>(std::lround(divider.upright ? pointer.x / unit.x : pointer.y / unit.y)),
                           static_cast<int>(std::lround(kMinViewport * scale_ / unit.x)), !held};
      }
      tooltips_.show("Drag to resize viewports.  Double-click to equalise their sizes");
    }
    ImGui::End();
  }
}

void ViewportWidgets::pane_bar(const UiViewport& viewport, const UiModel& model, UiActions& actions) {
  const ViewportArea area = area_of(viewport.place);
  const float gap = std::round(6 * scale_);
  if (area.width() < 40 * scale_ || area.height() < ImGui::GetFrameHeight() + 2 * gap) return;
  ImGui::SetNextWindowPos({area.lower.x + gap, area.lower.y + gap});
  ImGui::SetNextWindowSizeConstraints({0, 0}, {area.width() - 2 * gap, area.height()});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {6 * scale_, std::round(1 * scale_)});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, {1, 1});
  ImGui::PushStyleColor(ImGuiCol_WindowBg, with_alpha(UiColors::kBar, 0.88f));
  ImGui::Begin(("##pane" + std::to_string(viewport.pane)).c_str(), nullptr, kLineFlags);
  ImGui::PopStyleColor();
  ImGui::PopStyleVar(2);
  ImGui::AlignTextToFramePadding();
  colored_text(viewport.active ? UiColors::kText : UiColors::kQuiet,
               name_of_pane(viewport.pane, shortened(viewport.label, kBarLabel)));
  tooltips_.show("Ctrl+" + std::to_string(viewport.pane + 1) + ": focus this viewport.  Right-click for its menu");
  const bool several = std::count_if(model.viewports.begin(), model.viewports.end(),
                                     [](const UiViewport& one) { return one.vectors > 0; }) > 1;
  if (viewport.vectors > 0 && several) {
    ImGui::SameLine();
    colored_text(UiColors::kQuiet, percent(viewport.vectors));
    tooltips_.show("Share of the vector budget: " + thousands(viewport.budget) + " vectors");
  }
  if ((viewport.reading > 0 && viewport.rate > 0) || viewport.arriving > 0) {
    ImGui::SameLine();
    colored_text(UiColors::kQuiet, arriving_text(viewport));
    tooltips_.show("Rate of received data; the menu sets its limit");
  }
  // Show buttons only in the active or hovered viewport, because buttons cover the picture.
  const bool wanted = viewport.active || area.contains(ImGui::GetIO().MousePos);
  const auto button = [&](const char* id, Icon icon, const std::string& words) {
    const bool pressed = icon_button(id, icon, "");
    tooltips_.show(words);
    return pressed;
  };
  const float needed = ImGui::GetItemRectMax().x - area.lower.x + 5 * icon_button_width("") + 4 * gap;
  if (wanted && needed < area.width()) {
    ImGui::SameLine();
    if (button("right", Icon::split_right, tooltip_of(Action::split_right)))
      actions.pane = wish(PaneRequest::Kind::split_right, viewport);
    ImGui::SameLine(0, 1);
    if (button("below", Icon::split_below, tooltip_of(Action::split_below)))
      actions.pane = wish(PaneRequest::Kind::split_below, viewport);
    ImGui::SameLine(0, 1);
    if (button("maximise", model.maximised ? Icon::restore : Icon::maximise, tooltip_of(Action::maximise)))
      actions.pane = wish(PaneRequest::Kind::maximise, viewport);
  }
  if (wanted) {
    ImGui::SameLine(0, needed < area.width() ? 1 : -1);
    if (button("menu", Icon::menu, "Viewport menu")) ImGui::OpenPopup("##panemenu");
  }
  if (wanted && needed < area.width()) {
    ImGui::SameLine(0, 1);
    if (button("close", Icon::stop, tooltip_of(Action::close_viewport)))
      actions.pane = wish(PaneRequest::Kind::close, viewport);
  }
  if (ImGui::IsWindowHovered() && ImGui::IsMouseReleased(ImGuiMouseButton_Right)) ImGui::OpenPopup("##panemenu");
  pane_menu(viewport, model, actions);
  ImGui::End();
}

void ViewportWidgets::pane_menu(const UiViewport& viewport, const UiModel& model, UiActions& actions) {
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {10 * scale_, 8 * scale_});
  const bool open = ImGui::BeginPopup("##panemenu");
  ImGui::PopStyleVar();
  if (!open) return;
  const auto item = [&](Action action, const char* words, PaneRequest::Kind kind) {
    if (ImGui::MenuItem(words, keys_of(row_of(action)).c_str())) actions.pane = wish(kind, viewport);
  };
  item(Action::split_right, "Split right", PaneRequest::Kind::split_right);
  item(Action::split_below, "Split below", PaneRequest::Kind::split_below);
  item(Action::maximise, model.maximised ? "Show all viewports" : "Maximise", PaneRequest::Kind::maximise);
  if (ImGui::BeginMenu("Swap with", model.pane_labels.size() > 1)) {
    for (const auto& [pane, label] : model.pane_labels)
      if (pane != viewport.pane &&
          ImGui::MenuItem(label_of(name_of_pane(pane, shortened(label, kMenuLabel)), std::to_string(pane)).c_str()))
        actions.pane = wish(PaneRequest::Kind::swap, viewport, pane);
    ImGui::EndMenu();
  }
  item(Action::even_out, "Equalise viewport sizes", PaneRequest::Kind::even_out);
  ImGui::Separator();
  pane_shares(viewport, actions);
  ImGui::Separator();
  item(Action::close_viewport, "Close", PaneRequest::Kind::close);
  ImGui::EndPopup();
}

// Draws the controls of the viewport's weight, its shares of vectors and bandwidth, and its bandwidth limit.
void ViewportWidgets::pane_shares(const UiViewport& viewport, UiActions& actions) {
  colored_text(UiColors::kQuiet, "Weight");
  auto weight = static_cast<float>(viewport.weight);
  ImGui::SetNextItemWidth(180 * scale_);
  if (ImGui::SliderFloat("##weight", &weight, 0.25f, 4, "%.2f times", ImGuiSliderFlags_Logarithmic)) {
    actions.pane = wish(PaneRequest::Kind::weigh, viewport);
    actions.pane->weight = static_cast<double>(std::abs(weight - 1) < 0.04f ? 1.0f : weight);
  }
  tooltips_.show("Multiplies this viewport's share of vectors and bandwidth.  Ctrl+click to type a number");
  text("Vector budget: " +
       (viewport.vectors > 0 ? percent(viewport.vectors) + ", " + thousands(viewport.budget) : std::string("none")));
  const std::string share = viewport.reading > 0 ? percent(viewport.reading) + ", " : "";
  text("Reading: " + (viewport.reading > 0 || viewport.arriving > 0 ? share + readable_rate(viewport.arriving)
                                                                    : std::string("nothing")));
  colored_text(UiColors::kQuiet, "Bandwidth limit");
  if (const auto rate = rate_choice("##rate", viewport.rate, 180 * scale_)) {
    actions.pane = wish(PaneRequest::Kind::limit, viewport);
    actions.pane->rate = *rate;
  }
  tooltips_.show("Limits the network traffic of this viewport (--rate)");
}

void ViewportWidgets::failure_card(const UiViewport& viewport, const UiModel& model, bool log_open,
                                   UiActions& actions) {
  const ViewportArea area = area_of(viewport.place);
  const float gap = std::round(10 * scale_), width = std::min(area.width() - 2 * gap, 460 * scale_);
  if (width < 60 * scale_) return;
  // If a world is displayed, put the card at the lower edge instead of the centre.
  const bool beside = !viewport.label.empty();
  ImGui::SetNextWindowPos({std::floor((area.lower.x + area.upper.x) / 2),
                           beside ? area.upper.y - gap : std::floor((area.lower.y + area.upper.y) / 2)},
                          ImGuiCond_Always, {0.5f, beside ? 1.0f : 0.5f});
  ImGui::SetNextWindowSizeConstraints({std::min(width, 240 * scale_), 0}, {width, area.height() - gap});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {12 * scale_, 8 * scale_});
  ImGui::PushStyleColor(ImGuiCol_Border, UiColors::kError);
  ImGui::Begin(("##failed" + std::to_string(viewport.pane)).c_str(), nullptr, kLineFlags);
  ImGui::PopStyleColor();
  ImGui::PopStyleVar();
  ImGui::PushTextWrapPos(width - 24 * scale_);
  colored_text(UiColors::kError, shortened(viewport.failed, 80) + " cannot be opened");
  text(shortened(viewport.reason, 300));
  ImGui::PopTextWrapPos();
  if (ImGui::Button("Retry")) actions.pane = wish(PaneRequest::Kind::open_again, viewport);
  ImGui::SameLine();
  if (ImGui::Button("Show log") && !log_open) actions.run = Action::log;
  tooltips_.show(tooltip_of(Action::log));
  if (viewport.reason.find("--memory") != std::string::npos) {
    ImGui::SameLine();
    if (ImGui::Button("Raise memory limit")) actions.run = Action::preferences;
    tooltips_.show("Opens the preferences, which set the memory limit of a file");
  }
  ImGui::SameLine();
  const bool goes = viewport.label.empty() && model.panes > 1;
  if (ImGui::Button("Close"))
    actions.pane = wish(goes ? PaneRequest::Kind::close : PaneRequest::Kind::dismiss, viewport);
  tooltips_.show(goes ? "Close this viewport" : "Close this message");
  ImGui::End();
}

void ViewportWidgets::stopped_card(const UiViewport& viewport, bool log_open, UiActions& actions) {
  const ViewportArea area = area_of(viewport.place);
  const float gap = std::round(10 * scale_), width = std::min(area.width() - 2 * gap, 460 * scale_);
  if (width < 60 * scale_) return;
  // The world stays visible and can be walked through.
  ImGui::SetNextWindowPos({std::floor((area.lower.x + area.upper.x) / 2), area.upper.y - gap}, ImGuiCond_Always,
                          {0.5f, 1.0f});
  ImGui::SetNextWindowSizeConstraints({std::min(width, 240 * scale_), 0}, {width, area.height() - gap});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {12 * scale_, 8 * scale_});
  ImGui::PushStyleColor(ImGuiCol_Border, UiColors::kError);
  ImGui::Begin(("##stopped" + std::to_string(viewport.pane)).c_str(), nullptr, kLineFlags);
  ImGui::PopStyleColor();
  ImGui::PopStyleVar();
  ImGui::PushTextWrapPos(width - 24 * scale_);
  colored_text(UiColors::kError, "This world stopped responding");
  text(shortened(viewport.stopped, 200));
  ImGui::PopTextWrapPos();
  if (ImGui::Button("Reload")) actions.pane = wish(PaneRequest::Kind::open_again, viewport);
  tooltips_.show("Open the world again, with its Scripts");
  ImGui::SameLine();
  if (ImGui::Button("Show log") && !log_open) actions.run = Action::log;
  tooltips_.show(tooltip_of(Action::log));
  ImGui::SameLine();
  if (ImGui::Button("Close")) actions.pane = wish(PaneRequest::Kind::close, viewport);
  tooltips_.show("Close this world");
  ImGui::End();
}

}  // namespace gs::app
