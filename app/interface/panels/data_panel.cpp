#include "app/interface/panels/data_panel.h"

#include "app/interface/base/text_field.h"
#include "app/view/values/color_bar.h"
#include "app/view/values/color_maps.h"
#include "base/text.h"
#include "net/serve/served_folder.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace gs::app {
namespace {

constexpr float kDataLabel = 88;  // at scale 1
constexpr std::size_t kLongName = 60;

float data_width() { return ImGui::GetContentRegionAvail().x; }

void data_label(const char* what, float scale) {
  ImGui::AlignTextToFramePadding();
  colored_text(UiColors::kQuiet, what);
  ImGui::SameLine(kDataLabel * scale);
}

std::string data_folder(std::string_view path) {
  const std::size_t slash = path.rfind('/');
  return slash == std::string_view::npos || slash == 0 ? std::string() : std::string(path.substr(1, slash - 1));
}

std::string data_name(std::string_view path) { return std::string(path.substr(path.rfind('/') + 1)); }

/// Returns the short names of a dataset's shape, type and unit.
std::string data_facts(const DatasetEntry& entry) {
  std::string facts = shape_text(entry.shape) + ", " + shortened(entry.type, 30);
  if (!entry.unit.empty()) facts += ", " + shortened(entry.unit, 20);
  return facts;
}

/// Escapes a text for use in a printf format.
std::string percent_free(std::string text) {
  std::erase(text, '%');
  return text;
}

bool is_listed(const DatasetEntry& entry, bool all, const std::string& filter) {
  if (!all && (entry.form == DatasetForm::nothing || entry.is_minor)) return false;
  return filter.empty() || lower_case(entry.path).find(lower_case(filter)) != std::string::npos;
}

}  // namespace

void DataPanel::keep_popup() {
  popup_ = true;
  if (std::exchange(close_popup_, false)) ImGui::CloseCurrentPopup();
}

bool DataPanel::close_one() {
  close_popup_ = popup_;
  return popup_;
}

void DataPanel::entry_row(const DatasetEntry& entry, const UiData& data, UiDataActions& actions) {
  const bool shown = entry.path == data.list->shown, can_show = entry.form != DatasetForm::nothing;
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::PushID(entry.path.c_str());
  ImGui::Indent(10 * frame_->scale);
  ImGui::BeginDisabled(!can_show);
  if (ImGui::Selectable("##entry", shown,
                        ImGuiSelectableFlags_SpanAllColumns | ImGuiSelectableFlags_AllowItemOverlap) &&
      !shown)
    actions.choose = with_dataset(data.choice, entry.path);
  ImGui::EndDisabled();
  std::string help = entry.path + "\n" + data_facts(entry);
  if (!entry.axes.empty()) help += "\nAxes: " + shortened(entry.axes, 120);
  if (!entry.note.empty()) help += "\n" + shortened(entry.note, 200);
  if (can_show) help += "\nRight-click to add it beside or over the picture";
  frame_->tooltips.show(help);
  if (can_show && ImGui::BeginPopupContextItem("##add")) {
    keep_popup();
    if (ImGui::Selectable("Show")) actions.choose = with_dataset(data.choice, entry.path);
    if (ImGui::Selectable("Add beside")) actions.beside = with_dataset(data.choice, entry.path);
    if (ImGui::Selectable("Add over")) actions.over = with_dataset(data.choice, entry.path);
    ImGui::EndPopup();
  }
  ImGui::SameLine(0, 0);
  const ImVec4& color = can_show ? UiColors::kText : UiColors::kQuiet;
  colored_text(shown ? UiColors::kAccent : color, shortened(data_name(entry.path), kLongName));
  ImGui::Unindent(10 * frame_->scale);
  ImGui::TableNextColumn();
  colored_text(UiColors::kQuiet, shape_text(entry.shape));
  ImGui::TableNextColumn();
  colored_text(UiColors::kQuiet, shortened(entry.type, 30));
  ImGui::TableNextColumn();
  colored_text(UiColors::kQuiet, shortened(entry.unit, 20));
  ImGui::PopID();
}

