#include "app/interface/panels/transfer_panel.h"

#include "app/interface/base/text_field.h"
#include "app/view/values/color_bar.h"
#include "app/view/values/color_maps.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <utility>

namespace gs::app {

/// Screen rectangle of the transfer function's curve: values to the right, opacity upwards.
struct TransferCanvas {
  ImVec2 lower, upper;  // screen coordinates
  [[nodiscard]] ImVec2 at(float value, float opacity) const {
    return {lower.x + value * (upper.x - lower.x), upper.y - opacity * (upper.y - lower.y)};
  }
  [[nodiscard]] float value(float x) const { return (x - lower.x) / (upper.x - lower.x); }
  [[nodiscard]] float opacity(float y) const { return (upper.y - y) / (upper.y - lower.y); }
};

namespace {

constexpr float kLabelWidth = 76, kCurveHeight = 132, kRampHeight = 9, kPickerWidth = 210,
                kReadingWidth = 112;  // at scale 1
constexpr const char *kWholeRange = "Whole", *kContrastRange = "2 - 98 %";
constexpr float kPointRadius = 5, kGrip = 10;
constexpr ImGuiSliderFlags kSliderFlags = ImGuiSliderFlags_NoInput | ImGuiSliderFlags_NoRoundToFormat;

struct ColorByRow {
  render::ColorBy by;
  const char* label;
  const char* help;
};
constexpr std::array<ColorByRow, 5> kColorBy{{
    {render::ColorBy::own, "Own", "Colours of the vectors, the material or the transfer function"},
    {render::ColorBy::normal, "Normal", "Direction: x, y and z as red, green and blue"},
    {render::ColorBy::level, "Level", "Level of detail: coarse is blue, fine is red"},
    {render::ColorBy::chunk, "Chunk", "One colour for each chunk of the stream"},
    {render::ColorBy::age, "Age", "Order of arrival: first is blue, last is red"},
}};

ImU32 color32(const qnv::Rgb8& c, float alpha) {
  return IM_COL32(c.r, c.g, c.b, static_cast<int>(std::clamp(alpha, 0.0f, 1.0f) * 255));
}

std::string number(const char* format, double value) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, format, value);
  return buffer;
}

float width_left() { return ImGui::GetContentRegionAvail().x; }

/// Begins a row of controls with a label.
void label(const char* what, float scale) {
  ImGui::AlignTextToFramePadding();
  colored_text(UiColors::kQuiet, what);
  ImGui::SameLine(kLabelWidth * scale);
}

std::uint8_t byte(float c) { return static_cast<std::uint8_t>(std::lround(std::clamp(c, 0.0f, 1.0f) * 255)); }

float value_in(const std::pair<float, float>& values, float place) {
  return values.first + place * (values.second - values.first);
}

/// Draws the logarithms of the counts of all values. Without these, draws the magnitudes of the vectors by value.
void draw_histogram(ImDrawList& draw, const TransferCanvas& canvas, const VolumeSummary& summary,
                    const VolumeHistogram* histogram) {
  const std::array<float, 256>& bars = histogram ? histogram->log_counts() : summary.classes;
  const auto count = static_cast<float>(bars.size());
  for (std::size_t i = 0; i < bars.size(); ++i) {
    const float height = histogram ? bars[i] : std::sqrt(bars[i]);  // the square root makes small sums visible
    if (!(height > 0)) continue;
    const auto left = static_cast<float>(i);
    draw.AddRectFilled(canvas.at(left / count, height), canvas.at((left + 1) / count, 0), IM_COL32(255, 255, 255, 56));
  }
}

void draw_curve(ImDrawList& draw, const TransferCanvas& canvas, const Transfer& transfer, float scale) {
  const float step = std::max(1.0f, std::floor(scale));
  for (float x = canvas.lower.x; x < canvas.upper.x; x += step) {
    const qnv::TransferPoint at = transfer_at(transfer, canvas.value(x + 0.5f * step));
    const ImVec2 top = canvas.at(at.value, at.opacity);
    draw.AddRectFilled({x, top.y}, {std::min(x + step, canvas.upper.x), canvas.upper.y}, color32(at.color, 0.45f));
  }
  std::vector<ImVec2> line{canvas.at(0, transfer.front().opacity)};
  for (const qnv::TransferPoint& point : transfer) line.push_back(canvas.at(point.value, point.opacity));
  line.push_back(canvas.at(1, transfer.back().opacity));
  draw.AddPolyline(line.data(), static_cast<int>(line.size()), IM_COL32(235, 238, 242, 220), 0, 1.5f * scale);
}

