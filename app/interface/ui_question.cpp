#include "app/interface/ui_state.h"

#include <imgui.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

namespace gs::app {
namespace {

constexpr const char* kFolderTitle = "File access";
constexpr const char* kNetworkTitle = "Network access";
constexpr const char* kReplaceTitle = "Replace file";
constexpr const char* kUnsavedTitle = "Unsaved changes";
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

void ask_to_replace(const UiQuestion& question) {
  text("The file already exists:");
  colored_text(UiColors::kAccent, question.subject);
  text("Replace it?");
}

void ask_about_edits(const UiQuestion& question) {
  colored_text(UiColors::kAccent, question.world);
  text("has changes that are not saved. Save them?");
}

/// Appearance of a kind of question.
struct QuestionRow {
  UiQuestion::Kind kind;
  const char* title;
  void (*ask)(const UiQuestion& question);
  const char *accept, *discard, *refuse;  // labels of the buttons; null if the question lacks the button
};
constexpr QuestionRow kQuestions[] = {
    {UiQuestion::Kind::folder, kFolderTitle, ask_for_folder, "Allow this folder", nullptr, "Don't allow"},
    {UiQuestion::Kind::network, kNetworkTitle, ask_for_network, "Allow network access", nullptr, "Don't allow"},
    {UiQuestion::Kind::replace, kReplaceTitle, ask_to_replace, "Replace", nullptr, "Cancel"},
    {UiQuestion::Kind::unsaved, kUnsavedTitle, ask_about_edits, "Save as", "Discard changes", "Cancel"},
};

}  // namespace

// Asks the user a question about a permission, or before data are lost. Panels are disabled until the answer.
void UiOverlay::State::question_panel(const UiModel& model, UiActions& actions) {
  question = model.question.has_value();
  const bool refused = std::exchange(question_refused, false);
  if (!question) return;
  UiQuestion asked = *model.question;
  for (std::string* const part : {&asked.world, &asked.subject, &asked.reason}) *part = shortened(*part, kLongestPath);
  const QuestionRow& row = *std::find_if(std::begin(kQuestions), std::end(kQuestions),
                                         [&](const QuestionRow& one) { return one.kind == asked.kind; });
  const bool permits = asked.kind == UiQuestion::Kind::folder || asked.kind == UiQuestion::Kind::network;
  const char* const title = row.title;
  if (!ImGui::IsPopupOpen(title)) ImGui::OpenPopup(title);
  const ImVec2 window = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({window.x / 2, window.y / 2}, ImGuiCond_Always, {0.5f, 0.5f});
  const ImGuiWindowFlags flags =
      ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoMove;
  if (!ImGui::BeginPopupModal(title, nullptr, flags)) return;
  ImGui::PushTextWrapPos(ImGui::GetFontSize() * 34);
  row.ask(asked);
  ImGui::PopTextWrapPos();
  ImGui::Spacing();
  std::optional<UiAnswer> answer;
  if (ImGui::Button(row.accept)) answer = UiAnswer::save;
  ImGui::SameLine();
  if (row.discard) {
    if (ImGui::Button(row.discard)) answer = UiAnswer::discard;
    ImGui::SameLine();
  }
  if (ImGui::Button(row.refuse) || refused) answer = UiAnswer::cancel;
  if (answer && permits)
    actions.allow_question = *answer == UiAnswer::save;
  else
    actions.answer = answer;
  if (answer) ImGui::CloseCurrentPopup();
  ImGui::EndPopup();
}

}  // namespace gs::app