void DataPanel::tree(const UiData& data, UiDataActions& actions) {
  const auto& entries = data.list->entries;
  const bool has_minor =
      std::ranges::any_of(entries, [](const DatasetEntry& entry) { return !is_listed(entry, false, {}); });
  constexpr std::size_t kMany = 8;
  if (entries.size() > kMany) {
    (void)text_field("##filter", "Filter", filter_, data_width() - (has_minor ? 110 * frame_->scale : 0), false);
    if (has_minor) ImGui::SameLine();
  }
  if (has_minor) {
    ImGui::Checkbox("All arrays", &all_);
    frame_->tooltips.show("Also lists coordinates and other arrays that describe datasets");
  }
  std::vector<const DatasetEntry*> rows;
  for (const DatasetEntry& entry : entries)
    if (is_listed(entry, all_, filter_)) rows.push_back(&entry);
  constexpr std::size_t kMostRows = 12;
  const float row = ImGui::GetTextLineHeightWithSpacing();
  std::size_t lines = 1;
  for (std::size_t i = 0; i < rows.size(); ++i)
    lines += 1 + (i == 0 || data_folder(rows[i]->path) != data_folder(rows[i - 1]->path) ? 1 : 0);
  const float height = row * (static_cast<float>(std::min(lines, kMostRows)) + 0.6f);
  constexpr ImGuiTableFlags kFlags =
      ImGuiTableFlags_ScrollY | ImGuiTableFlags_RowBg | ImGuiTableFlags_Resizable | ImGuiTableFlags_SizingFixedFit;
  if (!ImGui::BeginTable("##datasets", 4, kFlags, {0, height})) return;
  ImGui::TableSetupScrollFreeze(0, 1);
  ImGui::TableSetupColumn("Dataset", ImGuiTableColumnFlags_WidthStretch, 3);
  for (const char* const title : {"Shape", "Type", "Unit"}) ImGui::TableSetupColumn(title);
  ImGui::TableHeadersRow();
  std::string folder;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::string in = data_folder(rows[i]->path);
    if (!in.empty() && (i == 0 || in != folder)) {
      ImGui::TableNextRow();
      ImGui::TableNextColumn();
      colored_text(UiColors::kQuiet, shortened(in, kLongName));
    }
    folder = in;
    entry_row(*rows[i], data, actions);
  }
  ImGui::EndTable();
  if (rows.empty()) colored_text(UiColors::kQuiet, "No matches");
}

void DataPanel::step_rows(const UiData& data, VoxelComponent& choice, UiDataActions& actions) {
  const auto& times = data.list->times;
  if (times.size() < 2) return;
  const auto last = static_cast<int>(times.size()) - 1;
  const int shown = choice.step ? static_cast<int>(qnv::step_number(*choice.step, times)) : 0;
  std::optional<int> wished;
  data_label("Time", frame_->scale);
  if (ImGui::Button("<##data")) wished = shown > 0 ? shown - 1 : last;
  frame_->tooltips.show("Previous step");
  ImGui::SameLine(0, 1);
  if (ImGui::Button(">##data")) wished = shown < last ? shown + 1 : 0;
  frame_->tooltips.show("Next step");
  ImGui::SameLine();
  ImGui::SetNextItemWidth(data_width());
  int step = step_.value_or(shown);
  const std::string reading = "%d, time " + readable_value(times[static_cast<std::size_t>(std::clamp(step, 0, last))]);
  if (ImGui::SliderInt("##datastep", &step, 0, last, reading.c_str(), ImGuiSliderFlags_AlwaysClamp)) step_ = step;
  frame_->tooltips.show("Number of the step, and its time (--time)");
  if (ImGui::IsItemDeactivatedAfterEdit() && step_) wished = std::exchange(step_, std::nullopt);
  if (data.followed) {
    data_label("", frame_->scale);
    bool newest = data.newest;
    if (ImGui::Checkbox("Newest step", &newest)) actions.newest = newest;
    frame_->tooltips.show("Shows each new step as soon as it is written");
  }
  if (!wished) return;
  choice.step = qnv::ShownStep{static_cast<std::uint32_t>(*wished), {}};
  actions.newest = false;
}

