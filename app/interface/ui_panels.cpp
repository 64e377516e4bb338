#include "app/interface/ui_state.h"

#include <imgui.h>

#include <algorithm>
#include <string>
#include <vector>

namespace gs::app {
namespace {

constexpr ImGuiWindowFlags kPanelFlags = ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoNav |
                                         ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoFocusOnAppearing;

struct KeyHelp {
  const char* keys;
  const char* what;
};
constexpr KeyHelp kPointerHelp[] = {
    {"Left drag",
     "Examine: turn about the point under the pointer.  Fly, Walk: move and turn; a longer drag is faster"},
    {"Right drag", "Examine: slide.  Fly, Walk: look around"},
    {"Middle drag", "Slide"},
    {"Shift or Ctrl + left drag", "Slide"},
    {"Shift or Ctrl + right drag", "Examine: zoom"},
    {"Wheel", "Examine: zoom to the point under the pointer.  Fly, Walk: move forward and back"},
    {"Double click", "Examine: set the centre of rotation"},
    {"Click", "Look at: go to the point under the pointer"},
    {"Hand", "Pointer over a sensor or link: click or drag with the left button"},
};
// Keys that move the viewer while they are held.
constexpr KeyHelp kHeldKeyHelp[] = {
    {"Arrows", "Turn in Examine; move forward or back and turn in Fly and Walk"},
    {"W A S D, Q E", "Forward, left, back, right, down, up; with Shift faster"},
    {"Gamepad, 3D mouse", "Left stick and triggers move, right stick turns; the 3D mouse cap moves and turns"},
};

template <std::size_t N>
void help_table(const char* id, const KeyHelp (&rows)[N]) {
  if (!ImGui::BeginTable(id, 2, ImGuiTableFlags_None)) return;
  ImGui::TableSetupColumn("keys", ImGuiTableColumnFlags_WidthFixed,
                          ImGui::CalcTextSize("Shift or Ctrl + left drag ").x);
  ImGui::TableSetupColumn("what", ImGuiTableColumnFlags_WidthStretch);
  for (const KeyHelp& row : rows) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    colored_text(UiColors::kAccent, row.keys);
    ImGui::TableNextColumn();
    ImGui::TextWrapped("%s", row.what);
  }
  ImGui::EndTable();
}

// Draws all keys with their actions in two columns.
void action_table() {
  if (!ImGui::BeginTable("##actions", 4, ImGuiTableFlags_None)) return;
  const float keys = ImGui::CalcTextSize("Ctrl+Shift+Tab ").x;
  for (int side = 0; side < 2; ++side) {
    ImGui::TableSetupColumn("keys", ImGuiTableColumnFlags_WidthFixed, keys);
    ImGui::TableSetupColumn("what", ImGuiTableColumnFlags_WidthStretch);
  }
  std::vector<ActionRow> rows;
  for (const ActionRow& row : actions())
    if (row.key != Key::unknown) rows.push_back(row);
  const std::size_t half = (rows.size() + 1) / 2;
  for (std::size_t line = 0; line < half; ++line) {
    ImGui::TableNextRow();
    for (const std::size_t i : {line, line + half}) {
      ImGui::TableNextColumn();
      if (i < rows.size()) colored_text(UiColors::kAccent, all_keys_of(rows[i]));
      ImGui::TableNextColumn();
      if (i < rows.size()) ImGui::TextWrapped("%s", std::string(rows[i].help).c_str());
    }
  }
  ImGui::EndTable();
}

}  // namespace

void UiOverlay::State::help_panel() {
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({screen.x / 2, screen.y / 2}, ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::SetNextWindowSizeConstraints({0, 0}, {screen.x - 24 * scale, screen.y - 24 * scale});
  ImGui::SetNextWindowSize({std::min(720 * scale, screen.x - 24 * scale), 0});
  if (ImGui::Begin("Keys and mouse", &help, kPanelFlags | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove)) {
    help_table("##pointer", kPointerHelp);
    ImGui::Separator();
    help_table("##held", kHeldKeyHelp);
    action_table();
  }
  ImGui::End();
}

void UiOverlay::State::notice_lines() {
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  float top = top_height() + 10 * scale;
  std::optional<std::size_t> closed;
  for (std::size_t i = 0; i < notices.lines().size(); ++i) {
    const Notices::Line& line = notices.lines()[i];
    ImGui::SetNextWindowPos({screen.x / 2, top}, ImGuiCond_Always, {0.5f, 0});
    ImGui::SetNextWindowSizeConstraints({0, 0}, {screen.x - 24 * scale, screen.y});
    if (line.is_problem) ImGui::PushStyleColor(ImGuiCol_Border, UiColors::kError);
    ImGui::Begin(
        ("##notice" + std::to_string(i)).c_str(), nullptr,
        kPanelFlags | ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove);
    if (line.is_problem) ImGui::PopStyleColor();
    ImGui::PushTextWrapPos(std::min(screen.x - 90 * scale, 620 * scale));
    ImGui::AlignTextToFramePadding();
    text(line.text);
    ImGui::PopTextWrapPos();
    if (line.is_problem) {
      ImGui::SameLine();
      if (ImGui::SmallButton("x")) closed = i;
    }
    top += ImGui::GetWindowHeight() + 6 * scale;
    ImGui::End();
  }
  if (closed) notices.close(*closed);
}

}  // namespace gs::app
