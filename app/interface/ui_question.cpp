#include "app/interface/ui_state.h"

#include <imgui.h>

#include <utility>

namespace gs::app {
namespace {

constexpr const char* kQuestionTitle = "Files outside of the world's folder";
constexpr std::size_t kLongestPath = 300;

}  // namespace

// May this world read that folder? Nothing else goes on in the panels meanwhile.
void UiOverlay::State::question_panel(const UiModel& model, UiActions& actions) {
  question = model.question.has_value();
  const bool refused = std::exchange(question_refused, false);
  if (!question) return;
  if (!ImGui::IsPopupOpen(kQuestionTitle)) ImGui::OpenPopup(kQuestionTitle);
  const ImVec2 window = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({window.x / 2, window.y / 2}, ImGuiCond_Always, {0.5f, 0.5f});
  const ImGuiWindowFlags flags =
      ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoMove;
  if (!ImGui::BeginPopupModal(kQuestionTitle, nullptr, flags)) return;
  ImGui::PushTextWrapPos(ImGui::GetFontSize() * 34);
  text(shortened(model.question->world, kLongestPath) + " refers to " +
       shortened(model.question->reference, kLongestPath) + ", which lies in the folder");
  colored_text(UiColors::kAccent, shortened(model.question->folder, kLongestPath));
  text("May worlds of this machine read that folder and what is below it, as long as this window is open?");
  ImGui::PopTextWrapPos();
  ImGui::Spacing();
  if (ImGui::Button("Allow this folder")) actions.allow_folder = true;
  ImGui::SameLine();
  if (ImGui::Button("Don't allow") || refused) actions.allow_folder = false;
  if (actions.allow_folder) ImGui::CloseCurrentPopup();
  ImGui::EndPopup();
}

}  // namespace gs::app