void DataPanel::component_rows(const UiData& data, VoxelComponent& choice) {
  const DatasetList& list = *data.list;
  if (list.channels > 1) {
    data_label("Channel", frame_->scale);
    int channel = static_cast<int>(choice.channel.value_or(0));
    ImGui::SetNextItemWidth(data_width());
    if (ImGui::InputInt("##channel", &channel, 1, 10, ImGuiInputTextFlags_EnterReturnsTrue))
      choice.channel = static_cast<std::uint64_t>(std::clamp<std::int64_t>(
          channel, 0, static_cast<std::int64_t>(std::min<std::uint64_t>(list.channels, 1u << 30)) - 1));
    frame_->tooltips.show("Index from 0 to " + std::to_string(list.channels - 1) + " (--channel)");
  }
  if (list.components < 2) return;
  constexpr std::uint64_t kMostComponents = 256;
  const std::uint64_t count = std::min(list.components, kMostComponents);
  const auto entry = std::ranges::find(list.entries, list.shown, &DatasetEntry::path);
  const bool is_surface = entry != list.entries.end() && entry->form == DatasetForm::mesh;
  if (is_surface || !data.is_mesh || choice.flow != FlowForm::values) {
    static constexpr std::pair<FlowForm, const char*> kForms[] = {
        {FlowForm::values, "Values"}, {FlowForm::arrows, "Arrows"}, {FlowForm::streamlines, "Streamlines"}};
    data_label("Vectors", frame_->scale);
    for (const auto& [form, name] : kForms) {
      if (form == FlowForm::streamlines && is_surface) continue;
      if (form != FlowForm::values) ImGui::SameLine(0, 1);
      if (switch_button(name, choice.flow == form)) choice.flow = form;
      frame_->tooltips.show(form == FlowForm::streamlines ? "Draws lines along the vectors, coloured by length"
                            : form == FlowForm::arrows    ? "Draws evenly thinned arrows, coloured by length"
                            : is_surface                  ? "Colours the surface by one component or the magnitude"
                                                          : "Draws one component or the magnitude as a volume");
    }
    if (choice.flow != FlowForm::values) return;
  }
  data_label("Component", frame_->scale);
  const auto name = [&](std::uint64_t i) {
    return std::to_string(i) + (i < list.component_names.size() ? ": " + shortened(list.component_names[i], 30) : "");
  };
  const std::string shown = choice.magnitude ? "Magnitude" : choice.chosen ? name(choice.index) : "Default";
  ImGui::SetNextItemWidth(data_width());
  if (!ImGui::BeginCombo("##component", shown.c_str()))
    return frame_->tooltips.show("Number of each element (--component)");
  keep_popup();
  const auto choose = [&](std::uint32_t index, bool chosen, bool magnitude) {
    choice.index = index;
    choice.chosen = chosen;
    choice.magnitude = magnitude;
  };
  if (ImGui::Selectable("Default", !choice.chosen)) choose(0, false, false);
  if (ImGui::Selectable("Magnitude", choice.magnitude)) choose(0, true, true);
  for (std::uint64_t i = 0; i < count; ++i)
    if (ImGui::Selectable(name(i).c_str(), choice.chosen && !choice.magnitude && choice.index == i))
      choose(static_cast<std::uint32_t>(i), true, false);
  ImGui::EndCombo();
}

