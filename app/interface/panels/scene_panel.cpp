#include "app/interface/base/text_field.h"
#include "app/interface/panels/inspect_panels.h"

#include <imgui.h>

#include <algorithm>
#include <limits>

namespace gs::app {
namespace {

constexpr std::size_t kName = 80;  // max bytes of a visible name

int as_count(std::size_t count) {
  return static_cast<int>(std::min<std::size_t>(count, std::numeric_limits<int>::max() - 1));
}

}  // namespace

void ScenePanel::draw(const PanelFrame& frame, const UiModel& model, UiActions& actions) {
  Inspection* const shown = drawn_inspection(model, &InspectionWants::tree);
  if (!shown) return;
  Inspection& inspection = *shown;
  search_row(frame, inspection, actions);
  metadata(inspection);
  rows(frame, inspection);
}

// Shows the META statements of an X3D world below a heading, which is collapsed at first.
void ScenePanel::metadata(const Inspection& inspection) {
  constexpr std::size_t kMaxShown = 100;
  if (!inspection.world()) return;
  const vrml::SceneGraph& root = inspection.world()->scenes().root();
  const std::vector<vrml::X3DStatements::Meta>& metas = root.x3d().metas;
  if (metas.empty() || !ImGui::TreeNodeEx("Metadata", ImGuiTreeNodeFlags_NoTreePushOnOpen)) return;
  for (std::size_t i = 0; i < std::min(metas.size(), kMaxShown); ++i) {
    colored_text(UiColors::kQuiet, shortened(metas[i].name, kName));
    ImGui::SameLine();
    text(shortened(metas[i].content, 4 * kName));
  }
  if (metas.size() > kMaxShown) colored_text(UiColors::kQuiet, "...");
}

void ScenePanel::search_row(const PanelFrame& frame, Inspection& inspection, UiActions& actions) {
  const SceneIndex& index = inspection.index();
  const float buttons = 3 * ImGui::GetFrameHeight() + ImGui::CalcTextSize("Pick").x + 30 * frame.scale;
  const float width = std::max(60 * frame.scale, ImGui::GetContentRegionAvail().x - buttons);
  const bool entered = text_field("##find", "DEF name or type", sought_, width, false).entered;
  frame.tooltips.show("Finds nodes by part of a DEF name or type. Enter: next match");
  if (sought_ != index.sought() && lower_case(sought_) != index.sought()) inspection.find(sought_);
  if (entered) {
    inspection.find_next(false);
    ImGui::SetKeyboardFocusHere(-1);
  }
  ImGui::SameLine(0, 4 * frame.scale);
  ImGui::BeginDisabled(index.matches() == 0);
  if (ImGui::ArrowButton("##before", ImGuiDir_Up)) inspection.find_next(true);
  frame.tooltips.show("Previous match");
  ImGui::SameLine(0, 4 * frame.scale);
  if (ImGui::ArrowButton("##next", ImGuiDir_Down)) inspection.find_next(false);
  frame.tooltips.show("Next match");
  ImGui::EndDisabled();
  ImGui::SameLine(0, 4 * frame.scale);
  if (switch_button("Pick", inspection.picking())) actions.run = Action::pick;
  frame.tooltips.show(tooltip_of(Action::pick));
  if (index.sought().empty()) return;
  const bool known = index.complete() && index.searched();
  std::string found = std::to_string(index.matches()) + (index.matches() == SceneIndex::kMaxMatches ? " or more" : "");
  if (inspection.match()) found = std::to_string(*inspection.match() + 1) + " of " + found;
  colored_text(index.matches() == 0 && known ? UiColors::kWarning : UiColors::kQuiet,
               index.matches() == 0 ? (known ? "No matches" : "Searching...") : found + (known ? "" : " so far"));
}

void ScenePanel::rows(const PanelFrame& frame, Inspection& inspection) {
  SceneOutline& outline = inspection.outline();
  const std::optional<std::size_t> revealed = inspection.take_revealed();
  if (revealed) line_ = revealed;
  ImGui::BeginChild("##rows", {0, 0}, false, ImGuiWindowFlags_HorizontalScrollbar);
  if (revealed) {
    const float height = ImGui::GetTextLineHeightWithSpacing();
    ImGui::SetScrollY(std::max(0.0f, static_cast<float>(*revealed) * height - ImGui::GetWindowHeight() / 2));
  }
  if (outline.size() == 0) colored_text(UiColors::kQuiet, "The world has no nodes.");
  std::optional<std::size_t> toggled;
  ImGuiListClipper clipper;
  clipper.Begin(as_count(outline.size()), ImGui::GetTextLineHeightWithSpacing());
  while (clipper.Step())
    for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i)
      if (line(frame, inspection, static_cast<std::size_t>(i))) toggled = static_cast<std::size_t>(i);
  if (toggled) outline.set_open(*toggled, !outline.row(*toggled).open);
  if (ImGui::IsWindowFocused()) {
    inspection.drawn().arrows = true;
    keys(inspection);
  }
  ImGui::EndChild();
}