void draw_points(ImDrawList& draw, const TransferCanvas& canvas, const Transfer& transfer,
                 std::optional<std::size_t> chosen, float scale) {
  for (std::size_t i = 0; i < transfer.size(); ++i) {
    const ImVec2 place = canvas.at(transfer[i].value, transfer[i].opacity);
    const float radius = kPointRadius * scale;
    draw.AddCircleFilled(place, radius + 1.5f * scale,
                         chosen == i ? ImGui::GetColorU32(UiColors::kAccent) : IM_COL32(20, 22, 25, 255));
    draw.AddCircleFilled(place, radius, color32(transfer[i].color, 1));
    draw.AddCircle(place, radius, IM_COL32(255, 255, 255, 230), 0, 1.2f * scale);
  }
}

/// Draws the colours of a transfer function as a bar, without its opacity.
void draw_ramp(ImDrawList& draw, const ImVec2& from, const ImVec2& to, const Transfer& transfer) {
  const float width = to.x - from.x;
  for (float x = from.x; x < to.x; x += 2)
    draw.AddRectFilled({x, from.y}, {std::min(x + 2, to.x), to.y},
                       color32(transfer_at(transfer, (x - from.x) / width).color, 1));
}

/// Draws the numbers below the axis of values.
void draw_axis(ImDrawList& draw, const ImVec2& from, float width, const std::pair<float, float>& values, float scale) {
  const auto most = static_cast<std::size_t>(std::max(2.0f, width / (5 * ImGui::GetFontSize())));
  const ImU32 color = ImGui::GetColorU32(UiColors::kQuiet);
  for (const Tick& tick : nice_ticks({values.first, values.second}, most)) {
    const float x = from.x + width * static_cast<float>(tick.place), label = ImGui::CalcTextSize(tick.label.c_str()).x;
    draw.AddLine({x, from.y}, {x, from.y + 4 * scale}, color, std::max(1.0f, scale));
    const float left = std::clamp(x - label / 2, from.x - 6 * scale, from.x + width - label + 6 * scale);
    draw.AddText({left, from.y + 4 * scale}, color, tick.label.c_str());
  }
}

std::optional<std::size_t> point_under(const TransferCanvas& canvas, const Transfer& transfer, const ImVec2& pointer,
                                       float scale) {
  std::optional<std::size_t> nearest;
  float least = kGrip * kGrip * scale * scale;
  for (std::size_t i = 0; i < transfer.size(); ++i) {
    const ImVec2 place = canvas.at(transfer[i].value, transfer[i].opacity);
    const float x = place.x - pointer.x, y = place.y - pointer.y, away2 = x * x + y * y;
    if (away2 <= least) {
      least = away2;
      nearest = i;
    }
  }
  return nearest;
}

}  // namespace

void TransferPanel::summarize_volumes(const std::vector<std::shared_ptr<const qnv::Volume>>& volumes) {
  const bool same = std::equal(volumes.begin(), volumes.end(), summarized_.begin(), summarized_.end(),
                               [](const auto& now, const auto& before) { return now == before.lock(); });
  if (same) return;
  summary_ = summarize(volumes);
  summarized_.assign(volumes.begin(), volumes.end());
  point_.reset();
}

