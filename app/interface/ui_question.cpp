#include "app/interface/ui_state.h"

#include <imgui.h>

#include <utility>

namespace gs::app {
namespace {

constexpr const char* kFolderTitle = "File access";
constexpr const char* kNetworkTitle = "Network access";
constexpr std::size_t kLongestPath = 300;

void ask_for_folder(const UiQuestion& question) {
  text(question.world + " refers to " + question.reason + " in the folder");
  colored_text(UiColors::kAccent, question.subject);
  text("Allow local worlds to read this folder and its subfolders until the window closes?");
}

void ask_for_network(const UiQuestion& question) {
  text("A Script of " + question.world + " read the local file " + question.reason + " and now requests");
  colored_text(UiColors::kAccent, question.subject);
  text("The request can send the content of the file to that host. Allow Scripts of this world to use the network?");
}

}  // namespace

// Asks the user a question about the permission of a world. Panels are disabled until the answer.
void UiOverlay::State::question_panel(const UiModel& model, UiActions& actions) {
  question = model.question.has_value();
  const bool refused = std::exchange(question_refused, false);
  if (!question) return;
  UiQuestion asked = *model.question;
  for (std::string* const part : {&asked.world, &asked.subject, &asked.reason}) *part = shortened(*part, kLongestPath);
  const bool about_folder = asked.kind == UiQuestion::Kind::folder;
  const char* const title = about_folder ? kFolderTitle : kNetworkTitle;
  if (!ImGui::IsPopupOpen(title)) ImGui::OpenPopup(title);
  const ImVec2 window = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({window.x / 2, window.y / 2}, ImGuiCond_Always, {0.5f, 0.5f});
  const ImGuiWindowFlags flags =
      ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoMove;
  if (!ImGui::BeginPopupModal(title, nullptr, flags)) return;
  ImGui::PushTextWrapPos(ImGui::GetFontSize() * 34);
  about_folder ? ask_for_folder(asked) : ask_for_network(asked);
  ImGui::PopTextWrapPos();
  ImGui::Spacing();
  if (ImGui::Button(about_folder ? "Allow this folder" : "Allow network access")) actions.allow_question = true;
  ImGui::SameLine();
  if (ImGui::Button("Don't allow") || refused) actions.allow_question = false;
  if (actions.allow_question) ImGui::CloseCurrentPopup();
  ImGui::EndPopup();
}

}  // namespace gs::app