// Draws one line of the tree. Returns true if the user expanded or collapsed it.
bool ScenePanel::line(const PanelFrame& frame, Inspection& inspection, std::size_t index) {
  const OutlineRow row = inspection.outline().row(index);
  ImGui::PushID(static_cast<int>(index));
  const float indent = static_cast<float>(row.depth) * 14 * frame.scale;
  if (indent > 0) ImGui::Indent(indent);
  const bool chosen = row.node && row.node == inspection.selected();
  ImGuiTreeNodeFlags flags = ImGuiTreeNodeFlags_OpenOnArrow | ImGuiTreeNodeFlags_SpanAvailWidth |
                             ImGuiTreeNodeFlags_NoTreePushOnOpen | ImGuiTreeNodeFlags_AllowItemOverlap;
  if (!row.can_open) flags |= ImGuiTreeNodeFlags_Leaf;
  if (chosen) flags |= ImGuiTreeNodeFlags_Selected;
  const float left = ImGui::GetCursorPosX();
  ImGui::SetNextItemOpen(row.open);
  ImGui::TreeNodeEx("##line", flags);
  const bool toggled = ImGui::IsItemToggledOpen();
  if (ImGui::IsItemClicked() && !toggled) {
    inspection.select(row.node, false);
    line_ = index;
  }
  if (chosen && ImGui::IsItemHovered() && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left))
    (void)inspection.fly_to_selected();
  const bool hovered = ImGui::IsItemHovered();
  ImGui::SameLine(left + ImGui::GetTreeNodeToLabelSpacing(), 0);
  if (!row.field.empty()) {
    colored_text(UiColors::kQuiet,
                 shortened(row.field, kName) + (row.element ? "[" + std::to_string(*row.element) + "]" : "") + " ");
    ImGui::SameLine(0, 0);
  }
  if (!row.node) {
    colored_text(UiColors::kQuiet, "NULL");
  } else {
    const vrml::Node& node = row.node.scene->node(row.node.id);
    if (row.use) {
      colored_text(UiColors::kWarning, "USE ");
      ImGui::SameLine(0, 0);
    }
    text(shortened(node.type->name, kName));
    if (!node.name.empty()) {
      ImGui::SameLine(0, 0);
      colored_text(UiColors::kAccent, "  " + shortened(node.name, kName));
    } else if (const std::string content = row.use ? std::string() : content_name(row.node); !content.empty()) {
      ImGui::SameLine(0, 0);
      colored_text(UiColors::kQuiet, "  " + shortened(content, kName));
    }
    if (hovered && node.type->kind == vrml::NodeType::Kind::prototype) frame.tooltips.show("PROTO instance");
  }
  if (indent > 0) ImGui::Unindent(indent);
  ImGui::PopID();
  return toggled;
}

// Handles the arrow keys: Up and Down move between lines, Left and Right collapse and expand.
void ScenePanel::keys(Inspection& inspection) {
  SceneOutline& outline = inspection.outline();
  if (!line_ || *line_ >= outline.size()) return;
  const auto pressed = [](ImGuiKey key) { return ImGui::IsKeyPressed(ImGui::GetKeyIndex(key)); };
  const OutlineRow row = outline.row(*line_);
  std::optional<std::size_t> to;
  if (pressed(ImGuiKey_DownArrow) && *line_ + 1 < outline.size()) to = *line_ + 1;
  if (pressed(ImGuiKey_UpArrow) && *line_ > 0) to = *line_ - 1;
  if (pressed(ImGuiKey_RightArrow)) {
    if (row.can_open && !row.open)
      outline.set_open(*line_, true);
    else if (row.open)
      to = *line_ + 1;
  }
  if (pressed(ImGuiKey_LeftArrow)) {
    if (row.open)
      outline.set_open(*line_, false);
    else
      to = outline.holder(*line_);
  }
  if (!to) return;
  line_ = to;
  inspection.select(outline.row(*to).node, false);
  const float height = ImGui::GetTextLineHeightWithSpacing(), place = static_cast<float>(*to) * height;
  if (place < ImGui::GetScrollY()) ImGui::SetScrollY(place);
  if (place + height > ImGui::GetScrollY() + ImGui::GetWindowHeight())
    ImGui::SetScrollY(place + height - ImGui::GetWindowHeight());
}

void draw_marks(const Inspection& inspection) {
  const ImVec2 scale = ImGui::GetIO().DisplayFramebufferScale;
  const float x = 1 / std::max(scale.x, 0.01f), y = 1 / std::max(scale.y, 0.01f);
  ImDrawList& draw = *ImGui::GetBackgroundDrawList();
  const ImU32 color = ImGui::GetColorU32(UiColors::kAccent), shade = IM_COL32(0, 0, 0, 110);
  for (const SelectionMark::Outline& mark : inspection.mark().outlines()) {
    const auto left = static_cast<float>(mark.viewport.left) * x, top = static_cast<float>(mark.viewport.top) * y;
    draw.PushClipRect({left, top}, {left + static_cast<float>(mark.viewport.width) * x,
                                    top + static_cast<float>(mark.viewport.height) * y});
    for (const auto& [ink, width] : {std::pair(shade, 3.0f), std::pair(color, 1.5f)})
      for (const auto& [a, b] : mark.lines) draw.AddLine({a.x * x, a.y * y}, {b.x * x, b.y * y}, ink, width);
    draw.PopClipRect();
  }
}

}  // namespace gs::app
