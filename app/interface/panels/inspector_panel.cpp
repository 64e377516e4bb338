#include "app/inspect/field_edits.h"
#include "app/inspect/field_values.h"
#include "app/interface/base/text_field.h"
#include "app/interface/panels/inspect_panels.h"

#include <imgui.h>

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <utility>
#include <variant>
#include <vector>

namespace gs::app {
namespace {

constexpr std::size_t kPage = 50;  // visible elements of an expanded list
constexpr float kDegrees = static_cast<float>(180 / std::numbers::pi);

std::string ago_text(double seconds) {
  if (seconds < 0.05) return "now";
  char text[48];
  if (seconds < 60)
    std::snprintf(text, sizeof text, "%.1f s ago", seconds);
  else
    std::snprintf(text, sizeof text, "%.0f min ago", seconds / 60);
  return text;
}

}  // namespace

/// Everything that is needed to draw a value and to send a new one.
struct InspectorPanel::Field {
  const PanelFrame& frame;
  Inspection& inspection;
  const vrml::NodeType& type;
  const vrml::InterfaceDeclaration& interface;
  const vrml::InterfaceDeclaration* setter;  // eventIn that sets the field; null if it is read-only
  const vrml::FieldValue* value;             // null if the value is unknown
  Unit unit;
};

Inspection* drawn_inspection(const UiModel& model, bool InspectionWants::*part) {
  if (!model.inspection) return nullptr;
  model.inspection->drawn().*part = true;
  if (model.inspection->world()) return model.inspection;
  if (!model.has_world) colored_text(UiColors::kQuiet, "No world is open.");
  return nullptr;
}

void InspectorPanel::draw(const PanelFrame& frame, const UiModel& model, UiActions& actions) {
  Inspection* const shown = drawn_inspection(model, &InspectionWants::inspector);
  if (!shown) return;
  Inspection& inspection = *shown;
  if (!ImGui::IsAnyItemActive()) inspection.editor().end_gesture();
  if (!(node_ == inspection.selected())) {
    node_ = inspection.selected();
    open_.clear();
    problem_of_ = nullptr;
  }
  if (!node_) {
    ImGui::PushTextWrapPos(0);
    colored_text(UiColors::kQuiet, "Select a node in the scene tree, or Alt+click it in the picture.");
    ImGui::PopTextWrapPos();
    return;
  }
  head(frame, inspection);
  ImGui::Separator();
  if (!ImGui::BeginTable("##fields", 2, ImGuiTableFlags_Resizable | ImGuiTableFlags_RowBg | ImGuiTableFlags_ScrollY))
    return;
  ImGui::TableSetupColumn("field", ImGuiTableColumnFlags_WidthFixed, ImGui::GetFontSize() * 8.5f);
  ImGui::TableSetupColumn("value", ImGuiTableColumnFlags_WidthStretch);
  for (const vrml::InterfaceDeclaration& one : node_.scene->node(node_.id).type->interfaces)
    row(frame, inspection, one, actions);
  ImGui::EndTable();
}

bool InspectorPanel::close_one() { return std::exchange(problem_of_, nullptr) != nullptr; }

void InspectorPanel::head(const PanelFrame& frame, Inspection& inspection) {
  const vrml::Node& node = node_.scene->node(node_.id);
  text(shortened(node.type->name, 80));
  if (!node.name.empty()) {
    ImGui::SameLine();
    colored_text(UiColors::kAccent, shortened(node.name, 80));
  }
  if (node.location.line > 0) {
    const std::string& file = node.text->file_name();
    colored_text(UiColors::kQuiet, shortened(file.substr(file.rfind('/') + 1), 60) + ":" +
                                       std::to_string(node.location.line) + ":" + std::to_string(node.location.column));
  }
  const WideBox& bounds = inspection.mark().bounds();
  ImGui::BeginDisabled(bounds.empty());
  if (ImGui::SmallButton("Fly to")) (void)inspection.fly_to_selected();
  ImGui::EndDisabled();
  frame.tooltips.show("Frames the node");
  ImGui::SameLine();
  if (ImGui::SmallButton("Deselect")) inspection.select({}, false);
  frame.tooltips.show("Clears the selection");
  if (bounds.empty()) return;
  char size[96];
  std::snprintf(size, sizeof size, "%.3g x %.3g x %.3g m", static_cast<double>(bounds.size().x),
                static_cast<double>(bounds.size().y), static_cast<double>(bounds.size().z));
  ImGui::SameLine();
  colored_text(UiColors::kQuiet, size);
}

void InspectorPanel::row(const PanelFrame& frame, Inspection& inspection, const vrml::InterfaceDeclaration& interface,
                         UiActions& actions) {
  const vrml::NodeType& type = *node_.scene->node(node_.id).type;
  const Field field{frame,
                    inspection,
                    type,
                    interface,
                    setter_of(type, interface),
                    inspection.editor().value_of(interface),
                    unit_of(type, interface)};
  // Skip the eventIn set_x of a field x, which is already listed.
  if (interface.access == vrml::AccessType::eventIn && interface.name.starts_with("set_"))
    if (const auto* of = type.find_field(interface.name.substr(4)); of && setter_of(type, *of) == &interface) return;
  ImGui::TableNextRow();
  ImGui::PushID(&interface);
  ImGui::TableNextColumn();
  ImGui::AlignTextToFramePadding();
  colored_text(field.setter ? UiColors::kText : UiColors::kQuiet, shortened(interface.name, 60));
  std::string help = std::string(vrml::name_of(interface.access)) + " " + std::string(vrml::name_of(interface.type)) +
                     " " + shortened(interface.name, 60);
  if (!interface.range.empty()) help += ", " + interface.range;
  help += "\n" + (field.setter ? "Enter sends the value, Esc restores it" : why_not_set(interface));
  frame.tooltips.show(help);
  ImGui::TableNextColumn();
  value(field, actions);
  const bool sends =
      interface.access == vrml::AccessType::eventOut || interface.access == vrml::AccessType::exposedField;
  if (const EventWatch::Seen* const seen = sends ? inspection.events().find(node_, interface) : nullptr) {
    const double ago = inspection.world()->now() - seen->time;
    char rate[64];
    std::snprintf(rate, sizeof rate, ", %.0f per second", seen->a_second);
    colored_text(ago < 0.5 ? UiColors::kAccent : UiColors::kQuiet,
                 "sent " + ago_text(ago) + (seen->a_second >= 0.5 ? rate : ""));
    frame.tooltips.show("Last sent at " + time_text(seen->time) + ", " + std::to_string(seen->count) +
                        " events since opened");
  }
  if (problem_of_ == &interface) {
    ImGui::PushTextWrapPos(0);
    colored_text(UiColors::kError, problem_);
    ImGui::PopTextWrapPos();
  }
  ImGui::PopID();
}

void InspectorPanel::note(const Field& field, const std::optional<std::string>& problem) {
  if (problem) {
    problem_of_ = &field.interface;
    problem_ = shortened(*problem, 300);
  } else if (problem_of_ == &field.interface) {
    problem_of_ = nullptr;
  }
}

// Draws a text field for a value. Returns true if the user confirmed a text with Enter.
bool InspectorPanel::edited_text(const char* id, const vrml::FieldValue& value, std::string& entered) {
  std::optional<std::string> present = editable_text(value, *node_.scene);
  if (!present || present->size() > kLongestTyped) {
    colored_text(UiColors::kQuiet, value_text(value, *node_.scene));
    return false;
  }
  // Keep the typed text, because the value may change in the world during editing.
  const ImGuiID field = ImGui::GetID(id);
  std::string text = typed_in_ == field ? typed_ : std::move(*present);
  const FieldEvents events = text_field(id, "", text, 0, false);
  if (events.entered) entered = text;
  if (events.active) {
    typed_in_ = field;
    typed_ = std::move(text);
  } else if (typed_in_ == field) {
    typed_in_ = 0;
  }
  return events.entered;
}

void InspectorPanel::value(const Field& field, UiActions& actions) {
  using vrml::FieldType;
  const vrml::FieldValue initial = vrml::initial_value(field.interface.type);
  const vrml::FieldValue& value = field.value ? *field.value : initial;
  Inspection& inspection = field.inspection;
  if (vrml::is_multiple(field.interface.type) && field.value) return list(field, actions);
  if (!field.setter) {
    ImGui::PushTextWrapPos(0);
    text(value_text(value, *node_.scene));
    ImGui::PopTextWrapPos();
  } else if (field.interface.access == vrml::AccessType::eventIn && std::holds_alternative<vrml::SFBool>(value)) {
    for (const bool sent : {true, false}) {
      if (ImGui::SmallButton(sent ? "Send TRUE" : "Send FALSE"))
        note(field, inspection.editor().send(*field.setter, sent));
      if (sent) ImGui::SameLine();
    }
  } else if (const auto* flag = std::get_if<vrml::SFBool>(&value)) {
    bool on = *flag;
    if (ImGui::Checkbox("##flag", &on)) note(field, inspection.editor().send(*field.setter, on));
  } else if (const auto* color = std::get_if<vrml::SFColor>(&value)) {
    float parts[3] = {color->r, color->g, color->b};
    ImGui::SetNextItemWidth(-FLT_MIN);
    if (ImGui::ColorEdit3("##color", parts, ImGuiColorEditFlags_Float))
      note(field, inspection.editor().send(
                      *field.setter, vrml::SFColor{std::clamp(parts[0], 0.0f, 1.0f), std::clamp(parts[1], 0.0f, 1.0f),
                                                   std::clamp(parts[2], 0.0f, 1.0f)}));
  } else if (const auto* rotation = std::get_if<vrml::SFRotation>(&value)) {
    float axis[3] = {rotation->x, rotation->y, rotation->z};
    float degrees = rotation->angle * kDegrees;
    ImGui::SetNextItemWidth(-FLT_MIN);
    if (ImGui::InputFloat3("##axis", axis, "%.4g", ImGuiInputTextFlags_EnterReturnsTrue))
      note(field,
           inspection.editor().send(*field.setter, vrml::SFRotation{axis[0], axis[1], axis[2], rotation->angle}));
    field.frame.tooltips.show("Axis of rotation");
    ImGui::SetNextItemWidth(-FLT_MIN);
    if (ImGui::DragFloat("##angle", &degrees, 1, 0, 0, "%.1f deg"))
      note(field, inspection.editor().send(
                      *field.setter, vrml::SFRotation{rotation->x, rotation->y, rotation->z, degrees / kDegrees}));
    char radians[48];
    std::snprintf(radians, sizeof radians, "%.5g rad", static_cast<double>(rotation->angle));
    field.frame.tooltips.show(std::string("Angle: ") + radians + "; drag, or Ctrl+click to type");
    return;
  } else {
    std::string entered;
    if (edited_text("##text", value, entered)) note(field, inspection.editor().send_text(*field.setter, entered));
  }
  if (const auto* node = std::get_if<vrml::SFNode>(&value); node && *node) {
    if (ImGui::SmallButton("Select")) inspection.select({node_.scene, *node}, true);
    return;
  }
  if (const auto* number = std::get_if<vrml::SFFloat>(&value); number && field.unit == Unit::radians)
    colored_text(UiColors::kQuiet, "rad = " + degrees_text(static_cast<double>(*number)));
  else if (const auto* time = std::get_if<vrml::SFTime>(&value)) {
    colored_text(UiColors::kQuiet, is_date(*time) ? "s = " + time_text(*time) : std::string(symbol_of(field.unit)));
    if (!field.setter) return;
    ImGui::SameLine();
    if (ImGui::SmallButton("Now")) note(field, inspection.editor().send(*field.setter, inspection.world()->now()));
    field.frame.tooltips.show("Sends the current time");
  } else if (field.unit != Unit::none)
    colored_text(UiColors::kQuiet, symbol_of(field.unit));
}

// Draws one page of a list value; the other elements take no time.
void InspectorPanel::list(const Field& field, UiActions& actions) {
  const std::size_t count = vrml::element_count(*field.value);
  const auto open =
      std::find_if(open_.begin(), open_.end(), [&](const OpenList& one) { return one.of == &field.interface; });
  const bool was_open = open != open_.end();
  if (ImGui::ArrowButton("##open", was_open ? ImGuiDir_Down : ImGuiDir_Right)) {
    if (was_open)
      open_.erase(open);
    else
      open_.push_back({&field.interface, 0});
    return;
  }
  ImGui::SameLine();
  const std::string unit(symbol_of(field.unit));
  colored_text(UiColors::kQuiet,
               std::to_string(count) + (count == 1 ? " value" : " values") + (unit.empty() ? "" : ", " + unit));
  if (!was_open) {
    if (count > 0) text(value_text(*field.value, *node_.scene));
    std::string entered;
    if (count == 0 && field.setter && edited_text("##whole", *field.value, entered))
      note(field, field.inspection.editor().send_text(*field.setter, entered));
    return;
  }
  if (count > kPage) {
    ImGui::SameLine();
    auto first = static_cast<int>(std::min<std::size_t>(open->first, 2'000'000'000));
    ImGui::SetNextItemWidth(-FLT_MIN);
    if (ImGui::InputInt("##first", &first, static_cast<int>(kPage), 1000))
      open->first = static_cast<std::size_t>(std::max(first, 0));
    field.frame.tooltips.show("Index of the first value below, from 0");
  }
  open->first = std::min(open->first, count > 0 ? count - 1 : 0);
  const std::size_t last = std::min(count, open->first + kPage);
  for (std::size_t i = open->first; i < last; ++i) element(field, i, actions);
}

void InspectorPanel::element(const Field& field, std::size_t index, UiActions& actions) {
  Inspection& inspection = field.inspection;
  const vrml::FieldValue one = element_of(*field.value, index);
  ImGui::PushID(static_cast<int>(index));
  ImGui::AlignTextToFramePadding();
  colored_text(UiColors::kQuiet, std::to_string(index));
  ImGui::SameLine();
  if (const auto* node = std::get_if<vrml::SFNode>(&one)) {
    if (ImGui::SmallButton(label_of({node_.scene, *node}).c_str()) && *node)
      inspection.select({node_.scene, *node}, true);
    ImGui::PopID();
    return;
  }
  const auto urls = field.type.url_fields();
  if (std::find(urls.begin(), urls.end(), &field.interface) != urls.end()) {
    if (ImGui::SmallButton("Open"))
      if (auto target = inspection.editor().target_of_url(field.interface, index)) actions.open = std::move(*target);
    ImGui::SameLine();
  }
  if (!field.setter) {
    text(value_text(one, *node_.scene));
  } else if (const auto* color = std::get_if<vrml::SFColor>(&one)) {
    float parts[3] = {color->r, color->g, color->b};
    ImGui::SetNextItemWidth(-FLT_MIN);
    if (ImGui::ColorEdit3("##color", parts, ImGuiColorEditFlags_Float))
      note(field, inspection.editor().send_element(*field.setter, *field.value, index,
                                                   vrml::SFColor{parts[0], parts[1], parts[2]}));
  } else {
    std::string entered;
    if (edited_text("##text", one, entered))
      note(field, inspection.editor().send_element_text(*field.setter, *field.value, index, entered));
  }
  ImGui::PopID();
}

}  // namespace gs::app
