#include "app/interface/panels/inspect_panels.h"

#include <imgui.h>

#include <algorithm>
#include <cstdio>
#include <limits>

namespace gs::app {
namespace {

// Draws one end of a ROUTE: the event, and the node's name, which selects the node when clicked.
void end_of(const PanelFrame& frame, Inspection& inspection, const char* id, const NodeAt& node,
            const std::string& event, float light) {
  const bool chosen = node == inspection.selected();
  ImGui::PushID(id);
  if (chosen) ImGui::PushStyleColor(ImGuiCol_Text, UiColors::kAccent);
  if (ImGui::Selectable("##end", chosen, ImGuiSelectableFlags_AllowItemOverlap)) inspection.select(node, true);
  frame.tooltips.show(label_of(node) + "." + shortened(event, 60));
  ImGui::SameLine(0, 0);
  text(label_of(node));
  if (chosen) ImGui::PopStyleColor();
  ImGui::SameLine(0, 0);
  colored_text(light > 0 ? UiColors::kWarning : UiColors::kQuiet, "." + shortened(event, 60));
  ImGui::PopID();
}

}  // namespace

void RoutesPanel::draw(const PanelFrame& frame, const UiModel& model, UiActions&) {
  Inspection* const shown = drawn_inspection(model, &InspectionWants::routes);
  if (!shown) return;
  Inspection& inspection = *shown;
  bool only = inspection.routes().only_selected();
  if (ImGui::Checkbox("Of the selected node", &only)) inspection.routes().set_only_selected(only);
  frame.tooltips.show("Shows only ROUTEs from and to the selected node");
  const RouteList& routes = inspection.routes();
  ImGui::SameLine();
  colored_text(UiColors::kQuiet, only ? std::to_string(routes.rows().size()) + " of " + std::to_string(routes.all())
                                      : std::to_string(routes.all()));
  if (routes.rows().empty())
    return colored_text(UiColors::kQuiet,
                        routes.all() == 0 ? "The world has no ROUTEs." : "The selected node has no ROUTEs.");
  if (!ImGui::BeginTable("##routes", 3, ImGuiTableFlags_ScrollY | ImGuiTableFlags_RowBg | ImGuiTableFlags_Resizable))
    return;
  ImGui::TableSetupScrollFreeze(0, 1);
  ImGui::TableSetupColumn("From", ImGuiTableColumnFlags_WidthStretch);
  ImGui::TableSetupColumn("To", ImGuiTableColumnFlags_WidthStretch);
  ImGui::TableSetupColumn("per second", ImGuiTableColumnFlags_WidthFixed, ImGui::CalcTextSize("per second").x);
  ImGui::TableHeadersRow();
  ImGuiListClipper clipper;
  clipper.Begin(static_cast<int>(std::min<std::size_t>(routes.rows().size(), std::numeric_limits<int>::max())));
  while (clipper.Step())
    for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i) {
      const RouteList::Row& row = routes.rows()[static_cast<std::size_t>(i)];
      const float light = RouteList::light_of(row, inspection.events(), inspection.world()->now());
      ImGui::TableNextRow();
      if (light > 0) {
        ImVec4 glow = UiColors::kWarning;
        glow.w = 0.3f * light;
        ImGui::TableSetBgColor(ImGuiTableBgTarget_RowBg1, ImGui::GetColorU32(glow));
      }
      ImGui::PushID(i);
      ImGui::TableNextColumn();
      end_of(frame, inspection, "from", row.from, row.event_out->name, light);
      ImGui::TableNextColumn();
      end_of(frame, inspection, "to", row.to, row.event_in->name, light);
      ImGui::TableNextColumn();
      if (const EventWatch::Seen* const seen = inspection.events().find(row.from, *row.event_out)) {
        char rate[32];
        std::snprintf(rate, sizeof rate, "%.0f", seen->a_second);
        colored_text(seen->a_second > 0 ? UiColors::kText : UiColors::kQuiet, rate);
        frame.tooltips.show(std::to_string(seen->count) + " events since opened");
      }
      ImGui::PopID();
    }
  ImGui::EndTable();
}

}  // namespace gs::app
