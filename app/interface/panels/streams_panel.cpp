#include "app/interface/base/rate_choice.h"
#include "app/interface/panels/inspect_panels.h"

#include <imgui.h>

#include <algorithm>
#include <cstdio>
#include <optional>

namespace gs::app {
namespace {

const ImVec4& color_of(LoadStage stage) {
  return stage == LoadStage::failed      ? UiColors::kError
         : stage == LoadStage::arriving  ? UiColors::kAccent
         : stage == LoadStage::cancelled ? UiColors::kWarning
                                         : UiColors::kQuiet;
}

std::string bytes_text(const LoadRow& load) {
  return load.total && *load.total > load.received ? readable_part(load.received, *load.total)
                                                   : readable_size(load.received);
}

std::string label_of_url(const std::string& url) {
  const std::string name = url.substr(url.find_last_of('/') + 1);
  return shortened(name.empty() ? url : name, 60);
}

std::string seconds_text(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, seconds < 1 ? "%.0f ms" : "%.2f s", seconds < 1 ? seconds * 1000 : seconds);
  return text;
}

void plot(const StreamList::Row& row, const char* id, const ImVec2& size) {
  const float most = row.rates.empty() ? 0 : *std::max_element(row.rates.begin(), row.rates.end());
  ImGui::PlotLines(id, row.rates.data(), static_cast<int>(row.rates.size()), 0, nullptr, 0, std::max(most * 1.1f, 1.0f),
                   size);
}

// Draws the control of the active viewport's bandwidth limit.
void limit_choice(const PanelFrame& frame, const UiModel& model, UiActions& actions) {
  const auto active = std::find_if(model.viewports.begin(), model.viewports.end(),
                                   [](const UiViewport& viewport) { return viewport.active; });
  if (active == model.viewports.end()) return;
  ImGui::AlignTextToFramePadding();
  colored_text(UiColors::kQuiet, model.panes > 1 ? "Bandwidth limit of viewport" : "Bandwidth limit");
  ImGui::SameLine();
  if (const auto rate = rate_choice("##most", active->rate, 130 * frame.scale)) {
    actions.pane = PaneRequest{PaneRequest::Kind::limit, active->pane};
    actions.pane->rate = *rate;
  }
  frame.tooltips.show("Limits the network traffic of the active viewport (--rate)");
}

}  // namespace

void StreamsPanel::draw(const PanelFrame& frame, const UiModel& model, UiActions& actions) {
  if (!model.inspection) return;
  Inspection& inspection = *model.inspection;
  inspection.drawn().streams = true;
  limit_choice(frame, model, actions);
  const auto& rows = inspection.streams().rows();
  if (rows.empty()) return colored_text(UiColors::kQuiet, "Nothing is loading.");
  const auto is_chosen = [&](const StreamList::Row& row) {
    return row.ledger.get() == chosen_of_ && row.load.number == chosen_;
  };
  const auto chosen = std::find_if(rows.begin(), rows.end(), is_chosen);
  if (chosen != rows.end()) {
    ImGui::SameLine(0, 16 * frame.scale);
    colored_text(UiColors::kQuiet, label_of_url(chosen->load.url) + ": " + readable_rate(chosen->rate) + ", last " +
                                       std::to_string(static_cast<int>(RateHistory::kSamples * RateHistory::kSeconds)) +
                                       " seconds");
  }
  const float below = chosen == rows.end() ? 0 : 54 * frame.scale;
  constexpr ImGuiTableFlags kFlags =
      ImGuiTableFlags_ScrollY | ImGuiTableFlags_RowBg | ImGuiTableFlags_Resizable | ImGuiTableFlags_SizingFixedFit;
  std::optional<std::size_t> cancelled, retried;
  if (ImGui::BeginTable("##streams", 8, kFlags, {0, -below})) {
    ImGui::TableSetupScrollFreeze(0, 1);
    ImGui::TableSetupColumn("Name", ImGuiTableColumnFlags_WidthStretch, 2);
    for (const char* const title : {"State", "Bytes", "Rate", "Lost", "First picture"}) ImGui::TableSetupColumn(title);
    ImGui::TableSetupColumn("Shown", ImGuiTableColumnFlags_WidthStretch, 3);
    ImGui::TableSetupColumn("##do", ImGuiTableColumnFlags_WidthFixed,
                            ImGui::CalcTextSize("Cancel").x + 12 * frame.scale);
    ImGui::TableHeadersRow();
    ImGuiListClipper clipper;
    clipper.Begin(static_cast<int>(rows.size()));
    while (clipper.Step())
      for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i) {
        const StreamList::Row& row = rows[static_cast<std::size_t>(i)];
        const LoadRow& load = row.load;
        ImGui::TableNextRow();
        ImGui::PushID(i);
        ImGui::TableNextColumn();
        if (ImGui::Selectable("##row", is_chosen(row),
                              ImGuiSelectableFlags_SpanAllColumns | ImGuiSelectableFlags_AllowItemOverlap)) {
          chosen_ = is_chosen(row) ? 0 : load.number;
          chosen_of_ = row.ledger.get();
        }
        frame.tooltips.show(shortened(load.url, 400) + (load.why.empty() ? "" : "\n" + shortened(load.why, 400)));
        ImGui::SameLine(0, 0);
        text(label_of_url(load.url));
        ImGui::TableNextColumn();
        colored_text(color_of(load.stage), state_of(load));
        ImGui::TableNextColumn();
        text(bytes_text(load));
        ImGui::TableNextColumn();
        if (!row.ended()) text(readable_rate(row.rate));
        ImGui::TableNextColumn();
        if (const auto loss = loss_of(load)) {
          char percent[32];
          std::snprintf(percent, sizeof percent, "%.1f %%", *loss * 100);
          colored_text(*loss > 0 ? UiColors::kWarning : UiColors::kQuiet, percent);
        }
        ImGui::TableNextColumn();
        if (load.first_picture) text(seconds_text(*load.first_picture));
        ImGui::TableNextColumn();
        const bool bad = load.stage == LoadStage::failed;
        const std::string slowness = slowness_of(load);
        if (!slowness.empty()) colored_text(UiColors::kWarning, slowness);
        if (!slowness.empty() && !row.detail.empty()) ImGui::SameLine();
        colored_text(bad ? UiColors::kError : UiColors::kQuiet, shortened(bad ? load.why : row.detail, 200));
        ImGui::TableNextColumn();
        if (!row.ended() && ImGui::SmallButton("Cancel")) cancelled = static_cast<std::size_t>(i);
        if ((bad || load.stage == LoadStage::cancelled) && ImGui::SmallButton("Retry"))
          retried = static_cast<std::size_t>(i);
        ImGui::PopID();
      }
    ImGui::EndTable();
  }
  if (chosen != rows.end()) plot(*chosen, "##rate", {ImGui::GetContentRegionAvail().x, 46 * frame.scale});
  if (cancelled) inspection.streams().cancel(rows[*cancelled]);
  if (retried) inspection.streams().retry(rows[*retried]);
}

}  // namespace gs::app