void DataPanel::color_rows(const UiData& data, VoxelComponent& choice) {
  if (!data.is_mesh) return;
  using Range = SurfaceColors::Range;
  SurfaceColors& colors = choice.colors;
  ImGui::Separator();
  data_label("Range", frame_->scale);
  static constexpr std::pair<Range, const char*> kRanges[] = {
      {Range::whole, "Whole"}, {Range::contrast, "2 - 98 %"}, {Range::typed, "Typed"}};
  const auto [low, high] = data.range;
  for (const auto& [range, name] : kRanges) {
    if (range != Range::whole) ImGui::SameLine(0, 1);
    if (switch_button(name, colors.range == range)) {
      colors.range = range;
      if (range == Range::typed) colors.low = low, colors.high = high;
    }
    frame_->tooltips.show(range == Range::whole      ? "All values"
                          : range == Range::contrast ? "Excludes the lowest and highest 2 % of the values"
                                                     : "Uses the two values below");
  }
  if (colors.range == Range::typed) {
    const std::array<double, 2> now{colors.low, colors.high};
    if (now != range_of_) range_ = range_of_ = now;
    data_label("", frame_->scale);
    const float width = (data_width() - ImGui::GetStyle().ItemSpacing.x) / 2;
    bool entered = false;
    for (std::size_t i = 0; i < 2; ++i) {
      if (i > 0) ImGui::SameLine();
      ImGui::SetNextItemWidth(width);
      ImGui::InputDouble(i == 0 ? "##low" : "##high", &range_[i], 0, 0, "%.6g");
      entered = ImGui::IsItemDeactivatedAfterEdit() || entered;
      frame_->tooltips.show(i == 0 ? "Value of the first colour" : "Value of the last colour");
    }
    if (entered && range_[0] < range_[1]) colors.low = range_[0], colors.high = range_[1];
  }
  data_label("Colours", frame_->scale);
  const char* shown = colors.map.empty() ? "Viridis" : "Own";
  for (const ColorMap& map : color_maps())
    if (palette_of(map) == colors.map) shown = map.label.data();
  ImGui::SetNextItemWidth(data_width());
  if (!ImGui::BeginCombo("##map", shown)) return;
  keep_popup();
  for (const ColorMap& map : color_maps()) {
    if (ImGui::Selectable(map.label.data(), map.label == shown)) colors.map = palette_of(map);
    frame_->tooltips.show(map.help);
  }
  ImGui::EndCombo();
}

void DataPanel::bar_row(const UiModel& model, UiToolActions& actions) {
  if (!model.tools.bar) return;
  data_label("Colour bar", frame_->scale);
  bool bar = model.tools.color_bar;
  if (ImGui::Checkbox("##bar", &bar)) actions.color_bar = bar;
  frame_->tooltips.show("Shows the values of the colours beside the picture");
}

void DataPanel::live_rows(const UiData& data, UiDataActions& actions) {
  if (!data.live || (data.live->parameters.empty() && data.live->fields.size() < 2)) return;
  if (live_url_ != data.live->url) {
    live_url_ = data.live->url;
    live_name_.clear();
    live_token_.clear();
  }
  ImGui::Separator();
  colored_text(UiColors::kQuiet, "Simulation");
  if (data.live->fields.size() > 1) {
    data_label("Field", frame_->scale);
    ImGui::SetNextItemWidth(data_width());
    if (ImGui::BeginCombo("##livefield", data.live->field.c_str())) {
      keep_popup();
      for (const std::string& field : data.live->fields)
        if (ImGui::Selectable(label_of(shortened(field, kLongName), field).c_str(), field == data.live->field))
          actions.live = "field=" + net::encode_name(field);
      ImGui::EndCombo();
    }
    frame_->tooltips.show("Field that the simulation sends");
  }
  for (const LiveParameter& one : data.live->parameters) {
    data_label(shortened(one.label, 20).c_str(), frame_->scale);
    ImGui::SetNextItemWidth(data_width());
    double value = live_name_ == one.name ? live_value_ : one.value;
    const std::string format = (one.integer ? "%.0f" : "%.6g") + (one.unit.empty() ? "" : " " + percent_free(one.unit));
    if (ImGui::SliderScalar(("##live" + one.name).c_str(), ImGuiDataType_Double, &value, &one.minimum, &one.maximum,
                            format.c_str(), ImGuiSliderFlags_AlwaysClamp)) {
      live_name_ = one.name;
      live_value_ = one.integer ? std::round(value) : value;
    }
    frame_->tooltips.show("Parameter " + one.name + " of the simulation, which gets it before its next step");
    if (!ImGui::IsItemDeactivatedAfterEdit() || live_name_ != one.name) continue;
    actions.live = parameter_query(one.name, std::clamp(live_value_, one.minimum, one.maximum));
    live_name_.clear();
  }
  if (!data.live->message.empty()) {
    ImGui::PushTextWrapPos(0);
    colored_text(UiColors::kError, shortened(data.live->message, 300));
    ImGui::PopTextWrapPos();
    data_label("Token", frame_->scale);
    (void)text_field("##livetoken", "Token of the simulation", live_token_, data_width(), false);
    frame_->tooltips.show("Content of the simulation's token file; needed if it runs on another machine");
  }
  if (actions.live && !live_token_.empty()) actions.live_token = live_token_;
}

