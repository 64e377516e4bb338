#include "app/interface/panels/log_panel.h"

#include "app/interface/base/text_field.h"
#include "app/session/documents/documents.h"
#include "base/text.h"

#include <imgui.h>

#include <algorithm>
#include <string>
#include <utility>

namespace gs::app {
namespace {

std::string place_of(const Diagnostic& diagnostic) {
  std::string place = shortened(file_label(diagnostic.file), 60);
  if (diagnostic.location.line > 0)
    place += ":" + std::to_string(diagnostic.location.line) + ":" + std::to_string(diagnostic.location.column);
  return place;
}

std::string counted(std::size_t count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s") + "###" + what;
}

const char* emptiness_of(const SessionLog& log) {
  if (log.entries() > 0) return "No matches.";
  return log.files().empty() ? "No file is loaded." : "No problems.";
}

const char* word_of(Severity severity) {
  return severity == Severity::error ? "error" : severity == Severity::warning ? "warning" : "note";
}

}  // namespace

void LogPanel::rows_of(const PanelFrame& frame, const std::vector<CountedDiagnostic>& rows) {
  if (!ImGui::BeginTable("##rows", 3, ImGuiTableFlags_ScrollY | ImGuiTableFlags_RowBg | ImGuiTableFlags_Resizable))
    return;
  ImGui::TableSetupColumn("severity", ImGuiTableColumnFlags_WidthFixed, ImGui::CalcTextSize("warning  ").x);
  ImGui::TableSetupColumn("place", ImGuiTableColumnFlags_WidthFixed, ImGui::GetFontSize() * 13);
  ImGui::TableSetupColumn("message", ImGuiTableColumnFlags_WidthStretch);
  if (const auto row = std::exchange(goes_to_, std::nullopt))
    ImGui::SetScrollY(static_cast<float>(*row) * (ImGui::GetTextLineHeight() + 2 * ImGui::GetStyle().CellPadding.y));
  ImGuiListClipper clipper;
  clipper.Begin(static_cast<int>(rows.size()));
  while (clipper.Step()) {
    for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i) {
      const CountedDiagnostic& row = rows[static_cast<std::size_t>(i)];
      const Diagnostic& diagnostic = *row.first;
      ImGui::TableNextRow();
      ImGui::TableNextColumn();
      colored_text(color_of(diagnostic.severity), word_of(diagnostic.severity));
      ImGui::TableNextColumn();
      colored_text(UiColors::kQuiet, place_of(diagnostic));
      ImGui::TableNextColumn();
      if (row.count > 1) {
        colored_text(UiColors::kQuiet, std::to_string(row.count) + " times:");
        ImGui::SameLine();
      }
      text(shortened(diagnostic.message, 500));
      frame.tooltips.show(shortened(text_of(row), 2000));
    }
  }
  ImGui::EndTable();
}

void LogPanel::draw(const PanelFrame& frame, const UiModel& model, UiActions&) {
  const float scale = frame.scale;
  static const SessionLog kEmpty;
  const SessionLog& session_log = model.log ? *model.log : kEmpty;
  ImGui::Checkbox(counted(session_log.errors(), "error").c_str(), &show_errors_);
  ImGui::SameLine(0, 16 * scale);
  ImGui::Checkbox(counted(session_log.warnings(), "warning").c_str(), &show_warnings_);
  ImGui::SameLine(0, 16 * scale);
  ImGui::Checkbox("notes", &show_notes_);
  const float button = ImGui::CalcTextSize("Copy").x + 2 * ImGui::GetStyle().FramePadding.x;
  ImGui::SameLine(0, 16 * scale);
  (void)text_field(
      "##search", "Search", searched_,
      std::max(60 * scale, ImGui::GetContentRegionAvail().x - button - 2 * ImGui::GetStyle().ItemSpacing.x), false);

  std::vector<CountedDiagnostic> rows;
  std::pair<std::string, std::size_t> newest;  // last file that has messages, and the index of its first row
  for (const SessionLog::File& file : session_log.files()) {
    const std::size_t first = rows.size();
    for (const CountedDiagnostic& row : joined(file.diagnostics.entries())) {
      const Diagnostic& diagnostic = *row.first;
      const bool shown = diagnostic.severity == Severity::error     ? show_errors_
                         : diagnostic.severity == Severity::warning ? show_warnings_
                                                                    : show_notes_;
      if (shown &&
          (searched_.empty() || lower_case(diagnostic.text()).find(lower_case(searched_)) != std::string::npos))
        rows.push_back(row);
    }
    if (rows.size() > first) newest = {file.path, first};
  }
  // Scroll to the messages of a new file.
  if (newest.first != newest_) goes_to_ = newest.second;
  newest_ = std::move(newest.first);
  ImGui::SameLine();
  ImGui::BeginDisabled(rows.empty());
  if (ImGui::Button("Copy")) {
    std::string all;
    for (const CountedDiagnostic& row : rows) all += text_of(row) + "\n";
    ImGui::SetClipboardText(all.c_str());
  }
  ImGui::EndDisabled();
  if (rows.empty())
    colored_text(UiColors::kQuiet, emptiness_of(session_log));
  else
    rows_of(frame, rows);
  if (session_log.dropped() > 0)
    colored_text(UiColors::kQuiet, "and " + std::to_string(session_log.dropped()) + " more");
}

}  // namespace gs::app
