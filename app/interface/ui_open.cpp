#include "app/interface/base/text_field.h"
#include "app/interface/ui_state.h"
#include "base/text.h"

#include <imgui.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <system_error>

// Built-in dialog for opening and saving files, for desktops that have none.
namespace gs::app {
namespace {

namespace fs = std::filesystem;
constexpr std::size_t kMaxRecentShown = 5;

}  // namespace

// Opens a folder in the dialog's list, or opens a file. The dialog stays open until the file is displayed, so that the
// user can correct the path after an error.
void UiOverlay::State::choose_in_dialog(const std::string& typed, UiActions& actions) {
  const std::string path = opened_path(typed);
  if (path.empty()) return;
  std::error_code error;
  dialog.chosen.reset();
  if (fs::is_directory(path, error)) {
    dialog.typed = typed.ends_with('/') ? typed : typed + "/";
    dialog.wanted = true;
    listing.forget();
    return;
  }
  dialog.typed = typed;
  if (dialog.saves) {
    actions.save = path;
    dialog.open = false;
    return;
  }
  actions.open = path;
  dialog.opening = true;
  dialog.problem.clear();
}

// Returns the entries of the typed folder that match the last component of the path.
std::vector<FolderListing::Entry> UiOverlay::State::dialog_rows(const TypedPath& path) {
  std::vector<FolderListing::Entry> rows;
  const std::string part = dialog.saves ? std::string() : lower_case(path.part);  // a new file matches no other
  for (const FolderListing::Entry& entry : listing.entries_of(path.folder)) {
    if (entry.name[0] == '.' && !path.part.starts_with('.')) continue;
    if (!entry.is_folder && !entry.is_known && !dialog.all_files) continue;
    if (lower_case(entry.name).find(part) != std::string::npos) rows.push_back(entry);
  }
  return rows;
}

void UiOverlay::State::open_dialog(const UiModel& model, UiActions& actions) {
  if (!dialog.open) return;
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  const float width = std::min(640 * scale, screen.x - 24 * scale);
  ImGui::SetNextWindowPos({screen.x / 2, screen.y / 2}, ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::SetNextWindowSize({width, std::min(480 * scale, screen.y - 24 * scale)});
  if (dialog.appears) ImGui::SetNextWindowFocus();
  const char* const title = dialog.saves ? "Save as" : "Open";
  const char* const verb = dialog.saves ? "Save" : "Open";
  const bool visible = ImGui::Begin(title, &dialog.open,
                                    ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoCollapse |
                                        ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize);
  if (!visible) return ImGui::End();
  if (std::exchange(dialog.appears, false)) {
    listing.forget();
    dialog.wanted = true;
  }
  if (std::exchange(dialog.wanted, false)) ImGui::SetKeyboardFocusHere();
  const float button = ImGui::CalcTextSize(verb).x + 2 * ImGui::GetStyle().FramePadding.x;
  const FieldEvents events =
      text_field("##path", dialog.saves ? "Path of the new file" : "Path, URL or part of a name", dialog.typed,
                 width - button - 2 * ImGui::GetStyle().WindowPadding.x - ImGui::GetStyle().ItemSpacing.x, false,
                 {[this](const std::string& typed) { return completed_path(typed, listing); }});
  ImGui::SameLine();
  const bool pressed = ImGui::Button(verb);
  if (events.changed) dialog.chosen.reset();
  const TypedPath path = typed_path(dialog.typed);
  const std::vector<FolderListing::Entry> rows =
      looks_like_url(dialog.typed) ? std::vector<FolderListing::Entry>() : dialog_rows(path);
  if (events.moved != 0 && !rows.empty()) {
    const int count = static_cast<int>(rows.size());
    const int at = dialog.chosen ? static_cast<int>(*dialog.chosen) + events.moved : events.moved > 0 ? 0 : count - 1;
    dialog.chosen = static_cast<std::size_t>((at + count) % count);
  }
  if (dialog.chosen && *dialog.chosen >= rows.size()) dialog.chosen.reset();
  std::optional<std::string> choice;
  if (events.entered || pressed) {
    std::error_code error;
    const bool is_there = fs::exists(opened_path(dialog.typed), error);
    if (dialog.chosen && !dialog.saves)
      choice = path.before + rows[*dialog.chosen].name;
    else if (rows.size() == 1 && !is_there && !dialog.saves)
      choice = path.before + rows.front().name;  // the only match of a partial name
    else
      choice = dialog.typed;
  }
  if (!dialog.problem.empty()) {
    ImGui::PushTextWrapPos(0);
    colored_text(UiColors::kError, shortened(dialog.problem, 400));
    ImGui::PopTextWrapPos();
  } else if (dialog.opening) {
    colored_text(UiColors::kQuiet, "Opening...");
  }
  if (dialog.saves) {
    ImGui::PushTextWrapPos(0);
    colored_text(UiColors::kQuiet, "The extension selects the format: " + dialog.formats);
    ImGui::PopTextWrapPos();
  }
  if (dialog.typed.empty() && !dialog.saves && !model.recent.empty()) {
    colored_text(UiColors::kQuiet, "Recent");
    std::vector<Suggestion> recent;
    for (const std::string& place : model.recent)
      if (recent.size() < kMaxRecentShown) recent.push_back({place, without_home(place), Icon::clock});
    if (const auto clicked = suggestion_rows(recent, std::nullopt)) choice = recent[*clicked].place;
    ImGui::Separator();
  }
  ImGui::Checkbox("All files", &dialog.all_files);
  ImGui::SameLine(0, 16 * scale);
  std::error_code error;
  colored_text(UiColors::kQuiet,
               shortened(path.folder.empty() ? without_home(fs::current_path(error).string()) : path.before, 200));
  ImGui::BeginChild("##folder");
  if (!listing.problem().empty()) colored_text(UiColors::kError, listing.problem());
  if (ImGui::Selectable("##up")) choice = path.before.empty() ? "../" : path.before + "../";
  ImGui::SameLine(4 * scale);
  inline_icon(Icon::folder);
  text("..");
  ImGuiListClipper clipper;
  clipper.Begin(static_cast<int>(rows.size()));
  while (clipper.Step()) {
    for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i) {
      const FolderListing::Entry& entry = rows[static_cast<std::size_t>(i)];
      ImGui::PushID(i);
      const bool chosen = dialog.chosen && *dialog.chosen == static_cast<std::size_t>(i);
      if (ImGui::Selectable("##entry", chosen)) {
        if (dialog.saves && !entry.is_folder)
          dialog.typed = path.before + entry.name;  // only the button replaces a file
        else
          choice = path.before + entry.name;
      }
      ImGui::SameLine(4 * scale);
      inline_icon(entry.is_folder ? Icon::folder : Icon::file);
      text(shortened(entry.name, 120));
      ImGui::PopID();
    }
  }
  if (events.moved != 0 && dialog.chosen)
    ImGui::SetScrollFromPosY(ImGui::GetCursorStartPos().y +
                             static_cast<float>(*dialog.chosen + 1) * ImGui::GetTextLineHeightWithSpacing() -
                             ImGui::GetScrollY());
  ImGui::EndChild();
  ImGui::End();
  if (choice) choose_in_dialog(*choice, actions);
}

}  // namespace gs::app