bool TransferPanel::edit_curve(const TransferCanvas& canvas, Transfer& transfer) {
  const ImVec2 pointer = ImGui::GetIO().MousePos;
  bool changed = false;
  if (ImGui::IsItemHovered() && ImGui::IsMouseClicked(ImGuiMouseButton_Right)) {
    const auto under = point_under(canvas, transfer, pointer, frame_->scale);
    if (under && remove_point(transfer, *under)) {
      point_.reset();
      changed = true;
    }
  }
  if (ImGui::IsItemActivated() && ImGui::IsMouseDown(ImGuiMouseButton_Left)) {
    point_ = point_under(canvas, transfer, pointer, frame_->scale);
    if (!point_) {
      point_ = add_point(transfer, canvas.value(pointer.x), canvas.opacity(pointer.y));
      changed = point_.has_value();
    }
    dragging_ = point_.has_value();
    if (point_) {
      const ImVec2 place = canvas.at(transfer[*point_].value, transfer[*point_].opacity);
      grabbed_ = {place.x - pointer.x, place.y - pointer.y};
    }
  }
  if (!ImGui::IsItemActive()) dragging_ = false;
  if (dragging_ && point_ && *point_ < transfer.size()) {
    const qnv::TransferPoint before = transfer[*point_];
    move_point(transfer, *point_, canvas.value(pointer.x + grabbed_.x), canvas.opacity(pointer.y + grabbed_.y));
    // Undo a change that comes only from rounding.
    if (std::abs(before.value - transfer[*point_].value) < 1e-5f &&
        std::abs(before.opacity - transfer[*point_].opacity) < 1e-5f)
      transfer[*point_] = before;
    else
      changed = true;
  }
  return changed;
}

bool TransferPanel::slider(const char* id, float& place, const std::string& reading, const char* help) {
  ImGui::SetNextItemWidth(width_left() - kReadingWidth * frame_->scale);
  const bool moved = ImGui::SliderFloat(id, &place, 0, 1, "", kSliderFlags);
  frame_->tooltips.show(help);
  ImGui::SameLine();
  text(reading);
  return moved;
}

void TransferPanel::log_slider(const char* id, float& value, const LogScale& scale, const std::string& reading,
                               const char* help) {
  float place = scale.place_of(value);
  if (slider(id, place, reading, help)) value = scale.value_at(place);
}

void TransferPanel::color_by_row(render::SplatStyle& look) {
  label("Colour", frame_->scale);
  const render::ColorBy chosen = look.color_by;
  for (const ColorByRow& row : kColorBy) {
    if (row.by != kColorBy.front().by) ImGui::SameLine(0, 1);
    if (switch_button(row.label, chosen == row.by)) look.color_by = row.by;
    frame_->tooltips.show(row.help);
  }
}

void TransferPanel::preset_row(Transfer& transfer, bool& own, const Range& values) {
  label("Transfer", frame_->scale);
  const char* shown = own ? "Own" : "Edited";
  for (const TransferPreset& preset : transfer_presets())
    if (!own && transfer == preset.make(values)) shown = preset.label;
  const ImGuiStyle& style = ImGui::GetStyle();
  const float buttons = ImGui::CalcTextSize(kWholeRange).x + ImGui::CalcTextSize(kContrastRange).x +
                        4 * style.FramePadding.x + 2 * style.ItemSpacing.x;
  ImGui::SetNextItemWidth(std::max(40.0f, width_left() - buttons));
  if (!ImGui::BeginCombo("##presets", shown)) {
    frame_->tooltips.show(
        "Maps values to colour and opacity. Click the curve to add a point, drag to move it, right-click or press Del "
        "to remove it. Opacity also rises with the gradient magnitude, up to the median.");
    return;
  }
  keep_popup();
  if (ImGui::Selectable("Own", own)) {
    own = true;
    point_.reset();
  }
  frame_->tooltips.show("Transfer function of the file, or one that fits its values");
  for (const TransferPreset& preset : transfer_presets()) {
    if (ImGui::Selectable(preset.label, preset.label == shown)) {
      transfer = preset.make(values);
      own = false;
      point_.reset();
    }
    frame_->tooltips.show(preset.help);
  }
  ImGui::Separator();
  for (const ColorMap& map : color_maps()) {
    if (ImGui::Selectable((std::string(map.label) + " colours").c_str(), false)) {
      transfer = recolored(transfer, map);
      own = false;
      point_.reset();
    }
    frame_->tooltips.show(std::string(map.help) + "; keeps the opacities");
  }
  ImGui::EndCombo();
}

