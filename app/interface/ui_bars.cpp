#include "app/interface/ui_state.h"
#include "app/interface/viewport_widgets.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

namespace gs::app {
namespace {

constexpr ImGuiWindowFlags kBarFlags = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                       ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus |
                                       ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoFocusOnAppearing;

bool begin_bar(const char* name, float y, float height, float padding) {
  const float width = ImGui::GetIO().DisplaySize.x;
  ImGui::SetNextWindowPos({0, y});
  ImGui::SetNextWindowSize({width, height});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 0);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, {1, 1});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {8, padding});
  ImGui::PushStyleColor(ImGuiCol_WindowBg, UiColors::kBar);
  const bool visible = ImGui::Begin(name, nullptr, kBarFlags);
  ImGui::PopStyleColor();
  ImGui::PopStyleVar(4);
  return visible;
}

float button_width(const char* label) {
  return ImGui::CalcTextSize(label, nullptr, true).x + 2 * ImGui::GetStyle().FramePadding.x;
}

void group_gap() { ImGui::SameLine(0, ImGui::GetStyle().ItemSpacing.x * 2.5f); }

constexpr std::size_t kLabelLength = 80;  // max bytes of a name in a list

/// Draws a list of labels, which may contain any text and duplicates. Returns the index that the user chose.
std::optional<std::size_t> choose(const char* id, const std::string& preview, const std::vector<std::string>& labels,
                                  std::optional<std::size_t> chosen, float width) {
  std::optional<std::size_t> result;
  ImGui::SetNextItemWidth(width);
  if (!ImGui::BeginCombo(id, shown(shortened(preview, kLabelLength)).c_str(), ImGuiComboFlags_HeightLarge))
    return result;
  ImGuiListClipper clipper;
  clipper.Begin(static_cast<int>(labels.size()));
  while (clipper.Step()) {
    for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i) {
      const auto index = static_cast<std::size_t>(i);
      if (ImGui::Selectable(label_of(shortened(labels[index], kLabelLength), std::to_string(i)).c_str(),
                            chosen == index))
        result = index;
    }
  }
  ImGui::EndCombo();
  return result;
}

struct ModeIcon {
  NavigationMode mode;
  Icon icon;
};
constexpr ModeIcon kModeIcons[] = {{NavigationMode::examine, Icon::examine},
                                   {NavigationMode::fly, Icon::fly},
                                   {NavigationMode::walk, Icon::walk},
                                   {NavigationMode::pan, Icon::pan},
                                   {NavigationMode::look_at, Icon::look_at}};

/// Elements that the tool bar shows if its width allows. Each row of kBarPlans omits more than the row before.
struct BarPlan {
  float files, viewpoints;  // widths at scale 1; 0 means omitted
  bool mode_words, words, arrows, panels, layouts, link;
};
constexpr BarPlan kBarPlans[] = {
    {150, 170, true, true, true, true, true, true},    {150, 170, true, false, true, true, true, true},
    {120, 150, false, false, true, true, true, true},  {100, 130, false, false, true, true, false, true},
    {90, 110, false, false, false, true, false, true}, {80, 90, false, false, false, true, false, false},
    {70, 0, false, false, false, true, false, false},  {0, 0, false, false, false, true, false, false},
    {0, 0, false, false, false, false, false, false},
};

float layout_button_width() { return ImGui::GetFrameHeight() * 1.2f; }

/// Returns the width that a plan needs, without the elements at the right end of the bar.
float width_of(const BarPlan& plan, const UiModel& model, float scale) {
  const float gap = ImGui::GetStyle().ItemSpacing.x, group = gap * 2.5f;
  const auto button = [&](std::string_view word, bool with_word) {
    return icon_button_width(with_word ? word : std::string_view()) + 1;
  };
  float width = ImGui::GetStyle().WindowPadding.x + button("Open", true) + group;
  if (model.files.size() > 1 && plan.files > 0) width += gap + plan.files * scale;
  if (plan.viewpoints > 0)
    width += plan.viewpoints * scale + (plan.arrows ? 2 * ImGui::GetFrameHeight() + 2 : 0) + group;
  for (const ModeIcon& one : kModeIcons) width += button(row_of(one.mode).label, plan.mode_words);
  width += group + button("Reset", plan.words) + button("Fit", plan.words) + group + button("Headlight", plan.words);
  if (model.has_sounds) width += button("Sound", plan.words);
  if (plan.panels && (model.has_surface_vectors || model.has_volumes)) width += group + button("Transfer", plan.words);
  width += group + (plan.layouts ? 3 * layout_button_width() + 2 : layout_button_width());
  if (plan.link && model.panes > 1) width += 1 + button_width("Link");
  return width;
}

