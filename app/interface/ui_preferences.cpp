#include "app/interface/base/text_field.h"
#include "app/interface/ui_state.h"
#include "app/settings/user_folders.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

// Preferences dialog, with one row for each setting.
namespace gs::app {
namespace {

constexpr std::size_t kLongestFile = 60;  // characters of a path

// Draws the control of one setting. Returns true if the user changed the value.
bool setting_control(UserSettings& settings, const SettingRow& row) {
  const std::string value = row.get(settings);
  const std::string id = "##" + std::string(row.name);
  switch (row.kind) {
    case SettingRow::Kind::flag: {
      bool on = value == "on";
      if (!ImGui::Checkbox(id.c_str(), &on)) return false;
      row.set(settings, on ? "on" : "off");
      return true;
    }
    case SettingRow::Kind::choice: {
      bool changed = false;
      for (std::size_t at = 0; at < row.choices.size();) {
        const std::size_t end = row.choices.find(' ', at);
        const std::string choice(row.choices.substr(at, end - at));
        if (at > 0) ImGui::SameLine();
        if (ImGui::RadioButton((choice + id).c_str(), choice == value) && choice != value) {
          row.set(settings, choice);
          changed = true;
        }
        at = end + 1;
      }
      return changed;
    }
    case SettingRow::Kind::number:
      break;
  }
  double number = std::strtod(value.c_str(), nullptr);
  ImGui::SetNextItemWidth(ImGui::GetFontSize() * 9);
  const double step = row.whole ? 100000 : 0.1;
  if (!ImGui::InputDouble(id.c_str(), &number, step, step * 10, row.whole ? "%.0f" : "%.2f")) return false;
  number = std::clamp(number, row.least, row.most);
  char text[64];
  std::snprintf(text, sizeof text, row.whole ? "%.0f" : "%.6g", number);
  return !set_setting(settings, row, text);
}

}  // namespace

void UiOverlay::State::preferences_dialog(const UiModel& model, UiActions& actions) {
  if (!preferences) return;
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({screen.x / 2, screen.y / 2}, ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::SetNextWindowSizeConstraints({0, 0}, {screen.x - 24 * scale, screen.y - 24 * scale});
  ImGui::SetNextWindowSize({std::min(640 * scale, screen.x - 24 * scale), 0});
  if (ImGui::Begin("Preferences", &preferences,
                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoResize |
                       ImGuiWindowFlags_NoMove) &&
      ImGui::BeginTable("##settings", 2)) {
    ImGui::TableSetupColumn("name", ImGuiTableColumnFlags_WidthFixed, ImGui::GetFontSize() * 13);
    ImGui::TableSetupColumn("value", ImGuiTableColumnFlags_WidthStretch);
    UserSettings chosen = model.settings;
    bool changed = false;
    for (const SettingRow& row : setting_rows()) {
      ImGui::TableNextRow();
      ImGui::TableNextColumn();
      ImGui::AlignTextToFramePadding();
      text(row.label);
      ImGui::TableNextColumn();
      changed |= setting_control(chosen, row);
      // Put the help text beside the control if at least 12 font heights remain, else below it.
      const float end = ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x;
      if (end - ImGui::GetItemRectMax().x > 12 * ImGui::GetFontSize()) ImGui::SameLine(0, 10 * scale);
      ImGui::PushTextWrapPos(0);
      colored_text(UiColors::kQuiet, row.help);
      ImGui::PopTextWrapPos();
    }
    ImGui::EndTable();
    if (ImGui::Button("Restore defaults")) {
      chosen = UserSettings{};
      changed = true;
    }
    if (changed) actions.settings = chosen;
  }
  ImGui::End();
}

// Draws a line below the bars with the offer to restore the last session. The line takes its height from the picture.
void UiOverlay::State::restore_line(const UiModel& model, UiActions& actions) {
  const std::vector<std::string>& files = model.to_restore;
  if (files.empty()) return;
  const float width = ImGui::GetIO().DisplaySize.x, height = restore_height();
  ImGui::SetNextWindowPos({0, menu_bar_height() + tool_bar_height()});
  ImGui::SetNextWindowSize({width, height});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 0);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {10 * scale, std::round(4 * scale)});
  ImGui::PushStyleColor(ImGuiCol_WindowBg, with_alpha(UiColors::kPopup, 1));
  ImGui::Begin("##restore", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoFocusOnAppearing);
  ImGui::PopStyleColor();
  ImGui::PopStyleVar(3);
  ImGui::AlignTextToFramePadding();
  text("GhostSpace ended unexpectedly. Open " +
       (files.size() == 1 ? shortened(without_home(files.front()), kLongestFile) + " again?"
                          : "the " + std::to_string(files.size()) + " files that it showed?"));
  ImGui::SameLine();
  if (ImGui::Button("Open##restore")) actions.restore = true;
  ImGui::SameLine();
  if (ImGui::Button("No##restore")) actions.restore = false;
  ImGui::End();
}

}  // namespace gs::app
