#include "app/interface/ui_state.h"

#include "app/formats/content_types.h"
#include "app/session/documents.h"

#include <imgui.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <string>

namespace gs::app {
namespace {

namespace fs = std::filesystem;
constexpr std::size_t kMostEntries = 5000, kMostRecent = 8;

void put(char (&buffer)[4096], const std::string& text) {
  const std::size_t size = std::min(text.size(), sizeof buffer - 1);
  std::memcpy(buffer, text.data(), size);
  buffer[size] = 0;
}

/// Whether a content type calls files of this name its own; packed ones count.
bool is_known(std::string name) {
  for (char& c : name)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  if (name.ends_with(".gz")) name.resize(name.size() - 3);
  const std::size_t point = name.find_last_of('.');
  if (point == std::string::npos) return false;
  const std::string extension = name.substr(point) + ' ';
  const auto types = content_types();
  return std::any_of(types.begin(), types.end(), [&](const ContentType& type) {
    return type.extensions.find(extension) != std::string_view::npos;
  });
}

}  // namespace

void UiOverlay::State::read_folder() {
  folder_entries.clear();
  folder_problem.clear();
  std::error_code error;
  if (folder.empty()) folder = fs::current_path(error).string();
  fs::directory_iterator entry(folder, fs::directory_options::skip_permission_denied, error);
  for (; !error && entry != fs::directory_iterator() && folder_entries.size() < kMostEntries; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (name.empty() || name[0] == '.') continue;
    std::error_code ignored;  // of a link that leads nowhere
    const bool is_folder = entry->is_directory(ignored);
    if (is_folder || (entry->is_regular_file(ignored) && (all_files || is_known(name))))
      folder_entries.push_back({name, is_folder});
  }
  if (error) folder_problem = "Cannot read this folder: " + error.message();
  std::sort(folder_entries.begin(), folder_entries.end(), [](const FolderEntry& a, const FolderEntry& b) {
    return a.is_folder != b.is_folder ? a.is_folder : a.name < b.name;
  });
}

void UiOverlay::State::opened(const std::string& path_or_url, UiActions& actions) {
  if (path_or_url.empty()) return;
  std::error_code error;
  if (fs::is_directory(path_or_url, error)) {
    folder = path_or_url;
    read_folder();
    return;
  }
  std::erase(recent, path_or_url);
  recent.insert(recent.begin(), path_or_url);
  if (recent.size() > kMostRecent) recent.resize(kMostRecent);
  actions.open = path_or_url;
  // The panel stays until something of it shows: what cannot be opened is mended there.
  opening = true;
  open_problem.clear();
}

void UiOverlay::State::open_files_panel(UiActions& actions) {
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({8 * scale, top_bar_height() + 8 * scale});
  ImGui::SetNextWindowSize({std::min(520 * scale, screen.x - 16 * scale),
                            std::min(440 * scale, screen.y - top_bar_height() - status_bar_height() - 16 * scale)});
  const bool visible = ImGui::Begin("Open", &open_panel,
                                    ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoCollapse |
                                        ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize);
  if (visible) {
    if (open_panel_appears) {
      read_folder();
      ImGui::SetKeyboardFocusHere();
      open_panel_appears = false;
    }
    ImGui::SetNextItemWidth(-ImGui::CalcTextSize("Open").x - 3 * ImGui::GetStyle().FramePadding.x);
    const bool entered =
        ImGui::InputTextWithHint("##path", "Path or URL", path, sizeof path,
                                 ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_AutoSelectAll);
    ImGui::SameLine();
    if (ImGui::Button("Open") || entered) opened(path, actions);
    if (!open_problem.empty()) {
      ImGui::PushTextWrapPos(0);
      colored_text(UiColors::kError, shortened(open_problem, 400));
      ImGui::PopTextWrapPos();
    } else if (opening) {
      colored_text(UiColors::kQuiet, "Opening...");
    }
    if (!recent.empty()) {
      colored_text(UiColors::kQuiet, "Recent");
      const std::vector<std::string> shown = recent;
      for (std::size_t i = 0; i < shown.size(); ++i) {
        ImGui::PushID(static_cast<int>(i));
        if (ImGui::Selectable((shortened(file_label(shown[i]), 80) + "###recent").c_str())) opened(shown[i], actions);
        tooltip(shown[i]);
        ImGui::PopID();
      }
      ImGui::Separator();
    }
    if (ImGui::Checkbox("All files", &all_files)) read_folder();
    ImGui::SameLine(0, 16 * scale);
    colored_text(UiColors::kQuiet, shortened(folder, 200));
    ImGui::BeginChild("##folder");
    if (!folder_problem.empty()) colored_text(UiColors::kError, folder_problem);
    std::string go_to;
    if (ImGui::Selectable("../")) go_to = (fs::path(folder) / "..").lexically_normal().string();
    ImGuiListClipper clipper;
    clipper.Begin(static_cast<int>(folder_entries.size()));
    std::string chosen;
    while (clipper.Step()) {
      for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i) {
        const FolderEntry& entry = folder_entries[static_cast<std::size_t>(i)];
        ImGui::PushID(i);
        const std::string label = shortened(entry.name, 120) + (entry.is_folder ? "/###entry" : "###entry");
        if (ImGui::Selectable(label.c_str())) chosen = (fs::path(folder) / entry.name).string();
        ImGui::PopID();
      }
    }
    ImGui::EndChild();
    if (!chosen.empty()) {
      put(path, chosen);
      opened(chosen, actions);
    } else if (!go_to.empty()) {
      folder = go_to;
      read_folder();
    }
  }
  ImGui::End();
}

}  // namespace gs::app