const BarPlan& bar_plan(const UiModel& model, float scale, float room) {
  for (const BarPlan& plan : kBarPlans)
    if (width_of(plan, model, scale) <= room) return plan;
  return std::end(kBarPlans)[-1];
}

std::string log_word(const UiModel& model) {
  const std::size_t count = model.log ? model.log->errors() + model.log->warnings() : 0;
  if (count == 0) return "Log";
  return "Log  " + (count > 999 ? std::string("999+") : std::to_string(count));
}

std::string counted(std::size_t count) {
  std::string digits = std::to_string(count);
  for (std::size_t i = digits.size(); i > 3; i -= 3) digits.insert(i - 3, " ");
  return digits;
}

}  // namespace

float UiOverlay::State::tool_bar_height() const { return ImGui::GetFrameHeight() + std::round(8 * scale); }
float UiOverlay::State::status_bar_height() const { return statistics ? ImGui::GetTextLineHeight() + 8 * scale : 0.0f; }

// Draws the button of an action with an icon, and with its label if `with_word`.
void UiOverlay::State::tool(Action action, Icon icon, bool with_word, const UiModel& model, UiActions& actions) {
  const ActionRow& row = row_of(action);
  ImGui::BeginDisabled(!is_possible(action, model));
  if (icon_button(row.help, icon, with_word ? row.label : std::string_view(), is_on(action, model)))
    actions.run = action;
  ImGui::EndDisabled();
  tooltip(tooltip_of(action));
}

void UiOverlay::State::mode_buttons(const UiModel& model, UiActions& actions, bool words) {
  ImGui::BeginDisabled(!model.has_world);
  for (const ModeIcon& one : kModeIcons) {
    if (one.mode != kModeIcons[0].mode) ImGui::SameLine(0, 1);
    const NavigationModeRow& row = row_of(one.mode);
    ImGui::BeginDisabled(!model.rules.allows(one.mode));
    if (icon_button(row.label, one.icon, words ? row.label : std::string_view(),
                    model.has_world && one.mode == model.mode))
      actions.mode = one.mode;
    ImGui::EndDisabled();
    tooltip(model.rules.allows(one.mode)
                ? std::string(row.help) + " (" + std::to_string(static_cast<int>(one.mode)) + ")"
                : "This world does not allow " + std::string(row.label));
  }
  ImGui::EndDisabled();
}

void UiOverlay::State::viewpoint_list(const UiModel& model, UiActions& actions, float width, bool with_arrows) {
  const bool several = model.viewpoints.size() > 1;
  ImGui::BeginDisabled(model.viewpoints.empty());
  if (with_arrows) {
    ImGui::BeginDisabled(!several);
    if (ImGui::ArrowButton("##previous", ImGuiDir_Left)) actions.run = Action::previous_viewpoint;
    tooltip(tooltip_of(Action::previous_viewpoint));
    ImGui::EndDisabled();
    ImGui::SameLine(0, 1);
  }
  const std::string preview = model.viewpoints.empty() ? "No viewpoints"
                              : model.viewpoint && *model.viewpoint < model.viewpoints.size()
                                  ? model.viewpoints[*model.viewpoint]
                                  : "Viewpoints";
  if (const auto chosen = choose("##viewpoints", preview, model.viewpoints, model.viewpoint, width))
    actions.viewpoint = chosen;
  if (with_arrows) {
    ImGui::SameLine(0, 1);
    ImGui::BeginDisabled(!several);
    if (ImGui::ArrowButton("##next", ImGuiDir_Right)) actions.run = Action::next_viewpoint;
    tooltip(tooltip_of(Action::next_viewpoint));
    ImGui::EndDisabled();
  }
  ImGui::EndDisabled();
}

