#include "app/interface/base/fuzzy.h"
#include "app/interface/base/text_field.h"
#include "app/interface/ui_state.h"
#include "app/session/documents/documents.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <string>

// Address bar with its list of suggestions.
namespace gs::app {
namespace {

constexpr std::size_t kMaxSuggestions = 12;
constexpr ImGuiWindowFlags kListFlags = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                        ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoNav |
                                        ImGuiWindowFlags_NoFocusOnAppearing;

}  // namespace

// Returns suggestions for typed text: matching bookmarks and recent files, then completions of the text as a path.
std::vector<UiOverlay::State::Suggestion> UiOverlay::State::suggestions(const UiModel& model,
                                                                        const std::string& typed) {
  std::vector<Suggestion> result;
  const auto add = [&](const std::string& place, const std::string& label, Icon icon) {
    const bool there = std::any_of(result.begin(), result.end(), [&](const Suggestion& s) { return s.place == place; });
    if (!there && result.size() < kMaxSuggestions) result.push_back({place, label, icon});
  };
  if (!looks_like_path(typed)) {
    for (const Bookmark& one : model.bookmarks)
      if (one.viewpoint.empty() && fuzzy_score(one.title + " " + one.place, typed))
        add(one.place, one.title + "   " + without_home(one.place), Icon::bookmarked);
    for (const std::string& place : model.recent)
      if (fuzzy_score(without_home(place), typed)) add(place, without_home(place), Icon::clock);
  }
  for (const std::string& path : suggested_paths(typed, listing, kMaxSuggestions))
    add(path, path, path.ends_with('/') ? Icon::folder : Icon::file);
  return result;
}

std::optional<std::size_t> UiOverlay::State::suggestion_rows(const std::vector<Suggestion>& rows,
                                                             std::optional<std::size_t> chosen) {
  std::optional<std::size_t> clicked;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    ImGui::PushID(static_cast<int>(i));
    const ImVec2 place = ImGui::GetCursorPos();
    if (ImGui::Selectable("##row", chosen == i)) clicked = i;
    const ImVec2 next = ImGui::GetCursorPos();
    ImGui::SetCursorPos(place);
    inline_icon(rows[i].icon);
    text(shortened(rows[i].label, 200));
    ImGui::SetCursorPos(next);
    ImGui::PopID();
  }
  return clicked;
}

void UiOverlay::State::address_bar(const UiModel& model, UiActions& actions, float width) {
  Address& bar = address;
  if (bar.active || (text_waits == 0 && !bar.wanted)) bar.retried.clear();
  if (!bar.active) bar.text = bar.retried.empty() ? without_home(model.address) : bar.retried;
  if (std::exchange(bar.wanted, false)) ImGui::SetKeyboardFocusHere();
  const FieldEvents events = text_field("##address", "Path or URL", bar.text, width, bar.retried.empty(),
                                        {[this](const std::string& typed) { return completed_path(typed, listing); }});
  if (!bar.active) tooltip("Path or URL of the world (" + keys_of(row_of(Action::address)) + ")");
  const ImVec2 lower = ImGui::GetItemRectMin(), upper = ImGui::GetItemRectMax();
  if (events.active && !bar.active) listing.forget();
  if (events.changed) bar.chosen.reset();
  // In the frame of Enter, the field has already lost the focus but its text counts as typed.
  bar.typed = (events.active || events.entered) && (bar.typed || events.changed);
  bar.active = events.active;
  const bool listed = bar.active || bar.list_hovered || events.entered;
  std::vector<Suggestion> rows;
  if (listed) rows = suggestions(model, bar.typed ? bar.text : std::string());
  if (events.moved != 0 && !rows.empty()) {
    const int count = static_cast<int>(rows.size());
    const int at = bar.chosen ? static_cast<int>(*bar.chosen) + events.moved : events.moved > 0 ? 0 : count - 1;
    bar.chosen = static_cast<std::size_t>((at + count) % count);
  }
  if (bar.chosen && *bar.chosen >= rows.size()) bar.chosen.reset();
  std::optional<std::string> place;
  if (events.entered) place = bar.chosen ? rows[*bar.chosen].place : bar.text;
  if (listed && !rows.empty() && !place) {
    ImGui::SetNextWindowPos({lower.x, upper.y + std::round(2 * scale)});
    ImGui::SetNextWindowSizeConstraints({upper.x - lower.x, 0}, {upper.x - lower.x, 400 * scale});
    ImGui::PushStyleColor(ImGuiCol_WindowBg, UiColors::kPopup);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {6 * scale, 6 * scale});
    ImGui::Begin("##suggestions", nullptr, kListFlags | ImGuiWindowFlags_AlwaysAutoResize);
    ImGui::PopStyleVar();
    ImGui::PopStyleColor();
    bar.list_hovered = ImGui::IsWindowHovered();
    if (const auto clicked = suggestion_rows(rows, bar.chosen)) place = rows[*clicked].place;
    ImGui::End();
  } else {
    bar.list_hovered = false;
  }
  if (!place) return;
  bar = {};
  bar.opening = *place;
  if (const std::string path = opened_path(*place); !path.empty()) actions.open = path;
}

}  // namespace gs::app
