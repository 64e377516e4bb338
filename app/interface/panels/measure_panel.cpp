#include "app/interface/panels/measure_panel.h"

#include "app/view/values/color_maps.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>

namespace gs::app {
namespace {

constexpr float kToolLabel = 84;  // width of the labels at scale 1

void tool_label(const char* what, float scale) {
  ImGui::AlignTextToFramePadding();
  colored_text(UiColors::kQuiet, what);
  ImGui::SameLine(kToolLabel * scale);
}

/// Escapes a text for a format of printf.
std::string escaped_format(const std::string& text) {
  std::string escaped;
  for (const char c : text) escaped.append(c == '%' ? 2 : 1, c);
  return escaped;
}

float tool_width() { return ImGui::GetContentRegionAvail().x; }

}  // namespace

void MeasurePanel::ruler_rows(const PanelFrame& frame, const UiTools& tools, UiToolActions& actions) {
  tool_label("Ruler", frame.scale);
  if (switch_button("Measure", tools.measuring)) actions.measure = !tools.measuring;
  frame.tooltips.show("Click the world to set points; Esc ends measuring and removes them (R)");
  ImGui::SameLine();
  ImGui::BeginDisabled(tools.points.empty());
  if (ImGui::Button("Undo")) actions.undo_point = true;
  ImGui::SameLine();
  if (ImGui::Button("Clear")) actions.forget_points = true;
  ImGui::SameLine();
  if (ImGui::Button("Copy")) ImGui::SetClipboardText(tools.measured_text.c_str());
  ImGui::EndDisabled();
  frame.tooltips.show("Copies points, lengths, angles and the area as text");
  if (!tools.measuring && tools.points.empty()) return;
  ImGui::PushTextWrapPos(0);
  text(tools.measured);
  ImGui::PopTextWrapPos();
}

void MeasurePanel::slice_rows(const PanelFrame& frame, const UiTools& tools, UiToolActions& actions) {
  static constexpr std::array<const char*, 3> kAxes{"X", "Y", "Z"};
  VolumeSlices slices = tools.slices;
  if (!tools.has_file) {
    colored_text(UiColors::kQuiet, "Slices need a volume file or a stream of values.");
    return;
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    ImGui::PushID(static_cast<int>(axis));
    tool_label(axis == 0 ? "Slices" : "", frame.scale);
    if (switch_button(kAxes[axis], slices.shown[axis])) slices.shown[axis] = !slices.shown[axis];
    frame.tooltips.show("Plane of voxels perpendicular to this axis; drag its edge in the picture to move it");
    ImGui::SameLine();
    const std::uint32_t voxels = tools.dimensions[axis];
    ImGui::BeginDisabled(!slices.shown[axis] || voxels == 0);
    int voxel = static_cast<int>(std::lround(static_cast<double>(slices.places[axis]) * std::max(1.0, voxels - 1.0)));
    ImGui::SetNextItemWidth(tool_width());
    if (ImGui::SliderInt("##voxel", &voxel, 0, std::max(1, static_cast<int>(voxels) - 1)))
      slices.places[axis] =
          std::clamp(static_cast<float>(voxel) / std::max(1.0f, static_cast<float>(voxels) - 1), 0.0f, 1.0f);
    ImGui::EndDisabled();
    ImGui::PopID();
  }
  if (tools.reading) colored_text(UiColors::kQuiet, "Reading values...");
  if (!tools.slices_problem.empty()) colored_text(UiColors::kError, shortened(tools.slices_problem, 300));
  const bool colored = slices.any() || tools.volume.mode != VolumeMode::vectors;
  ImGui::BeginDisabled(!slices.any() && !tools.volume.surface);
  tool_label("", frame.scale);
  ImGui::Checkbox("Hide the volume", &slices.alone);
  ImGui::EndDisabled();
  ImGui::BeginDisabled(!colored);
  tool_label("Colours", frame.scale);
  ImGui::SetNextItemWidth(tool_width());
  const ColorMap* chosen = find_color_map(slices.map);
  if (ImGui::BeginCombo("##map", chosen ? std::string(chosen->label).c_str() : "")) {
    for (const ColorMap& map : color_maps()) {
      if (ImGui::Selectable(std::string(map.label).c_str(), &map == chosen)) slices.map = map.name;
      frame.tooltips.show(map.help);
    }
    ImGui::EndCombo();
  }
  if (tools.bar) {
    const auto whole =
        std::pair{static_cast<float>(tools.bar->range.first), static_cast<float>(tools.bar->range.second)};
    std::array<float, 2> window{slices.window.value_or(whole).first, slices.window.value_or(whole).second};
    tool_label("Window", frame.scale);
    ImGui::SetNextItemWidth(tool_width());
    const float speed = std::max(1e-6f, std::abs(window[1] - window[0]) / 300);
    if (ImGui::DragFloat2("##window", window.data(), speed, 0, 0, "%.4g") && window[0] < window[1])
      slices.window = {window[0], window[1]};
    frame.tooltips.show("Values of the first and last colour; drag, or double-click to type");
    window_buttons(frame, tools, slices);
  }
  ImGui::EndDisabled();
  volume_rows(frame, tools, slices, actions);
  if (!(slices == tools.slices)) actions.slices = std::move(slices);
}

void MeasurePanel::window_buttons(const PanelFrame& frame, const UiTools& tools, VolumeSlices& slices) {
  tool_label("", frame.scale);
  if (ImGui::Button("Whole")) slices.window.reset();
  frame.tooltips.show("Stretches the colours over all values");
  ImGui::SameLine();
  ImGui::BeginDisabled(!tools.histogram);
  if (ImGui::Button("2 - 98 %") && tools.histogram) slices.window = contrast_range(*tools.histogram);
  frame.tooltips.show("Stretches the colours from the lowest 2 % to the highest 2 % of the values");
  ImGui::EndDisabled();
  if (!tools.bar) return;
  const auto presets = window_presets(
      {static_cast<float>(tools.bar->range.first), static_cast<float>(tools.bar->range.second)}, tools.unit);
  if (presets.empty()) return;
  tool_label("", frame.scale);
  for (std::size_t i = 0; i < presets.size(); ++i) {
    if (i > 0) ImGui::SameLine();
    if (ImGui::Button(presets[i].label)) slices.window = presets[i].window;
    frame.tooltips.show(presets[i].help);
  }
}

void MeasurePanel::volume_rows(const PanelFrame& frame, const UiTools& tools, VolumeSlices& slices,
                               UiToolActions& actions) {
  VolumeDisplay volume = tools.volume;
  tool_label("Volume", frame.scale);
  ImGui::SetNextItemWidth(tool_width());
  if (ImGui::BeginCombo("##mode", volume_modes()[static_cast<std::size_t>(volume.mode)].label.data())) {
    for (const VolumeModeRow& row : volume_modes()) {
      if (ImGui::Selectable(row.label.data(), row.mode == volume.mode)) {
        volume.mode = row.mode;
        slices.alone = false;
      }
      frame.tooltips.show(row.help);
    }
    ImGui::EndCombo();
  }
  tool_label("Share", frame.scale);
  ImGui::SetNextItemWidth(tool_width());
  ImGui::BeginDisabled(volume.mode != VolumeMode::vectors);
  float percent = 100 * volume.share;
  if (ImGui::SliderFloat("##share", &percent, 100 * kLeastShare, 100 * kMostShare, "%.1f %% of the voxels",
                         ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_AlwaysClamp)) {
    volume.share = std::clamp(std::round(10 * percent) / 1000, kLeastShare, kMostShare);
    if (std::abs(volume.share - kUsualShare) < 5e-4f) volume.share = kUsualShare;
  }
  frame.tooltips.show("Voxels that are drawn as vectors: those with the largest gradients");
  ImGui::EndDisabled();
  tool_label("Surface", frame.scale);
  bool surface = volume.surface;
  if (ImGui::Checkbox("##surface", &surface)) {
    volume.surface = surface;
    // A surface in a cloud of vectors would not be visible.
    if (volume.mode == VolumeMode::vectors && (surface || !slices.any())) slices.alone = surface;
  }
  frame.tooltips.show("Surface at one value (isosurface)");
  ImGui::BeginDisabled(!surface);
  ImGui::SameLine();
  ImGui::ColorEdit3("##color", &volume.surface_color.x, ImGuiColorEditFlags_NoInputs | ImGuiColorEditFlags_NoLabel);
  frame.tooltips.show("Colour of the surface");
  if (tools.histogram) {
    const auto [least, most] = tools.histogram->range();
    float value = tools.isovalue.value_or(least);
    const std::string format = "%.4g" + (tools.unit.empty() ? "" : " " + escaped_format(tools.unit));
    ImGui::SameLine();
    ImGui::SetNextItemWidth(tool_width());
    if (ImGui::SliderFloat("##isovalue", &value, least, most, format.c_str())) volume.isovalue = value;
    frame.tooltips.show("Value of the surface; Ctrl+click to type");
  }
  ImGui::EndDisabled();
  if (!(volume == tools.volume)) actions.volume = volume;
}

void MeasurePanel::step_rows(const PanelFrame& frame, const UiTools& tools, UiToolActions& actions) {
  const auto last = static_cast<std::uint32_t>(tools.times.size() - 1);
  const std::uint32_t shown = std::min(tools.volume.step.value_or(0), last);
  VolumeDisplay volume = actions.volume.value_or(tools.volume);
  std::optional<std::uint32_t> wished;
  tool_label("Time", frame.scale);
  if (ImGui::Button(tools.steps_playing ? "Pause##steps" : "Play##steps")) actions.play_steps = !tools.steps_playing;
  frame.tooltips.show("Shows one step of the time series after the other");
  ImGui::SameLine();
  if (ImGui::Button("<##step")) wished = shown > 0 ? shown - 1 : last;
  ImGui::SameLine(0, 1);
  if (ImGui::Button(">##step")) wished = shown < last ? shown + 1 : 0;
  ImGui::SameLine();
  int step = static_cast<int>(shown);
  ImGui::SetNextItemWidth(tool_width());
  const std::string reading = "%d, time " + readable_value(tools.times[shown]);
  if (ImGui::SliderInt("##step", &step, 0, static_cast<int>(last), reading.c_str(), ImGuiSliderFlags_AlwaysClamp))
    wished = static_cast<std::uint32_t>(std::max(0, step));
  frame.tooltips.show("Number of the step, and its time");
  tool_label("", frame.scale);
  auto rate = static_cast<float>(tools.step_rate);
  ImGui::SetNextItemWidth(tool_width());
  if (ImGui::SliderFloat("##steprate", &rate, 0.5f, 60, "%.3g steps per second", ImGuiSliderFlags_Logarithmic))
    actions.step_rate = static_cast<double>(rate);
  if (!wished) return;
  volume.step = wished;
  actions.volume = volume;
}

void MeasurePanel::series_rows(const PanelFrame& frame, const UiTools& tools, UiToolActions& actions) {
  tool_label(tools.file_time ? "Time" : "Series", frame.scale);
  if (ImGui::Button(tools.playing ? "Pause" : "Play")) actions.play = !tools.playing;
  ImGui::SameLine();
  if (ImGui::Button("<")) actions.file = tools.file > 0 ? tools.file - 1 : tools.files - 1;
  ImGui::SameLine(0, 1);
  if (ImGui::Button(">")) actions.file = (tools.file + 1) % tools.files;
  ImGui::SameLine();
  int file = static_cast<int>(tools.file) + 1;
  ImGui::SetNextItemWidth(tool_width());
  char format[48] = "%d";
  if (tools.file_time) std::snprintf(format, sizeof format, "%%d: t = %.6g", *tools.file_time);
  if (ImGui::SliderInt("##file", &file, 1, static_cast<int>(tools.files), format))
    actions.file = static_cast<std::size_t>(std::max(0, file - 1));
  tool_label("", frame.scale);
  auto rate = static_cast<float>(tools.rate);
  ImGui::SetNextItemWidth(tool_width());
  if (ImGui::SliderFloat("##rate", &rate, 0.5f, 60, tools.file_time ? "%.3g steps per second" : "%.3g files per second",
                         ImGuiSliderFlags_Logarithmic))
    actions.rate = static_cast<double>(rate);
}

void MeasurePanel::draw(const PanelFrame& frame, const UiModel& model, UiActions& all) {
  const UiTools& tools = model.tools;
  UiToolActions& actions = all.tools;
  actions.wants_value = true;
  actions.wants_histogram = true;
  tool_label("Pointer", frame.scale);
  ImGui::PushTextWrapPos(0);
  text(tools.value.empty() ? "Nothing under the pointer" : tools.value);
  ImGui::PopTextWrapPos();
  ruler_rows(frame, tools, actions);
  if (tools.files > 1) {
    ImGui::Separator();
    series_rows(frame, tools, actions);
  }
  if (!tools.bar) return;
  ImGui::Separator();
  tool_label("Colour bar", frame.scale);
  bool bar = tools.color_bar;
  if (ImGui::Checkbox("##bar", &bar)) actions.color_bar = bar;
  frame.tooltips.show("Shows the values of the colours beside the picture");
  if (model.has_volumes) slice_rows(frame, tools, actions);
  if (tools.times.size() > 1) {
    ImGui::Separator();
    step_rows(frame, tools, actions);
  }
}

void PicturePanel::draw(const PanelFrame& frame, const UiModel& model, UiActions& all) {
  const UiTools& tools = model.tools;
  PictureWish wish = tools.picture;
  tool_label("Size", frame.scale);
  if (ImGui::RadioButton("Viewport", wish.of_window)) wish.of_window = true;
  ImGui::SameLine();
  if (ImGui::RadioButton("Pixels", !wish.of_window)) wish.of_window = false;
  tool_label("", frame.scale);
  ImGui::SetNextItemWidth(tool_width());
  if (wish.of_window) {
    ImGui::SliderInt("##scale", &wish.scale, 1, 8, wish.scale == 1 ? "True size" : "%d times larger");
  } else {
    ImGui::InputInt2("##size", &wish.size.x);
    wish.size.x = std::clamp(wish.size.x, 1, kMaxPictureSide);
    wish.size.y = std::clamp(wish.size.y, 1, kMaxPictureSide);
  }
  tool_label("Print", frame.scale);
  auto dots = static_cast<float>(wish.request.dots_per_inch);
  ImGui::SetNextItemWidth(tool_width());
  if (ImGui::DragFloat("##dots", &dots, 1, 0, 2400, dots > 0 ? "%.0f dots per inch" : "no print size"))
    wish.request.dots_per_inch = std::max(0.0, static_cast<double>(dots));
  tool_label("", frame.scale);
  ImGui::Checkbox("Transparent background", &wish.request.transparent);
  tool_label("", frame.scale);
  ImGui::BeginDisabled(!tools.bar);
  ImGui::Checkbox("Colour bar", &wish.request.color_bar);
  ImGui::EndDisabled();
  static constexpr std::array<const char*, 3> kEyes{"Off", "Side by side", "Red and cyan"};
  tool_label("Stereo", frame.scale);
  auto eyes = static_cast<int>(wish.request.stereo);
  ImGui::SetNextItemWidth(tool_width());
  if (ImGui::Combo("##stereo", &eyes, kEyes.data(), static_cast<int>(kEyes.size())))
    wish.request.stereo = static_cast<render::Stereo>(eyes);
  ImGui::Separator();
  ImGui::BeginDisabled(!model.has_world || tools.exporting.has_value());
  if (ImGui::Button("Save picture")) all.tools.take_picture = true;
  frame.tooltips.show("F12");
  ImGui::Separator();
  tool_label("Turntable", frame.scale);
  auto seconds = static_cast<float>(wish.seconds);
  ImGui::SetNextItemWidth(tool_width());
  if (ImGui::SliderFloat("##seconds", &seconds, 1, 60, "%.3g s")) wish.seconds = static_cast<double>(seconds);
  tool_label("", frame.scale);
  static constexpr std::array<const char*, 3> kFiles{"PNG pictures", "Movie (MP4)", "Movie (WebM)"};
  auto file = static_cast<int>(wish.animation);
  ImGui::SetNextItemWidth(tool_width());
  if (ImGui::Combo("##animation", &file, kFiles.data(), static_cast<int>(kFiles.size())))
    wish.animation = static_cast<AnimationFile>(file);
  if (ImGui::Button("Save turntable")) all.tools.take_turntable = true;
  ImGui::Separator();
  tool_label("Tour", frame.scale);
  auto leg = static_cast<float>(wish.leg);
  ImGui::SetNextItemWidth(tool_width());
  if (ImGui::SliderFloat("##leg", &leg, 0.5f, 20, "%.3g s per view")) wish.leg = static_cast<double>(leg);
  tool_label("", frame.scale);
  if (ImGui::Button("Add view")) all.tools.add_to_tour = true;
  ImGui::SameLine();
  ImGui::BeginDisabled(tools.tour == 0);
  if (ImGui::Button("Remove last")) all.tools.forget_tour_view = true;
  ImGui::EndDisabled();
  ImGui::BeginDisabled(tools.tour < 2);
  if (ImGui::Button(("Save tour of " + std::to_string(tools.tour) + " views###tour").c_str()))
    all.tools.take_tour = true;
  ImGui::EndDisabled();
  ImGui::EndDisabled();
  if (tools.exporting) {
    // Draw the percentage beside the bar, because text on the bar would be hard to read.
    ImGui::ProgressBar(*tools.exporting, {tool_width() - 130 * frame.scale, 0}, "");
    ImGui::SameLine();
    char share[16];
    std::snprintf(share, sizeof share, "%.0f %%", 100 * static_cast<double>(*tools.exporting));
    ImGui::TextUnformatted(share);
    ImGui::SameLine();
    if (ImGui::Button("Cancel")) all.tools.cancel_export = true;
  }
  ImGui::PushTextWrapPos(0);
  colored_text(UiColors::kQuiet, "Folder: " + shortened(tools.folder, 200));
  ImGui::PopTextWrapPos();
  all.tools.picture = std::move(wish);
}

}  // namespace gs::app