bool TransferPanel::curve(Transfer& transfer, const Range& values, const VolumeHistogram* histogram) {
  const float scale = frame_->scale, edge = (kPointRadius + 3) * scale;
  const ImVec2 from = ImGui::GetCursorScreenPos();
  const ImVec2 size(width_left(), kCurveHeight * scale), to(from.x + size.x, from.y + size.y);
  ImGui::InvisibleButton("##curve", size);
  const bool pointed_at = ImGui::IsItemHovered() || ImGui::IsItemActive();
  const TransferCanvas canvas{{from.x + edge, from.y + edge}, {to.x - edge, to.y - edge}};
  const bool changed = edit_curve(canvas, transfer);
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  draw.AddRectFilled(from, to, IM_COL32(14, 15, 18, 255), 4 * scale);
  draw_histogram(draw, canvas, summary_, histogram);
  draw_curve(draw, canvas, transfer, scale);
  draw_points(draw, canvas, transfer, point_, scale);
  if (pointed_at) {
    const float pointer = ImGui::GetIO().MousePos.x, value = std::clamp(canvas.value(pointer), 0.0f, 1.0f);
    const std::string here = number("%.4g", static_cast<double>(value_in(values, value))) + "   " +
                             number("%.2f", static_cast<double>(transfer_at(transfer, value).opacity));
    const ImVec2 extent = ImGui::CalcTextSize(here.c_str());
    const ImVec2 corner(pointer > (from.x + to.x) / 2 ? from.x + 2 * edge : to.x - 2 * edge - extent.x, from.y + edge);
    draw.AddRectFilled({corner.x - 4 * scale, corner.y - 2 * scale},
                       {corner.x + extent.x + 4 * scale, corner.y + extent.y + 2 * scale}, IM_COL32(14, 15, 18, 225),
                       3 * scale);
    draw.AddText(corner, ImGui::GetColorU32(UiColors::kOnPicture), here.c_str());
  }
  const ImVec2 ramp = ImGui::GetCursorScreenPos();
  draw_ramp(draw, {canvas.lower.x, ramp.y}, {canvas.upper.x, ramp.y + kRampHeight * scale}, transfer);
  ImGui::Dummy({size.x, kRampHeight * scale});
  draw_axis(draw, {canvas.lower.x, ramp.y + kRampHeight * scale}, canvas.upper.x - canvas.lower.x, values, scale);
  ImGui::Dummy({size.x, ImGui::GetTextLineHeight() + 2 * scale});
  return changed;
}

bool TransferPanel::color_button(std::array<float, 3>& color) {
  const ImVec4 shown(color[0], color[1], color[2], 1);
  if (ImGui::ColorButton("##color", shown, ImGuiColorEditFlags_NoTooltip)) ImGui::OpenPopup("##picker");
  frame_->tooltips.show("Colour of the point");
  if (!ImGui::BeginPopup("##picker")) return false;
  ImGui::SetNextItemWidth(kPickerWidth * frame_->scale);
  const bool changed = ImGui::ColorPicker3("##picked", color.data(),
                                           ImGuiColorEditFlags_NoSidePreview | ImGuiColorEditFlags_NoSmallPreview |
                                               ImGuiColorEditFlags_DisplayRGB | ImGuiColorEditFlags_NoLabel);
  keep_popup();
  ImGui::EndPopup();
  return changed;
}

void TransferPanel::keep_popup() {
  popup_ = true;
  if (std::exchange(close_popup_, false)) ImGui::CloseCurrentPopup();
}

bool TransferPanel::close_one() {
  close_popup_ = popup_;
  return popup_;
}

bool TransferPanel::point_fields(qnv::TransferPoint& point, const Range& values, float width) {
  const float range = values.second - values.first;
  float value = value_in(values, point.value);
  ImGui::SetNextItemWidth(width);
  bool moved = ImGui::DragFloat("##value", &value, range * 0.002f, 0, 0, "%.4g", ImGuiSliderFlags_NoRoundToFormat);
  frame_->tooltips.show("Value of the volume");
  if (moved && range > 0) point.value = (value - values.first) / range;
  ImGui::SameLine();
  ImGui::SetNextItemWidth(width);
  moved |= ImGui::DragFloat("##opacity", &point.opacity, 0.002f, 0, 1, "%.3f", ImGuiSliderFlags_AlwaysClamp);
  frame_->tooltips.show("Opacity at this value");
  return moved;
}

