#include "app/interface/base/fuzzy.h"
#include "app/interface/base/text_field.h"
#include "app/interface/ui_state.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <string>

// Command palette, which finds actions by parts of their names.
namespace gs::app {
namespace {

constexpr std::size_t kMaxRows = 400;
constexpr int kFramesToType = 4;  // max frames until the palette's text field gets the focus

}  // namespace

std::vector<UiOverlay::State::Command> UiOverlay::State::commands(const UiModel& model) const {
  std::vector<Command> all;
  for (const ActionRow& row : app::actions()) {
    if (row.action == Action::palette || row.action == Action::close || !is_possible(row.action, model)) continue;
    const auto panel = panel_of(row.action);
    std::string words = panel ? "Panel: " + std::string(panel_rows()[*panel].title) : std::string(row.help);
    all.push_back({std::move(words), keys_of(row), icon_of(row.action),
                   [action = row.action](UiActions& actions) { actions.run = action; }});
  }
  for (std::size_t i = 0; i < model.viewpoints.size(); ++i)
    all.push_back(
        {"Viewpoint: " + model.viewpoints[i], "", Icon::viewpoint, [i](UiActions& actions) { actions.viewpoint = i; }});
  for (std::size_t i = 0; i < model.files.size(); ++i)
    all.push_back({"File: " + model.files[i], "", Icon::file, [i](UiActions& actions) { actions.file = i; }});
  for (std::size_t i = 0; i < model.bookmarks.size(); ++i)
    all.push_back({"Bookmark: " + model.bookmarks[i].title, "", Icon::bookmarked,
                   [i](UiActions& actions) { actions.open_bookmark = i; }});
  for (const std::string& place : model.recent)
    all.push_back(
        {"Open: " + without_home(place), "", Icon::clock, [place](UiActions& actions) { actions.open = place; }});
  return all;
}

void UiOverlay::State::palette_dialog(const UiModel& model, UiActions& actions) {
  if (!palette.open) return;
  std::vector<Command> all = commands(model);
  std::vector<std::pair<int, const Command*>> fit;
  for (const Command& command : all)
    if (const auto score = fuzzy_score(command.words, palette.typed)) fit.emplace_back(*score, &command);
  std::stable_sort(fit.begin(), fit.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  if (fit.size() > kMaxRows) fit.resize(kMaxRows);

  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  const float width = std::min(620 * scale, screen.x - 24 * scale);
  ImGui::SetNextWindowPos({std::floor((screen.x - width) / 2), menu_bar_height() + 6 * scale});
  ImGui::SetNextWindowSize({width, std::min(420 * scale, screen.y - 2 * menu_bar_height())});
  if (palette.appears) ImGui::SetNextWindowFocus();
  ImGui::PushStyleColor(ImGuiCol_WindowBg, UiColors::kPopup);
  ImGui::Begin("##palette", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings);
  ImGui::PopStyleColor();
  if (std::exchange(palette.appears, false)) ImGui::SetKeyboardFocusHere();
  const FieldEvents events = text_field("##command", "Search commands", palette.typed, -1, false);
  if (events.changed) palette.chosen = 0;
  const int count = static_cast<int>(fit.size());
  if (count > 0) palette.chosen = (palette.chosen + events.moved + count) % count;
  const Command* wanted = events.entered && count > 0 ? fit[static_cast<std::size_t>(palette.chosen)].second : nullptr;
  ImGui::Separator();
  ImGui::BeginChild("##commands");
  if (fit.empty()) colored_text(UiColors::kQuiet, "No matches.");
  for (int i = 0; i < count; ++i) {
    const Command& command = *fit[static_cast<std::size_t>(i)].second;
    ImGui::PushID(i);
    const ImVec2 place = ImGui::GetCursorPos();
    if (ImGui::Selectable("##row", i == palette.chosen)) wanted = &command;
    if (i == palette.chosen && (events.moved != 0 || events.changed)) ImGui::SetScrollHereY();
    const ImVec2 next = ImGui::GetCursorPos();
    ImGui::SetCursorPos({place.x + 4 * scale, place.y});
    if (command.icon)
      inline_icon(*command.icon);
    else
      ImGui::SetCursorPosX(place.x + 4 * scale + std::round(ImGui::GetFontSize() * 1.05f) +
                           ImGui::GetStyle().ItemInnerSpacing.x);
    text(shortened(command.words, 120));
    if (!command.keys.empty()) {
      ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - ImGui::CalcTextSize(command.keys.c_str()).x - 4 * scale);
      colored_text(UiColors::kQuiet, command.keys);
    }
    ImGui::SetCursorPos(next);
    ImGui::PopID();
  }
  ImGui::EndChild();
  const bool left = !ImGui::IsWindowFocused(ImGuiFocusedFlags_RootAndChildWindows) && palette.was_focused;
  palette.was_focused = ImGui::IsWindowFocused(ImGuiFocusedFlags_RootAndChildWindows);
  ImGui::End();
  if (wanted) wanted->run(actions);
  if (wanted || left) {
    palette = {};
  } else if (events.entered) {
    // Enter without a match: keep the palette open and focused.
    palette.appears = true;
    text_waits = kFramesToType;
  }
}

void UiOverlay::State::show_palette() {
  palette = {};
  palette.open = palette.appears = true;
  text_waits = kFramesToType;
}

}  // namespace gs::app