void DataPanel::add_popup(const char* id, const UiModel& model, UiDataActions& actions, bool over) {
  if (!ImGui::BeginPopup(id)) return;
  keep_popup();
  if (model.data.list)
    for (const DatasetEntry& entry : model.data.list->entries) {
      if (!is_listed(entry, false, {})) continue;
      if (!ImGui::Selectable(label_of(shortened(entry.path, kLongName), entry.path).c_str())) continue;
      (over ? actions.over : actions.beside) = with_dataset(model.data.choice, entry.path);
    }
  bool first = true;
  for (std::size_t i = 0; i < model.files.size(); ++i) {
    if (model.file == i) continue;
    if (std::exchange(first, false)) {
      ImGui::Separator();
      colored_text(UiColors::kQuiet, "Open files");
    }
    if (!ImGui::Selectable(label_of(shortened(model.files[i], kLongName), "file" + std::to_string(i)).c_str()))
      continue;
    (over ? actions.file_over : actions.file_beside) = i;
  }
  if (first && (!model.data.list || model.data.list->entries.empty()))
    colored_text(UiColors::kQuiet, "Open another file first");
  ImGui::EndPopup();
}

void DataPanel::other_rows(const UiModel& model, UiDataActions& actions) {
  const UiData& data = model.data;
  ImGui::Separator();
  data_label("Add", frame_->scale);
  if (ImGui::Button("Beside")) ImGui::OpenPopup("##beside");
  frame_->tooltips.show("Opens a dataset or file in another viewport, with the same camera");
  add_popup("##beside", model, actions, false);
  ImGui::SameLine();
  if (ImGui::Button("Over")) ImGui::OpenPopup("##over");
  frame_->tooltips.show("Draws a dataset or file in the same space as the picture");
  add_popup("##over", model, actions, true);
  for (std::size_t i = 0; i < data.over.size(); ++i) {
    ImGui::PushID(static_cast<int>(i));
    data_label(i == 0 ? "Over it" : "", frame_->scale);
    if (ImGui::SmallButton("Remove")) actions.remove_over = i;
    ImGui::SameLine();
    text(shortened(data.over[i], kLongName));
    ImGui::PopID();
  }
  if (!data.can_follow) return;
  data_label("Follow", frame_->scale);
  bool followed = data.followed;
  if (ImGui::Checkbox("##follow", &followed)) actions.follow = followed;
  frame_->tooltips.show("Reads the file again when a program writes to it (--follow)");
}

void DataPanel::draw(const PanelFrame& frame, const UiModel& model, UiActions& all) {
  const UiData& data = model.data;
  frame_ = &frame;
  popup_ = false;
  if (!data.list) {
    colored_text(UiColors::kQuiet, "Open a file to see its datasets.");
  } else {
    VoxelComponent choice = data.choice;
    if (!data.list->entries.empty()) tree(data, all.data);
    // One line in both states, so that no row moves under the pointer when reading ends.
    const std::size_t number = data.list->entries.size();
    if (data.loading)
      colored_text(UiColors::kAccent, "Reading ...");
    else if (number == 0)
      colored_text(UiColors::kQuiet, "This file has one dataset.");
    else
      colored_text(UiColors::kQuiet, std::to_string(number) + (number == 1 ? " dataset" : " datasets"));
    step_rows(data, choice, all.data);
    component_rows(data, choice);
    color_rows(data, choice);
    bar_row(model, all.tools);
    live_rows(data, all.data);
    if (!(choice == data.choice) && !all.data.choose) all.data.choose = choice;
    other_rows(model, all.data);
  }
  close_popup_ = false;
  frame_ = nullptr;
}

}  // namespace gs::app
