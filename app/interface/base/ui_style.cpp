#include "app/interface/base/ui_style.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace gs::app {
namespace {

constexpr double kTooltipDelay = 0.5;  // seconds

ImVec4 shade(float value) { return {value, value, value, 1}; }

void set_colors(Theme theme) {
  const bool dark = theme == Theme::dark;
  UiColors::kText = dark ? ImVec4(0.88f, 0.89f, 0.91f, 1) : ImVec4(0.11f, 0.12f, 0.14f, 1);
  UiColors::kQuiet = dark ? ImVec4(0.58f, 0.61f, 0.66f, 1) : ImVec4(0.38f, 0.41f, 0.45f, 1);
  UiColors::kAccent = dark ? ImVec4(0.30f, 0.58f, 0.90f, 1) : ImVec4(0.10f, 0.42f, 0.78f, 1);
  UiColors::kBar = dark ? ImVec4(0.125f, 0.135f, 0.150f, 1) : ImVec4(0.885f, 0.895f, 0.910f, 1);
  UiColors::kPanel = dark ? ImVec4(0.145f, 0.155f, 0.172f, 1) : ImVec4(0.945f, 0.950f, 0.958f, 1);
  UiColors::kPopup = dark ? ImVec4(0.170f, 0.182f, 0.202f, 1) : ImVec4(0.985f, 0.988f, 0.992f, 1);
  UiColors::kError = dark ? ImVec4(0.96f, 0.42f, 0.40f, 1) : ImVec4(0.75f, 0.13f, 0.12f, 1);
  UiColors::kWarning = dark ? ImVec4(0.95f, 0.76f, 0.34f, 1) : ImVec4(0.60f, 0.40f, 0.02f, 1);
  UiColors::kNote = dark ? ImVec4(0.52f, 0.72f, 0.95f, 1) : ImVec4(0.10f, 0.36f, 0.66f, 1);
  UiColors::kContrast = shade(dark ? 1.0f : 0.0f);
}

}  // namespace

ImVec4 with_alpha(ImVec4 color, float alpha) {
  color.w = alpha;
  return color;
}

void set_style(Theme theme, float scale) {
  set_colors(theme);
  if (theme == Theme::dark)
    ImGui::StyleColorsDark();
  else
    ImGui::StyleColorsLight();
  ImGuiStyle& style = ImGui::GetStyle();
  style = [&] {
    ImGuiStyle fresh;  // default sizes, so that scaling does not accumulate
    std::copy(std::begin(style.Colors), std::end(style.Colors), std::begin(fresh.Colors));
    return fresh;
  }();
  style.WindowRounding = 6;
  style.PopupRounding = style.FrameRounding = style.GrabRounding = style.ScrollbarRounding = 4;
  style.WindowBorderSize = style.PopupBorderSize = 1;
  style.FrameBorderSize = 0;
  style.WindowPadding = {12, 10};
  style.FramePadding = {9, 4};
  style.ItemSpacing = {6, 6};
  style.ItemInnerSpacing = {6, 4};
  style.ScrollbarSize = 12;
  style.DisabledAlpha = 0.4f;
  const ImVec4& lighter = UiColors::kContrast;
  const std::pair<ImGuiCol, ImVec4> colors[] = {
      {ImGuiCol_Text, UiColors::kText},
      {ImGuiCol_TextDisabled, UiColors::kQuiet},
      {ImGuiCol_WindowBg, UiColors::kPanel},
      {ImGuiCol_PopupBg, UiColors::kPopup},
      {ImGuiCol_MenuBarBg, UiColors::kBar},
      {ImGuiCol_Tab, with_alpha(lighter, 0.04f)},
      {ImGuiCol_TabHovered, with_alpha(lighter, 0.14f)},
      {ImGuiCol_TabActive, with_alpha(lighter, 0.11f)},
      {ImGuiCol_TabUnfocused, with_alpha(lighter, 0.04f)},
      {ImGuiCol_TabUnfocusedActive, with_alpha(lighter, 0.11f)},
      {ImGuiCol_ModalWindowDimBg, ImVec4(0, 0, 0, 0.35f)},
      {ImGuiCol_Border, with_alpha(lighter, 0.12f)},
      {ImGuiCol_FrameBg, with_alpha(lighter, 0.07f)},
      {ImGuiCol_FrameBgHovered, with_alpha(lighter, 0.12f)},
      {ImGuiCol_FrameBgActive, with_alpha(lighter, 0.16f)},
      {ImGuiCol_Button, with_alpha(lighter, 0.07f)},
      {ImGuiCol_ButtonHovered, with_alpha(lighter, 0.15f)},
      {ImGuiCol_ButtonActive, with_alpha(UiColors::kAccent, 0.7f)},
      {ImGuiCol_Header, with_alpha(UiColors::kAccent, 0.35f)},
      {ImGuiCol_HeaderHovered, with_alpha(lighter, 0.12f)},
      {ImGuiCol_HeaderActive, with_alpha(UiColors::kAccent, 0.5f)},
      {ImGuiCol_CheckMark, UiColors::kAccent},
      {ImGuiCol_Separator, with_alpha(lighter, 0.12f)},
      {ImGuiCol_TitleBg, UiColors::kBar},
      {ImGuiCol_TitleBgActive, UiColors::kBar},
      {ImGuiCol_PlotHistogram, UiColors::kAccent},
      {ImGuiCol_TextSelectedBg, with_alpha(UiColors::kAccent, 0.5f)},
      {ImGuiCol_TableRowBgAlt, with_alpha(lighter, 0.025f)},
  };
  for (const auto& [index, color] : colors) style.Colors[index] = color;
  style.ScaleAllSizes(scale);
}

