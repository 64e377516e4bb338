#include "app/interface/base/ui_style.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

namespace gs::app {
namespace {

constexpr float kFontSize = 14.5f;
constexpr double kTooltipDelay = 0.5;  // seconds

ImVec4 with_alpha(ImVec4 color, float alpha) {
  color.w = alpha;
  return color;
}

// Where the free desktops keep a font with Latin, Greek and Cyrillic letters.
constexpr const char* kFonts[] = {
    "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
    "/usr/share/fonts/TTF/DejaVuSans.ttf",
    "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf",
    "/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf",
    "/usr/share/fonts/truetype/noto/NotoSans-Regular.ttf",
};

}  // namespace

void load_font(float scale) {
  static constexpr ImWchar kRanges[] = {0x0020, 0x024F, 0x0370, 0x052F, 0x2010, 0x2044, 0x2190, 0x21FF, 0};
  ImFontAtlas& fonts = *ImGui::GetIO().Fonts;
  ImFontConfig config;
  config.OversampleH = 2;
  const float size = std::round(kFontSize * scale);
  for (const char* path : kFonts) {
    std::error_code error;
    if (std::filesystem::is_regular_file(path, error) && fonts.AddFontFromFileTTF(path, size, &config, kRanges)) return;
  }
  config.SizePixels = std::round(13 * scale);
  fonts.AddFontDefault(&config);
}

void set_style(float scale) {
  ImGui::StyleColorsDark();
  ImGuiStyle& style = ImGui::GetStyle();
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
  const ImVec4 lighter(1, 1, 1, 1);
  const std::pair<ImGuiCol, ImVec4> colors[] = {
      {ImGuiCol_Text, UiColors::kText},
      {ImGuiCol_TextDisabled, UiColors::kQuiet},
      {ImGuiCol_WindowBg, UiColors::kPanel},
      {ImGuiCol_PopupBg, UiColors::kPanel},
      {ImGuiCol_Border, with_alpha(lighter, 0.09f)},
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

ImVec4 color_of(vrml::Severity severity) {
  switch (severity) {
    case vrml::Severity::error:
      return UiColors::kError;
    case vrml::Severity::warning:
      return UiColors::kWarning;
    case vrml::Severity::note:
      break;
  }
  return UiColors::kNote;
}

void text(std::string_view text) { ImGui::TextUnformatted(text.data(), text.data() + text.size()); }

void colored_text(const ImVec4& color, std::string_view string) {
  ImGui::PushStyleColor(ImGuiCol_Text, color);
  text(string);
  ImGui::PopStyleColor();
}

bool switch_button(const char* label, bool on, bool is_panel) {
  if (on) {
    const ImVec4& accent = UiColors::kAccent;
    const ImVec4 color = is_panel ? ImVec4(1, 1, 1, 0.18f) : ImVec4(accent.x, accent.y, accent.z, 0.55f);
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
