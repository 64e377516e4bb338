#include "app/interface/base/text_field.h"

#include "app/interface/base/fonts.h"
#include "render/text/utf8.h"

#include <imgui.h>

#include <utility>

namespace gs::app {
namespace {

constexpr std::size_t kLongestTyped = 8192;

struct Editing {
  std::string& text;
  bool to_end;  // who gets the keys by a command goes on behind what is there
  FieldEvents& events;
  const std::function<std::string(const std::string&)>& complete;
};

int edited(ImGuiInputTextCallbackData* data) {
  Editing& editing = *static_cast<Editing*>(data->UserData);
  switch (data->EventFlag) {
    case ImGuiInputTextFlags_CallbackResize:
      editing.text.resize(static_cast<std::size_t>(data->BufTextLen));
      data->Buf = editing.text.data();
      break;
    case ImGuiInputTextFlags_CallbackAlways:
      if (std::exchange(editing.to_end, false))
        data->CursorPos = data->SelectionStart = data->SelectionEnd = data->BufTextLen;
      break;
    case ImGuiInputTextFlags_CallbackHistory:
      editing.events.moved += data->EventKey == ImGuiKey_UpArrow ? -1 : 1;
      break;
    case ImGuiInputTextFlags_CallbackCompletion: {
      const std::string completed =
          editing.complete(std::string(data->Buf, static_cast<std::size_t>(data->BufTextLen)));
      data->DeleteChars(0, data->BufTextLen);
      data->InsertChars(0, completed.c_str());
      editing.events.changed = true;
      break;
    }
    case ImGuiInputTextFlags_CallbackCharFilter:
      if (InterfaceFonts* fonts = InterfaceFonts::current()) fonts->note(data->EventChar);
      break;
    default:
      break;
  }
  return 0;
}

}  // namespace

FieldEvents text_field(const char* id, const char* hint, std::string& text, float width, bool selects_all,
                       const std::function<std::string(const std::string&)>& complete) {
  FieldEvents events;
  if (text.size() > kLongestTyped) text.resize(kLongestTyped);
  const std::string before = text;
  // Its characters are shown one by one, as they stand in it.
  if (InterfaceFonts* fonts = InterfaceFonts::current())
    for (const char32_t character : render::characters_of(text)) fonts->note(character);
  ImGuiStorage& storage = *ImGui::GetStateStorage();
  const ImGuiID begun = ImGui::GetID((std::string(id) + "-begun").c_str());
  Editing editing{text, storage.GetBool(begun), events, complete};
  storage.SetBool(begun, false);
  ImGuiInputTextFlags flags = ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_CallbackResize |
                              ImGuiInputTextFlags_CallbackHistory | ImGuiInputTextFlags_CallbackCharFilter |
                              ImGuiInputTextFlags_CallbackAlways;
  if (selects_all) flags |= ImGuiInputTextFlags_AutoSelectAll;
  if (complete) flags |= ImGuiInputTextFlags_CallbackCompletion;
  ImGui::SetNextItemWidth(width);
  events.entered = ImGui::InputTextWithHint(id, hint, text.data(), text.capacity() + 1, flags, edited, &editing);
  events.active = ImGui::IsItemActive();
  if (ImGui::IsItemActivated() && !selects_all && !ImGui::IsMouseDown(ImGuiMouseButton_Left))
    storage.SetBool(begun, true);
  events.changed = events.changed || text != before;
  return events;
}

}  // namespace gs::app