ImVec4 color_of(Severity severity) {
  return severity == Severity::error     ? UiColors::kError
         : severity == Severity::warning ? UiColors::kWarning
                                         : UiColors::kNote;
}

void text(std::string_view text) {
  const std::string drawn = shown(text);
  ImGui::TextUnformatted(drawn.data(), drawn.data() + drawn.size());
}

std::string label_of(std::string_view text, std::string_view id) {
  std::string label = shown(text);
  // Insert a blank into "##", because Dear ImGui would start an ID there.
  for (std::size_t at = 0; (at = label.find("##", at)) != std::string::npos; ++at) label.insert(at + 1, " ");
  return label.append("###").append(id);
}

void colored_text(const ImVec4& color, std::string_view string) {
  ImGui::PushStyleColor(ImGuiCol_Text, color);
  text(string);
  ImGui::PopStyleColor();
}

bool switch_button(const char* label, bool on, bool is_panel) {
  if (on) {
    const ImVec4& accent = UiColors::kAccent;
    const ImVec4 color =
        is_panel ? with_alpha(UiColors::kContrast, 0.18f) : ImVec4(accent.x, accent.y, accent.z, 0.55f);
    ImGui::PushStyleColor(ImGuiCol_Button, color);
    ImGui::PushStyleColor(ImGuiCol_ButtonHovered, color);
  }
  const bool pressed = ImGui::Button(label);
  if (on) ImGui::PopStyleColor(2);
  return pressed;
}

void Tooltips::begin(double now, bool wanted) {
  now_ = now;
  wanted_ = wanted;
  hovers_ = false;
}

void Tooltips::show(std::string_view string) {
  if (!ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) return;
  const ImVec2 item = ImGui::GetItemRectMin();
  if (item.x != item_.x || item.y != item_.y) {
    item_ = item;
    since_ = now_;
  }
  hovers_ = true;
  if (now_ - since_ < kTooltipDelay || !wanted_) return;
  ImGui::BeginTooltip();
  ImGui::PushTextWrapPos(ImGui::GetFontSize() * 32);
  text(string);
  ImGui::PopTextWrapPos();
  ImGui::EndTooltip();
}

void Tooltips::end() {
  if (!hovers_) item_ = {-1, -1};
}

std::optional<double> Tooltips::next() const {
  const double wait = since_ + kTooltipDelay - now_;
  return hovers_ && wait > 0 ? std::optional(wait) : std::nullopt;
}

}  // namespace gs::app
