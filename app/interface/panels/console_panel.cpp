#include "app/interface/base/text_field.h"
#include "app/interface/panels/inspect_panels.h"

#include <imgui.h>

#include <algorithm>

namespace gs::app {
namespace {

const ImVec4& color_of(ProgramLine::Kind kind) {
  switch (kind) {
    case ProgramLine::Kind::problem:
    case ProgramLine::Kind::failure:
      return UiColors::kError;
    case ProgramLine::Kind::entered:
      return UiColors::kQuiet;
    case ProgramLine::Kind::result:
      return UiColors::kNote;
    case ProgramLine::Kind::printed:
      break;
  }
  return UiColors::kText;
}

}  // namespace

void ConsolePanel::draw(const PanelFrame& frame, const UiModel& model, UiActions&) {
  if (!model.inspection) return;
  Inspection& inspection = *model.inspection;
  inspection.drawn().console = true;
  ScriptConsole& console = inspection.console();
  const float below = ImGui::GetFrameHeightWithSpacing();
  ImGui::BeginChild("##lines", {0, -below});
  if (console.lines().empty())
    colored_text(UiColors::kQuiet, "Output and errors of Scripts appear here. Enter an expression below.");
  ImGuiListClipper clipper;
  clipper.Begin(static_cast<int>(console.lines().size()));
  while (clipper.Step())
    for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i) {
      const ProgramLine& one = console.lines()[static_cast<std::size_t>(i)];
      if (!one.place.empty()) {
        colored_text(UiColors::kQuiet, shortened(one.place, 60) + "  ");
        ImGui::SameLine(0, 0);
      }
      const char* const mark = one.kind == ProgramLine::Kind::entered  ? "> "
                               : one.kind == ProgramLine::Kind::result ? "= "
                                                                       : "";
      colored_text(color_of(one.kind), mark + shortened(one.text, 1000));
      frame.tooltips.show(shortened(one.text, 3000));
    }
  if (shown_ != console.lines().size()) ImGui::SetScrollHereY(1);
  shown_ = console.lines().size();
  ImGui::EndChild();

  const NodeAt script = inspection.editor().script();
  const std::string context = script ? "in " + label_of(script) : "in Browser";
  ImGui::AlignTextToFramePadding();
  colored_text(script ? UiColors::kAccent : UiColors::kQuiet, context);
  frame.tooltips.show(script ? "Runs in the selected Script"
                             : "Runs on its own, with access to Browser; select a Script to run it there");
  ImGui::SameLine();
  const float clear =
      ImGui::CalcTextSize("Clear").x + 2 * ImGui::GetStyle().FramePadding.x + ImGui::GetStyle().ItemSpacing.x;
  // Up and Down recall earlier inputs.
  const FieldKeys keys{nullptr, [&](bool up, const std::string& present) { return console.recall(up, present); }};
  ImGui::BeginDisabled(!inspection.world());
  if (text_field("##line", "Browser.getName()", line_, -clear, false, keys).entered) {
    (void)inspection.console().enter(line_);
    line_.clear();
    ImGui::SetKeyboardFocusHere(-1);
  }
  ImGui::EndDisabled();
  ImGui::SameLine();
  if (ImGui::Button("Clear")) console.clear();
}

}  // namespace gs::app
