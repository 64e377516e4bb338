#include "app/interface/base/text_field.h"

#include "app/interface/base/fonts.h"
#include "app/interface/base/sight_order.h"
#include "render/text/utf8.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace gs::app {
namespace {

bool begins_character(char byte) { return (static_cast<unsigned char>(byte) & 0xC0) != 0x80; }

/// Line of text with right-to-left parts, in visual order. It is drawn over Dear ImGui's own text, which is hidden
/// because it has logical order.
struct SeenLine {
  std::u32string text;
  SightOrder order;
  std::vector<float> edges;  // x positions between the visual characters, from 0 at the left; one more than characters

  explicit SeenLine(const std::string& utf8) : text(render::characters_of(utf8)), order(sight_order(text)) {
    InterfaceFonts* const fonts = InterfaceFonts::current();
    const ImFont& font = *ImGui::GetFont();
    const float scale = ImGui::GetFontSize() / font.FontSize;
    float edge = 0;
    for (char32_t& character : order.characters) {
      edges.push_back(edge);
      if (character == SightOrder::kNothing) continue;
      if (fonts) character = fonts->drawn(character);
      edge += font.GetCharAdvance(static_cast<ImWchar>(character)) * scale;
    }
    edges.push_back(edge);
  }
  /// Returns the index of the character at a byte offset.
  [[nodiscard]] std::size_t character_at(std::string_view bytes, int byte) const {
    const std::string_view before = bytes.substr(0, static_cast<std::size_t>(std::max(byte, 0)));
    const auto count = std::count_if(before.begin(), before.end(), begins_character);
    return std::min(static_cast<std::size_t>(count), text.size());
  }
  [[nodiscard]] static int byte_of(std::string_view bytes, std::size_t character) {
    std::size_t byte = 0;
    while (byte < bytes.size() && !(begins_character(bytes[byte]) && character-- == 0)) ++byte;
    return static_cast<int>(byte);
  }
  /// Returns the text index at which to insert after a click at `x`, measured from the left of the line.
  [[nodiscard]] std::size_t pointed(float x) const {
    if (order.characters.empty()) return 0;
    std::size_t place = 0;
    while (place + 1 < order.characters.size() && edges[place + 1] <= x) ++place;
    return order.index_at(place, x > (edges[place] + edges[place + 1]) / 2);
  }
};

struct Editing {
  std::string& text;
  bool to_end;  // a command focused the field: move the caret to the end of the text
  FieldEvents& events;
  const FieldKeys& keys;
  const SeenLine* line;      // null if the text is left-to-right
  float left = 0;  // screen x of the left end of the line
  int cursor = 0, held = 0;  // byte offsets: the caret, and where the mouse button was pressed
  int selected_from = 0, selected_to = 0;
};

// Moves the caret and the selection to the pointer by the visual order. Dear ImGui itself would use the logical order.
void follow_pointer(ImGuiInputTextCallbackData& data, Editing& editing) {
  const ImGuiIO& io = ImGui::GetIO();
  if (!editing.line || !io.MouseDown[0] || io.MouseDoubleClicked[0] || io.KeyShift) return;
  const std::size_t pointed = editing.line->pointed(io.MousePos.x - editing.left);
  const int at = SeenLine::byte_of({data.Buf, static_cast<std::size_t>(data.BufTextLen)}, pointed);
  if (ImGui::IsMouseClicked(ImGuiMouseButton_Left)) editing.held = at;
  data.CursorPos = data.SelectionEnd = at;
  data.SelectionStart = editing.held;
}

std::string present_text(const ImGuiInputTextCallbackData& data) {
  return {data.Buf, static_cast<std::size_t>(data.BufTextLen)};
}

void replace_text(ImGuiInputTextCallbackData& data, const std::string& text) {
  data.DeleteChars(0, data.BufTextLen);
  data.InsertChars(0, text.c_str());
}

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
      follow_pointer(*data, editing);
      editing.cursor = data->CursorPos;
      editing.selected_from = std::min(data->SelectionStart, data->SelectionEnd);
      editing.selected_to = std::max(data->SelectionStart, data->SelectionEnd);
      break;
    case ImGuiInputTextFlags_CallbackHistory:
      if (const bool up = data->EventKey == ImGuiKey_UpArrow; !editing.keys.recall)
        editing.events.moved += up ? -1 : 1;
      else if (const auto recalled = editing.keys.recall(up, present_text(*data)))
        replace_text(*data, *recalled);
      break;
    case ImGuiInputTextFlags_CallbackCompletion: {
      replace_text(*data, editing.keys.complete(present_text(*data)));
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

// Returns the x of the line's left end within the frame of the previous item, scrolled so that the caret is visible.
float left_of_line(const SeenLine& line, float from, float to, std::size_t caret) {
  const float width = to - from, at = line.edges[std::min(caret, line.edges.size() - 1)];
  if (line.edges.back() <= width) return from;
  return from - std::clamp(at - width / 2, 0.0f, line.edges.back() - width);
}

void draw_line(const SeenLine& line, const Editing& editing, bool active) {
  const ImVec2 padding = ImGui::GetStyle().FramePadding;
  const ImVec2 lower = ImGui::GetItemRectMin(), upper = ImGui::GetItemRectMax();
  const std::string& bytes = editing.text;
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  draw.PushClipRect({lower.x + padding.x, lower.y}, {upper.x - padding.x, upper.y}, true);
  const float top = lower.y + padding.y, bottom = top + ImGui::GetFontSize();
  if (active)
    for (std::size_t i = line.character_at(bytes, editing.selected_from);
         i < line.character_at(bytes, editing.selected_to); ++i) {
      const std::size_t place = line.order.places[i];
      draw.AddRectFilled({editing.left + line.edges[place], top - 1},
                         {editing.left + line.edges[place + 1], bottom + 1},
                         ImGui::GetColorU32(ImGuiCol_TextSelectedBg));
    }
  const ImU32 color = ImGui::GetColorU32(ImGuiCol_Text);
  for (std::size_t place = 0; place < line.order.characters.size(); ++place)
    if (line.order.characters[place] != SightOrder::kNothing)
      ImGui::GetFont()->RenderChar(&draw, ImGui::GetFontSize(), {editing.left + line.edges[place], top}, color,
                                   static_cast<ImWchar>(line.order.characters[place]));
  if (active && std::fmod(ImGui::GetTime(), 1.2) < 0.8) {
    const float at = editing.left + line.edges[line.order.caret(line.character_at(bytes, editing.cursor))];
    draw.AddLine({at, top - 1}, {at, bottom + 1}, color);
  }
  draw.PopClipRect();
}

}  // namespace

FieldEvents text_field(const char* id, const char* hint, std::string& text, float width, bool selects_all,
                       const FieldKeys& keys) {
  FieldEvents events;
  if (width <= 0) width = std::max(1.0f, ImGui::GetContentRegionAvail().x + width);
  if (text.size() > kLongestTyped) text.resize(kLongestTyped);
  const std::string before = text;
  // Request the glyphs of the field's text.
  if (InterfaceFonts* fonts = InterfaceFonts::current())
    for (const char32_t character : render::characters_of(text)) fonts->note(character);
  ImGuiStorage& storage = *ImGui::GetStateStorage();
  const ImGuiID begun = ImGui::GetID((std::string(id) + "-begun").c_str());
  const ImGuiID held = ImGui::GetID((std::string(id) + "-held").c_str());
  const ImGuiID cursor = ImGui::GetID((std::string(id) + "-cursor").c_str());
  std::optional<SeenLine> line;
  if (has_right_to_left(render::characters_of(text))) line.emplace(text);
  Editing editing{text, storage.GetBool(begun), events, keys, line ? &*line : nullptr};
  editing.held = storage.GetInt(held);
  editing.cursor = storage.GetInt(cursor);
  if (line) {
    const float from = ImGui::GetCursorScreenPos().x + ImGui::GetStyle().FramePadding.x;
    editing.left = left_of_line(*line, from, from + width - 2 * ImGui::GetStyle().FramePadding.x,
                                line->order.caret(line->character_at(text, editing.cursor)));
    ImGui::PushStyleColor(ImGuiCol_Text, {0, 0, 0, 0});
    ImGui::PushStyleColor(ImGuiCol_TextSelectedBg, {0, 0, 0, 0});
  }
  storage.SetBool(begun, false);
  ImGuiInputTextFlags flags = ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_CallbackResize |
                              ImGuiInputTextFlags_CallbackHistory | ImGuiInputTextFlags_CallbackCharFilter |
                              ImGuiInputTextFlags_CallbackAlways;
  if (selects_all) flags |= ImGuiInputTextFlags_AutoSelectAll;
  if (keys.complete) flags |= ImGuiInputTextFlags_CallbackCompletion;
  ImGui::SetNextItemWidth(width);
  events.entered = ImGui::InputTextWithHint(id, hint, text.data(), text.capacity() + 1, flags, edited, &editing);
  events.active = ImGui::IsItemActive();
  if (line) {
    ImGui::PopStyleColor(2);
    if (text != before) line.emplace(text);
    draw_line(*line, editing, events.active);
  }
  storage.SetInt(held, editing.held);
  storage.SetInt(cursor, editing.cursor);
  if (ImGui::IsItemActivated() && !selects_all && !ImGui::IsMouseDown(ImGuiMouseButton_Left))
    storage.SetBool(begun, true);
  events.changed = events.changed || text != before;
  return events;
}

}  // namespace gs::app
