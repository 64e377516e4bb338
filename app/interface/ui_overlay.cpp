#include "app/interface/ui_overlay.h"

#include "app/interface/ui_state.h"

#include <imgui.h>
#include <imgui_impl_glfw.h>
#include <imgui_impl_opengl3.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

namespace gs::app {
namespace {

constexpr float kFontSize = 14.5f;
constexpr double kTooltipDelay = 0.5;  // seconds
constexpr int kFramesToFocus = 4;      // until a text field that appears has the keys, at most

// Where the free desktops keep a font with Latin, Greek and Cyrillic letters.
constexpr const char* kFonts[] = {
    "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
    "/usr/share/fonts/TTF/DejaVuSans.ttf",
    "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf",
    "/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf",
    "/usr/share/fonts/truetype/noto/NotoSans-Regular.ttf",
};

void load_font(float scale) {
  static constexpr ImWchar kRanges[] = {0x0020, 0x024F, 0x0370, 0x052F, 0x2010, 0x2044, 0x2190, 0x21FF, 0};
  ImFontAtlas& fonts = *ImGui::GetIO().Fonts;
  ImFontConfig config;
  config.OversampleH = 2;
  const float size = std::round(kFontSize * scale);
  for (const char* path : kFonts) {
    std::error_code error;
    if (std::filesystem::is_regular_file(path, error) && fonts.AddFontFromFileTTF(path, size, &config, kRanges)) return;
  }
  config.SizePixels = std::round(13 * scale);
  fonts.AddFontDefault(&config);
}

ImVec4 with_alpha(ImVec4 color, float alpha) {
  color.w = alpha;
  return color;
}

void set_style(float scale) {
  ImGui::StyleColorsDark();
  ImGuiStyle& style = ImGui::GetStyle();
  style.WindowRounding = 6;
  style.PopupRounding = style.FrameRounding = style.GrabRounding = style.ScrollbarRounding = 4;
  style.WindowBorderSize = style.PopupBorderSize = 1;
  style.FrameBorderSize = 0;
  style.WindowPadding = {12, 10};
  style.FramePadding = {9, 4};
  style.ItemSpacing = {6, 6};
  style.ItemInnerSpacing = {6, 4};
  style.ScrollbarSize = 12;
  style.DisabledAlpha = 0.4f;
  const ImVec4 lighter(1, 1, 1, 1);
  const std::pair<ImGuiCol, ImVec4> colors[] = {
      {ImGuiCol_Text, UiColors::kText},
      {ImGuiCol_TextDisabled, UiColors::kQuiet},
      {ImGuiCol_WindowBg, UiColors::kPanel},
      {ImGuiCol_PopupBg, UiColors::kPanel},
      {ImGuiCol_Border, with_alpha(lighter, 0.09f)},
      {ImGuiCol_FrameBg, with_alpha(lighter, 0.07f)},
      {ImGuiCol_FrameBgHovered, with_alpha(lighter, 0.12f)},
      {ImGuiCol_FrameBgActive, with_alpha(lighter, 0.16f)},
      {ImGuiCol_Button, with_alpha(lighter, 0.07f)},
      {ImGuiCol_ButtonHovered, with_alpha(lighter, 0.15f)},
      {ImGuiCol_ButtonActive, with_alpha(UiColors::kAccent, 0.7f)},
      {ImGuiCol_Header, with_alpha(UiColors::kAccent, 0.35f)},
      {ImGuiCol_HeaderHovered, with_alpha(lighter, 0.12f)},
      {ImGuiCol_HeaderActive, with_alpha(UiColors::kAccent, 0.5f)},
      {ImGuiCol_CheckMark, UiColors::kAccent},
      {ImGuiCol_Separator, with_alpha(lighter, 0.12f)},
      {ImGuiCol_TitleBg, UiColors::kBar},
      {ImGuiCol_TitleBgActive, UiColors::kBar},
      {ImGuiCol_PlotHistogram, UiColors::kAccent},
      {ImGuiCol_TextSelectedBg, with_alpha(UiColors::kAccent, 0.5f)},
      {ImGuiCol_TableRowBgAlt, with_alpha(lighter, 0.025f)},
  };
  for (const auto& [index, color] : colors) style.Colors[index] = color;
  style.ScaleAllSizes(scale);
}

}  // namespace

ImVec4 color_of(vrml::Severity severity) {
  switch (severity) {
    case vrml::Severity::error:
      return UiColors::kError;
    case vrml::Severity::warning:
      return UiColors::kWarning;
    case vrml::Severity::note:
      break;
  }
  return UiColors::kNote;
}

void text(std::string_view text) { ImGui::TextUnformatted(text.data(), text.data() + text.size()); }

void colored_text(const ImVec4& color, std::string_view string) {
  ImGui::PushStyleColor(ImGuiCol_Text, color);
  text(string);
  ImGui::PopStyleColor();
}

void UiOverlay::State::tooltip(std::string_view string) {
  if (!ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) return;
  const ImVec2 item = ImGui::GetItemRectMin();
  if (item.x != hovered.x || item.y != hovered.y) {
    hovered = item;
    hovered_since = now;
  }
  hovers = true;
  if (now - hovered_since < kTooltipDelay || open_panel) return;
  ImGui::BeginTooltip();
  ImGui::PushTextWrapPos(ImGui::GetFontSize() * 32);
  text(string);
  ImGui::PopTextWrapPos();
  ImGui::EndTooltip();
}

UiOverlay::UiOverlay(GLFWwindow* window, float scale) : state_(std::make_unique<State>()) {
  state_->scale = scale;
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;
  set_style(scale);
  load_font(scale);
  ImGui_ImplGlfw_InitForOpenGL(window, false);  // events come by the window, in their order
  ImGui_ImplOpenGL3_Init("#version 330 core");
}

UiOverlay::~UiOverlay() {
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
}

void UiOverlay::begin_frame(double now, const std::vector<WindowEvent>& events) {
  state_->now = now;
  state_->notices.expire(now);
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  state_->input.add(events);
  if (ImGui::GetIO().WantTextInput) state_->text_waits = 0;
  if (state_->text_waits > 0) --state_->text_waits;
  state_->input.apply(ImGui::GetIO(), state_->text_waits > 0);
  ImGui::NewFrame();
}

UiActions UiOverlay::build(const UiModel& model) {
  UiActions actions;
  State& state = *state_;
  state.hovers = false;
  state.top_bar(model, actions);
  if (state.statistics) state.status_bar(model);
  if (state.log) state.log_panel(model);
  if (state.clouds.open) {
    const float gap = 8 * state.scale;
    const CloudPanel::Frame frame{state.scale, state.top_bar_height() + gap,
                                  ImGui::GetIO().DisplaySize.y - state.status_bar_height() - gap,
                                  [&state](std::string_view text) { state.tooltip(text); }};
    state.clouds.build(frame, model, actions);
  }
  if (state.help) state.help_panel();
  if (state.open_panel) state.open_files_panel(actions);
  state.question_panel(model, actions);
  state.viewport_marks(model);
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
  if (!state.hovers) state.hovered = {-1, -1};
  return actions;
}

void UiOverlay::draw() {
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

bool UiOverlay::wants_pointer() const { return ImGui::GetIO().WantCaptureMouse; }
bool UiOverlay::wants_keys() const { return ImGui::GetIO().WantTextInput || state_->text_waits > 0; }
bool UiOverlay::has_input_left() const { return state_->input.waiting(); }

int UiOverlay::top_height() const {
  return static_cast<int>(std::ceil(state_->top_bar_height() * ImGui::GetIO().DisplayFramebufferScale.y));
}
int UiOverlay::bottom_height() const {
  return static_cast<int>(std::ceil(state_->status_bar_height() * ImGui::GetIO().DisplayFramebufferScale.y));
}

std::optional<double> UiOverlay::next_change() const {
  std::optional<double> next;
  if (const auto notice = state_->notices.next()) next = std::max(0.0, *notice - state_->now);
  const double tooltip_wait = state_->hovered_since + kTooltipDelay - state_->now;
  if (state_->hovers && tooltip_wait > 0) next = std::min(next.value_or(tooltip_wait), tooltip_wait);
  if (ImGui::GetIO().WantTextInput) next = std::min(next.value_or(0.4), 0.4);  // the caret blinks
  return next;
}

void UiOverlay::show_open_panel() {
  state_->open_panel = state_->open_panel_appears = true;
  state_->text_waits = kFramesToFocus;
  state_->help = false;
}
void UiOverlay::toggle_help() { state_->help = !state_->help; }
void UiOverlay::toggle_statistics() { state_->statistics = !state_->statistics; }
void UiOverlay::toggle_log() { state_->log = !state_->log; }
void UiOverlay::toggle_clouds() { state_->clouds.open = !state_->clouds.open; }
void UiOverlay::show_log() { state_->log = true; }

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
  if (state_->clouds.close_one()) return true;
  if (state_->notices.close_one()) return true;
  return std::exchange(state_->log, false);
}

}  // namespace gs::app
