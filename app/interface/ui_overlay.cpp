#include "app/interface/ui_overlay.h"

#include "app/interface/panels/inspect_panels.h"
#include "app/interface/ui_state.h"
#include "app/interface/viewport_widgets.h"

#include <imgui.h>
#include <imgui_internal.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace gs::app {
namespace {

constexpr int kFramesToFocus = 4;  // max frames until a new text field gets the focus
const std::string kSideNames[kDockSides] = {"left", "right", "bottom"};

}  // namespace

// Applies the theme and the text size. Adds glyphs that the last frame lacked.
void UiOverlay::State::apply_appearance(bool at_first) {
  const float wanted = screen_scale * static_cast<float>(settings.text_size);
  if (!at_first && wanted != scale) menus_width = 0;
  if (at_first || wanted != scale || settings.theme != theme) {
    scale = wanted;
    theme = settings.theme;
    set_style(theme, scale);
    fonts->set_size(kFontSize * scale);
  }
  if (!fonts->stale()) return;
  fonts->build();
  if (backend) backend->fonts_changed();
}

UiOverlay::UiOverlay(std::unique_ptr<InterfaceBackend> backend, float scale, const UserSettings& settings)
    : state_(std::make_unique<State>()) {
  state_->settings = settings;
  state_->screen_scale = scale;
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;
  state_->fonts = std::make_unique<InterfaceFonts>();
  state_->apply_appearance(true);
  state_->backend = std::move(backend);
  state_->backend->begin();
}

UiOverlay::~UiOverlay() {
  state_->backend.reset();
  state_->fonts.reset();
  ImGui::DestroyContext();
}

void UiOverlay::begin_frame(double now, const std::vector<WindowEvent>& events) {
  state_->now = now;
  state_->notices.expire(now);
  state_->apply_appearance(false);
  state_->backend->begin_frame();
  state_->input.add(events);
  for (const WindowEvent& event : events)
    if (event.kind == WindowEvent::Kind::button_down || event.kind == WindowEvent::Kind::key_down)
      state_->address.opening.clear();
  // A field that lost the focus remains active in Dear ImGui for one frame. Only a newly active field ends the wait.
  const bool had_text = std::exchange(state_->has_text, ImGui::GetIO().WantTextInput);
  if (state_->has_text && !had_text) state_->text_waits = 0;
  if (state_->text_waits > 0) --state_->text_waits;
  state_->input.apply(ImGui::GetIO(), state_->text_waits > 0);
  ImGui::NewFrame();
}

