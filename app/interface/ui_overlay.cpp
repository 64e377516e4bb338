#include "app/interface/ui_overlay.h"

#include "app/interface/ui_state.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace gs::app {
namespace {

constexpr int kFramesToFocus = 4;  // until a text field that appears has the keys, at most

}  // namespace

bool UiOverlay::State::toggle_panel(Action action) {
  const auto panel = panel_of(action);
  if (panel) dock.dock().toggle(*panel);
  return panel.has_value();
}

bool UiOverlay::State::panel_shows(Action action) const {
  const auto panel = panel_of(action);
  return panel && dock.dock().is_front(*panel);
}

UiOverlay::UiOverlay(std::unique_ptr<InterfaceBackend> backend, float scale) : state_(std::make_unique<State>()) {
  state_->scale = scale;
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;
  set_style(scale);
  load_font(scale);
  state_->backend = std::move(backend);
  state_->backend->begin();
}

UiOverlay::~UiOverlay() {
  state_->backend.reset();
  ImGui::DestroyContext();
}

void UiOverlay::begin_frame(double now, const std::vector<WindowEvent>& events) {
  state_->now = now;
  state_->notices.expire(now);
  state_->backend->begin_frame();
  state_->input.add(events);
  if (ImGui::GetIO().WantTextInput) state_->text_waits = 0;
  if (state_->text_waits > 0) --state_->text_waits;
  state_->input.apply(ImGui::GetIO(), state_->text_waits > 0);
  ImGui::NewFrame();
}

UiActions UiOverlay::build(const UiModel& model) {
  UiActions actions;
  State& state = *state_;
  state.tooltips.begin(state.now, !state.open_panel);
  state.top_bar(model, actions);
  if (state.statistics) state.status_bar(model);
  state.dock.build({state.scale, state.tooltips}, model, actions);
  if (state.help) state.help_panel();
  if (state.open_panel) state.open_files_panel(actions);
  state.question_panel(model, actions);
  state.viewport_marks(model);
  state.tool_marks(model);
  for (std::size_t i = 0; i < model.viewports.size(); ++i) {
    const UiViewport& viewport = model.viewports[i];
    if (!viewport.loading.empty())
      state.loading_line(viewport, i, actions);
    else if (viewport.label.empty() && !state.open_panel)
      state.welcome(viewport, i);
  }
  state.notice_lines();
  if (model.travel_anchor) state.travel_mark(model);
  if (model.over_sensor && !ImGui::GetIO().WantCaptureMouse) {
    ImGui::SetMouseCursor(ImGuiMouseCursor_Hand);
    if (!model.link.empty()) ImGui::SetTooltip("%s", model.link.c_str());
  }
  state.tooltips.end();
  return actions;
}

void UiOverlay::draw() {
  ImGui::Render();
  state_->backend->draw();
}

bool UiOverlay::wants_pointer() const { return ImGui::GetIO().WantCaptureMouse; }
bool UiOverlay::wants_keys() const { return ImGui::GetIO().WantTextInput || state_->text_waits > 0; }
bool UiOverlay::has_input_left() const { return state_->input.waiting(); }

Viewport UiOverlay::picture_area(const glm::ivec2& framebuffer) {
  State& state = *state_;
  const ImVec2 pixels = ImGui::GetIO().DisplayFramebufferScale;
  const float x = std::max(pixels.x, 0.01f), y = std::max(pixels.y, 0.01f), top = state.top_bar_height();
  const float width = static_cast<float>(framebuffer.x) / x, height = static_cast<float>(framebuffer.y) / y;
  state.dock.lay_out({0, top, width, std::max(1.0f, height - top - state.status_bar_height())}, state.scale);
  const DockRectangle& picture = state.dock.layout().picture;
  Viewport area;
  area.left = std::clamp(static_cast<int>(std::lround(picture.left * x)), 0, std::max(0, framebuffer.x - 1));
  area.top = std::clamp(static_cast<int>(std::ceil(picture.top * y)), 0, std::max(0, framebuffer.y - 1));
  const auto right = static_cast<int>(std::lround((picture.left + picture.width) * x));
  const auto bottom = static_cast<int>(std::floor((picture.top + picture.height) * y));
  area.width = std::max(1, std::min(right, framebuffer.x) - area.left);
  area.height = std::max(1, std::min(bottom, framebuffer.y) - area.top);
  return area;
}

std::optional<double> UiOverlay::next_change() const {
  std::optional<double> next;
  if (const auto notice = state_->notices.next()) next = std::max(0.0, *notice - state_->now);
  if (const auto tooltip = state_->tooltips.next()) next = std::min(next.value_or(*tooltip), *tooltip);
  if (ImGui::GetIO().WantTextInput) next = std::min(next.value_or(0.4), 0.4);  // the caret blinks
  return next;
}

bool UiOverlay::run(Action action) {
  State& state = *state_;
  switch (action) {
    case Action::open_file:
      state.open_panel = state.open_panel_appears = true;
      state.text_waits = kFramesToFocus;
      state.help = false;
      return true;
    case Action::help:
      state.help = !state.help;
      return true;
    case Action::statistics:
      state.statistics = !state.statistics;
      return true;
    case Action::close:
      return close_one();
    default:
      return state.toggle_panel(action);
  }
}

void UiOverlay::show_log() {
  if (const auto log = panel_of(Action::log)) state_->dock.dock().open(*log);
}

void UiOverlay::show_notice(std::string text, bool is_error) {
  state_->notices.show(shortened(text, 400), is_error, state_->now);
}

void UiOverlay::clear_notices() { state_->notices.clear(); }

void UiOverlay::open_ended(const std::string& problem) {
  State& state = *state_;
  if (!std::exchange(state.opening, false)) return;
  state.open_problem = problem;
  if (problem.empty()) {
    state.open_panel = false;
  } else if (state.open_panel) {
    // What is typed next is another try.
    state.open_panel_appears = true;
    state.text_waits = kFramesToFocus;
  }
}

bool UiOverlay::close_one() {
  if (state_->question) return state_->question_refused = true;
  for (bool* open : {&state_->open_panel, &state_->help}) {
    if (*open) {
      *open = false;
      return true;
    }
  }
  return state_->dock.close_one() || state_->notices.close_one();
}

}  // namespace gs::app