bool TransferPanel::point_row(Transfer& transfer, const Range& values) {
  if (!point_ || *point_ >= transfer.size()) {
    point_.reset();
    ImGui::AlignTextToFramePadding();
    colored_text(UiColors::kQuiet, "Click to add a point, right-click to remove it");
    return false;
  }
  const std::size_t index = *point_;
  qnv::TransferPoint point = transfer[index];
  label("Point", frame_->scale);
  std::array<float, 3> color{static_cast<float>(point.color.r) / 255, static_cast<float>(point.color.g) / 255,
                             static_cast<float>(point.color.b) / 255};
  const bool colored = color_button(color);
  if (colored) transfer[index].color = {byte(color[0]), byte(color[1]), byte(color[2])};
  ImGui::SameLine();
  const ImGuiStyle& style = ImGui::GetStyle();
  const float button = ImGui::CalcTextSize("Remove").x + 2 * style.FramePadding.x;
  const bool moved = point_fields(point, values, (width_left() - button - 2 * style.ItemSpacing.x) / 2);
  if (moved) move_point(transfer, index, point.value, point.opacity);
  ImGui::SameLine();
  ImGui::BeginDisabled(transfer.size() == 1);
  const bool key = ImGui::IsWindowFocused(ImGuiFocusedFlags_RootAndChildWindows) && !ImGui::GetIO().WantTextInput &&
                   (ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Delete)) ||
                    ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Backspace)));
  const bool removed = (ImGui::Button("Remove") || key) && remove_point(transfer, index);
  ImGui::EndDisabled();
  frame_->tooltips.show("Remove the point (Del or right-click)");
  if (removed) point_.reset();
  return colored || moved || removed;
}

void TransferPanel::transfer_rows(const UiModel& model, render::SplatStyle& look) {
  const qnv::Description& volume = model.volumes.front()->description;
  bool own = look.transfer.empty();
  Transfer transfer = own ? own_transfer(volume) : sound_transfer(look.transfer);
  preset_row(transfer, own, volume.value_range);
  if (own) transfer = own_transfer(volume);
  bool changed = range_buttons(transfer, volume.value_range, model.tools.histogram.get());
  changed |= curve(transfer, volume.value_range, model.tools.histogram.get());
  changed |= point_row(transfer, volume.value_range);
  look.transfer = own && !changed ? Transfer() : transfer;
}

bool TransferPanel::range_buttons(Transfer& transfer, const Range& values, const VolumeHistogram* histogram) {
  std::optional<Range> fitted;
  const float width = values.second - values.first;
  ImGui::BeginDisabled(transfer.size() < 2 || !(width > 0));
  ImGui::SameLine();
  if (ImGui::Button(kWholeRange)) fitted = {0, 1};
  frame_->tooltips.show("Stretches the transfer function over all values");
  ImGui::SameLine();
  ImGui::BeginDisabled(!histogram);
  if (ImGui::Button(kContrastRange) && histogram) {
    const auto [low, high] = contrast_range(*histogram);
    fitted = {(low - values.first) / width, (high - values.first) / width};
  }
  frame_->tooltips.show("Stretches the transfer function from the lowest 2 % to the highest 2 % of the values");
  ImGui::EndDisabled();
  ImGui::EndDisabled();
  return fitted && stretch(transfer, fitted->first, fitted->second);
}