void UiOverlay::State::tool_bar(const UiModel& model, UiActions& actions) {
  begin_bar("##tools", menu_bar_height(), tool_bar_height(), std::round(4 * scale));
  const std::string log = log_word(model);
  const float right = icon_button_width(log) + icon_button_width("") + 8 * scale + 2;
  const BarPlan& plan = bar_plan(model, scale, ImGui::GetIO().DisplaySize.x - right - 8 * scale);
  tool(Action::open_file, Icon::open, true, model, actions);
  if (model.files.size() > 1 && plan.files > 0) {
    ImGui::SameLine();
    const std::string preview = model.file && *model.file < model.files.size() ? model.files[*model.file] : "Files";
    if (const auto chosen = choose("##files", preview, model.files, model.file, plan.files * scale))
      actions.file = chosen;
    tooltip(tooltip_of(Action::next_file));
  }
  if (plan.viewpoints > 0) {
    group_gap();
    viewpoint_list(model, actions, plan.viewpoints * scale, plan.arrows);
  }
  group_gap();
  mode_buttons(model, actions, plan.mode_words);
  group_gap();
  tool(Action::reset, Icon::home, plan.words, model, actions);
  ImGui::SameLine(0, 1);
  tool(Action::fit, Icon::fit, plan.words, model, actions);
  group_gap();
  tool(Action::headlight, Icon::light, plan.words, model, actions);
  if (model.has_sounds) {
    ImGui::SameLine(0, 1);
    tool(Action::mute, model.muted ? Icon::silence : Icon::sound, plan.words, model, actions);
  }
  if (plan.panels && (model.has_surface_vectors || model.has_volumes)) {
    group_gap();
    tool(Action::transfer, Icon::curve, plan.words, model, actions);
  }
  group_gap();
  layout_buttons(model, actions, plan.layouts, plan.link);

  ImGui::SameLine(std::max(ImGui::GetCursorPosX(), ImGui::GetIO().DisplaySize.x - right));
  const bool bad = model.log && model.log->errors() > 0, doubtful = model.log && model.log->warnings() > 0;
  ImGui::PushStyleColor(ImGuiCol_Text, bad ? UiColors::kError : doubtful ? UiColors::kWarning : UiColors::kText);
  if (icon_button("log", Icon::log, log, is_on(Action::log, model))) actions.run = Action::log;
  ImGui::PopStyleColor();
  tooltip(tooltip_of(Action::log));
  ImGui::SameLine(0, 1);
  if (icon_button("help", Icon::help, "", help)) actions.run = Action::help;
  tooltip(tooltip_of(Action::help));
  ImGui::End();
}

void UiOverlay::State::status_bar(const UiModel& model) {
  const float height = status_bar_height();
  begin_bar("##status", ImGui::GetIO().DisplaySize.y - height, height, 4 * scale);
  char numbers[96];
  std::string line;
  if (model.frames_a_second > 0) {  // positive only during motion, because still pictures are not redrawn
    std::snprintf(numbers, sizeof numbers, "%.0f fps   ", model.frames_a_second);
    line += numbers;
  }
  std::snprintf(numbers, sizeof numbers, "%.1f ms", model.frame_ms);
  line += numbers;
  line += "   " + counted(model.statistics.triangles) + " triangles   " + counted(model.statistics.items) +
          " items   " + counted(model.statistics.draw_calls) + " draw calls";
  if (model.statistics.vectors > 0)
    line += "   " + counted(model.statistics.vectors) + " vectors (" + model.statistics.splats + ")" +
            (model.statistics.pending ? ", loading" : "");
  if (model.mode == NavigationMode::fly || model.mode == NavigationMode::walk) {
    std::snprintf(numbers, sizeof numbers, "   %.3g m/s", static_cast<double>(model.speed));
    line += numbers;
  }
  colored_text(UiColors::kQuiet, line);
  const std::string renderer = shortened(model.gl_renderer, 80);
  const float place = ImGui::GetIO().DisplaySize.x - ImGui::CalcTextSize(renderer.c_str()).x - 8;
  if (place > ImGui::CalcTextSize(line.c_str()).x + 24) {
    ImGui::SameLine(place);
    colored_text(UiColors::kQuiet, renderer);
  }
  ImGui::End();
}

void ViewportWidgets::travel_mark(const UiModel& model) {
  const ImVec2 pixels = ImGui::GetIO().DisplayFramebufferScale;
  const ImVec2 anchor(model.travel_anchor->x / std::max(pixels.x, 0.01f),
                      model.travel_anchor->y / std::max(pixels.y, 0.01f));
  const ImVec2 pointer(model.pointer.x / std::max(pixels.x, 0.01f), model.pointer.y / std::max(pixels.y, 0.01f));
  ImDrawList& draw = *ImGui::GetBackgroundDrawList();
  const ImU32 light = IM_COL32(255, 255, 255, 190), dark = IM_COL32(0, 0, 0, 110);
  draw.AddLine(anchor, pointer, dark, 4 * scale_);
  draw.AddLine(anchor, pointer, light, 2 * scale_);
  draw.AddCircle(anchor, 7 * scale_, dark, 0, 4 * scale_);
  draw.AddCircle(anchor, 7 * scale_, light, 0, 2 * scale_);
}

}  // namespace gs::app