UiActions UiOverlay::build(const UiModel& model) {
  UiActions actions;
  State& state = *state_;
  state.settings = model.settings;
  state.to_restore = model.to_restore.size();
  state.tooltips.begin(state.now, !state.dialog.open && !state.palette.open);
  State::MenuBar(state).draw(model, actions);
  state.tool_bar(model, actions);
  state.restore_line(model, actions);
  if (state.statistics) state.status_bar(model);
  state.dock.build({state.scale, state.tooltips}, model, actions);
  if (state.help) state.help_panel();
  state.open_dialog(model, actions);
  state.preferences_dialog(model, actions);
  state.palette_dialog(model, actions);
  state.question_panel(model, actions);
  ViewportWidgets widgets(state.scale, state.now, state.tooltips);
  widgets.viewport_marks(model);
  if (model.inspection) draw_marks(*model.inspection);
  widgets.tool_marks(model);
  for (const UiViewport& viewport : model.viewports) widgets.axes_widget(viewport, model, actions);
  widgets.divider_handles(model, actions);
  for (std::size_t i = 0; i < model.viewports.size(); ++i) {
    const UiViewport& viewport = model.viewports[i];
    if (model.panes > 1) widgets.pane_bar(viewport, model, actions);
    // A playing series always loads its next file; do not show that.
    const bool plays = viewport.active && model.tools.playing;
    if (!viewport.loading.empty() && !plays)
      widgets.loading_line(viewport, i, actions);
    else if (!viewport.failed.empty())
      widgets.failure_card(viewport, model, state.is_on(Action::log, model), actions);
    else if (!viewport.stopped.empty())
      widgets.stopped_card(viewport, state.is_on(Action::log, model), actions);
    else if (viewport.label.empty() && !state.dialog.open)
      widgets.welcome(viewport, i, model, actions);
    // The line of the ruler uses the position of the first steps.
    else if (model.first_steps && viewport.active && !state.dialog.open && !model.tools.measuring)
      widgets.first_steps(viewport, model, actions);
  }
  state.notice_lines();
  if (model.travel_anchor) widgets.travel_mark(model);
  if (!model.tools.slice_edge.empty() && !ImGui::GetIO().WantCaptureMouse) ImGui::SetMouseCursor(ImGuiMouseCursor_Hand);
  if (model.over_sensor && !ImGui::GetIO().WantCaptureMouse) {
    ImGui::SetMouseCursor(ImGuiMouseCursor_Hand);
    if (!model.link.empty()) ImGui::SetTooltip("%s", shown(model.link).c_str());
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
  const float x = std::max(pixels.x, 0.01f), y = std::max(pixels.y, 0.01f), top = state.top_height();
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

std::string UiOverlay::clipboard() const {
  const char* text = ImGui::GetClipboardText();
  return text ? text : "";
}

void UiOverlay::set_clipboard(const std::string& text) { ImGui::SetClipboardText(text.c_str()); }

bool UiOverlay::run(Action action) {
  State& state = *state_;
  switch (action) {
    case Action::open_file:
      show_open_dialog();
      return true;
    case Action::palette:
      if (state.palette.open)
        state.palette = {};
      else
        state.show_palette();
      return true;
    case Action::address:
      state.address.wanted = true;
      state.text_waits = kFramesToFocus;
      return true;
    case Action::preferences:
      state.preferences = !state.preferences;
      return true;
    case Action::help:
      state.help = !state.help;
      return true;
    case Action::statistics:
      state.statistics = !state.statistics;
      return true;
    default:
      if (const auto panel = panel_of(action)) {
        state.dock.dock().toggle(*panel);
        return true;
      }
      return false;
  }
}

void UiOverlay::show_open_dialog() {
  State& state = *state_;
  if (std::exchange(state.dialog.saves, false)) state.dialog.typed = typed_path(state.dialog.typed).before;
  state.dialog.open = state.dialog.appears = true;
  state.dialog.problem.clear();
  state.text_waits = kFramesToFocus;
  state.help = false;
}

void UiOverlay::show_save_dialog(const std::string& path, const std::string& formats) {
  show_open_dialog();
  State::OpenDialog& dialog = state_->dialog;
  dialog.saves = true;
  dialog.typed = path;
  dialog.formats = formats;
  dialog.chosen.reset();
}

void UiOverlay::show_panel(Action toggle) {
  if (const auto panel = panel_of(toggle)) state_->dock.dock().open(*panel);
}

void UiOverlay::show_notice(std::string text, bool is_error, std::string_view about) {
  state_->notices.show(shortened(text, 400), is_error, state_->now, about);
}

void UiOverlay::clear_notices() { state_->notices.clear(); }

void UiOverlay::open_ended(const std::string& problem) {
  State::Address& bar = state_->address;
  if (const std::string opened = std::exchange(bar.opening, {}); !opened.empty() && !problem.empty()) {
    bar.retried = opened;
    bar.wanted = true;
    state_->text_waits = kFramesToFocus;
  }
  State::OpenDialog& dialog = state_->dialog;
  if (!std::exchange(dialog.opening, false)) return;
  dialog.problem = problem;
  if (problem.empty()) {
    dialog.open = false;
    dialog.typed = typed_path(dialog.typed).before;  // keep the folder for the next dialog
  } else if (dialog.open) {
    // Focus the path again, so that the user can correct it.
    dialog.wanted = true;
    state_->text_waits = kFramesToFocus;
  }
}

bool UiOverlay::close_over() {
  State& state = *state_;
  if (state.question) return state.question_refused = true;
  if (ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopup)) {  // a menu or list is open
    ImGui::ClosePopupToLevel(0, true);
    return true;
  }
  if (state.palette.open) {
    state.palette = {};
    return true;
  }
  for (bool* open : {&state.dialog.open, &state.preferences, &state.help})
    if (std::exchange(*open, false)) return true;
  return state.address.active;  // Dear ImGui itself unfocuses the address field
}

bool UiOverlay::close_beside() { return state_->dock.close_one() || state_->notices.close_one(); }

std::vector<PanelMemory> UiOverlay::panels() const {
  std::vector<PanelMemory> result;
  const Dock& dock = state_->dock.dock();
  const auto add = [&](std::size_t panel) {
    result.push_back({std::string(panel_rows()[panel].id), kSideNames[static_cast<std::size_t>(dock.side_of(panel))],
                      dock.is_open(panel), dock.is_front(panel)});
  };
  for (std::size_t side = 0; side < kDockSides; ++side)
    for (const std::size_t panel : dock.open_at(static_cast<DockSide>(side))) add(panel);
  for (std::size_t panel = 0; panel < dock.panels(); ++panel)
    if (!dock.is_open(panel)) add(panel);
  return result;
}

std::array<double, kDockSides> UiOverlay::areas() const {
  std::array<double, kDockSides> result{};
  for (std::size_t side = 0; side < kDockSides; ++side)
    result[side] = static_cast<double>(state_->dock.dock().size(static_cast<DockSide>(side)));
  return result;
}

void UiOverlay::arrange(const std::vector<PanelMemory>& panels, const std::array<double, kDockSides>& areas) {
  Dock& dock = state_->dock.dock();
  for (std::size_t side = 0; side < kDockSides; ++side)
    if (areas[side] > 0) dock.set_size(static_cast<DockSide>(side), static_cast<float>(areas[side]));
  std::vector<std::size_t> fronts;
  for (const PanelMemory& one : panels) {
    const auto panel = find_panel(one.panel);
    const auto side = std::find(std::begin(kSideNames), std::end(kSideNames), one.side);
    if (!panel) continue;
    if (side != std::end(kSideNames)) dock.move(*panel, static_cast<DockSide>(side - std::begin(kSideNames)));
    if (one.open) dock.open(*panel);
    if (one.open && one.front) fronts.push_back(*panel);
  }
  for (const std::size_t panel : fronts) dock.open(panel);
}

}  // namespace gs::app