void TransferPanel::clip_rows(const UiModel& model, render::SplatStyle& look) {
  static constexpr std::array<const char*, 4> kAxes{"X", "Y", "Z", "View"};
  // The axis "view" may give the same plane as x, y or z. If the plane still fits the last choice, show that choice.
  const bool remembered = !look.clip || *look.clip == clip_plane(clip_, model.bounds);
  ClipChoice clip = remembered ? clip_ : clip_choice(*look.clip, model.bounds);
  bool on = look.clip.has_value();
  label("Clip", frame_->scale);
  bool changed = ImGui::Checkbox("##clip", &on);
  frame_->tooltips.show("Clipping plane");
  ImGui::BeginDisabled(!on);
  for (std::size_t i = 0; i < kAxes.size(); ++i) {
    const auto axis = static_cast<ClipAxis>(i);
    ImGui::SameLine(0, i == 0 ? ImGui::GetStyle().ItemSpacing.x : 1);
    if (switch_button(kAxes[i], on && clip.axis == axis)) {
      clip.axis = axis;
      if (axis == ClipAxis::view) clip.view = model.looking;
      changed = true;
    }
    frame_->tooltips.show(axis == ClipAxis::view ? "Perpendicular to the view direction; click again to update it"
                                                 : "Perpendicular to this axis");
  }
  ImGui::SameLine();
  if (ImGui::Button("Flip")) {
    clip = flipped(clip);
    changed = true;
  }
  frame_->tooltips.show("Keep the other side");
  label("", frame_->scale);
  changed |= slider("##place", clip.place, number("%.0f %%", static_cast<double>(clip.place) * 100),
                    "Position of the plane in the scene; 0 keeps everything");
  ImGui::EndDisabled();
  if (!changed) return;
  clip_ = clip;
  look.clip = on ? std::optional(clip_plane(clip, model.bounds)) : std::nullopt;
}

void TransferPanel::volume_rows(const UiModel& model, render::SplatStyle& look) {
  summarize_volumes(model.volumes);
  transfer_rows(model, look);
  ImGui::Separator();
  label("Opacity", frame_->scale);
  log_slider("##density", look.opacity, opacity_scale(), number("%.3g", static_cast<double>(look.opacity)),
             "Multiplies the optical depth of the volume");
  const double share = static_cast<double>(share_left(summary_, look.least_magnitude)) * 100;
  label("Gradient", frame_->scale);
  log_slider("##threshold", look.least_magnitude, magnitude_scale(summary_),
             look.least_magnitude > 0
                 ? number("%.1f %%", share) + number(" (> %.3g)", static_cast<double>(look.least_magnitude))
                 : "all",
             "Hides vectors with a shorter gradient and shows the percentage that remains. The opacity of the others "
             "rises with the gradient magnitude, up to the median.");
  clip_rows(model, look);
}

void TransferPanel::file_row(const UiModel& model, UiActions& actions) {
  if (path_.empty()) path_ = model.tools.folder + "/transfer.json";
  label("File", frame_->scale);
  // The path has its own line, so that its end is visible.
  (void)text_field("##path", "", path_, std::max(40.0f, width_left()), false);
  frame_->tooltips.show("Transfer function as JSON, also for --transfer");
  label("", frame_->scale);
  if (ImGui::Button("Save")) actions.tools.save_transfer = path_;
  ImGui::SameLine();
  if (ImGui::Button("Load")) actions.tools.load_transfer = path_;
}

void TransferPanel::draw(const PanelFrame& frame, const UiModel& model, UiActions& actions) {
  frame_ = &frame;
  popup_ = false;
  render::SplatStyle look = model.look;
  if (!model.has_surface_vectors && !model.has_volumes) {
    ImGui::PushTextWrapPos(0);
    colored_text(UiColors::kQuiet,
                 "This world has no volume and no vectors. This panel edits their colours and opacity.");
    ImGui::PopTextWrapPos();
  } else {
    color_by_row(look);
    if (!model.volumes.empty()) {
      ImGui::Separator();
      actions.tools.wants_histogram = true;
      volume_rows(model, look);
      file_row(model, actions);
      ImGui::Separator();
      ImGui::BeginDisabled(look == render::SplatStyle{});
      if (ImGui::Button("Reset")) look = {};
      ImGui::EndDisabled();
      frame.tooltips.show("Reset all");
    }
  }
  if (look != model.look) actions.look = std::move(look);
  close_popup_ = false;
  frame_ = nullptr;
}

}  // namespace gs::app
