#include "app/interface/panels/splats_panel.h"

#include "app/view/values/transfer_editor.h"
#include "base/text.h"

#include <imgui.h>
#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <variant>

namespace gs::app {
namespace {

constexpr float kSplatLabel = 76, kSplatReading = 76;  // at scale 1
constexpr float kSmallestShare = 1e-4f;                // left end of the size slider, relative to the largest splat
constexpr double kDragShare = 0.002;                   // distance for a drag of one pixel, relative to the scene
constexpr float kShownStops = 4;

void splat_label(const char* what, float scale) {
  ImGui::AlignTextToFramePadding();
  colored_text(UiColors::kQuiet, what);
  ImGui::SameLine(kSplatLabel * scale);
}

double size_of_scene(const SplatExtent& extent) {
  if (extent.middle.empty()) return 1;
  const glm::dvec3 size = extent.middle.size();
  const double most = std::max({size.x, size.y, size.z});
  return most > 0 ? most : 1;
}

std::string splat_count_text(std::size_t number) {
  std::string text = std::to_string(number);
  for (std::size_t at = text.size(); at > 3; at -= 3) text.insert(at - 3, ",");
  return text;
}

}  // namespace

// Draws three numbers that are dragged or typed. Ctrl+click types a number.
void SplatsPanel::vector_row(const char* label, const char* id, double* values, double speed, const char* format,
                             const char* help) {
  splat_label(label, frame_->scale);
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x);
  ImGui::DragScalarN(id, ImGuiDataType_Double, values, 3, static_cast<float>(speed), nullptr, nullptr, format);
  frame_->tooltips.show(std::string(help) + "; drag, or Ctrl+click to type");
}

// Draws the first row of a crop. Returns false if the user deletes the crop.
bool SplatsPanel::crop_head(const char* label, SplatCrop& crop) {
  splat_label(label, frame_->scale);
  if (ImGui::RadioButton("Keep", !crop.removes)) crop.removes = false;
  frame_->tooltips.show("Keeps splats with centres in this region, or in another region set to Keep");
  ImGui::SameLine();
  if (ImGui::RadioButton("Remove", crop.removes)) crop.removes = true;
  frame_->tooltips.show("Removes splats with centres in this region, even if another region keeps them");
  ImGui::SameLine();
  const bool kept = !ImGui::SmallButton("Delete");
  frame_->tooltips.show("Deletes this region");
  return kept;
}

bool SplatsPanel::crop_row(double speed, SplatCrop& crop) {
  if (auto* const box = std::get_if<SplatBox>(&crop.shape)) {
    const bool kept = crop_head("Box", crop);
    vector_row("From", "##from", &box->lower.x, speed, "%.4g", "Lower corner of the box");
    vector_row("To", "##to", &box->upper.x, speed, "%.4g", "Upper corner of the box");
    box->upper = glm::max(box->upper, box->lower);
    return kept;
  }
  SplatBall& ball = std::get<SplatBall>(crop.shape);
  const bool kept = crop_head("Sphere", crop);
  vector_row("Centre", "##center", &ball.center.x, speed, "%.4g", "Centre of the sphere");
  splat_label("Radius", frame_->scale);
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x);
  const double least = speed * 0.01;
  ImGui::DragScalar("##radius", ImGuiDataType_Double, &ball.radius, static_cast<float>(speed), &least, nullptr, "%.4g");
  frame_->tooltips.show("Radius of the sphere");
  ball.radius = std::max(ball.radius, least);
  return kept;
}

void SplatsPanel::crop_rows(const UiSplats& splats, SplatEdit& edit) {
  const WideBox& middle = splats.extent.middle;
  const double size = size_of_scene(splats.extent);
  splat_label("Crop", frame_->scale);
  ImGui::BeginDisabled(middle.empty());
  if (ImGui::Button("Add box")) edit.crops.push_back({SplatBox{middle.lower, middle.upper}});
  frame_->tooltips.show("Adds a box that keeps nearly all splats at first (--crop-box, --remove-box)");
  ImGui::SameLine();
  if (ImGui::Button("Add sphere")) edit.crops.push_back({SplatBall{(middle.lower + middle.upper) * 0.5, size * 0.5}});
  frame_->tooltips.show("Adds a sphere around the middle of the splats (--crop-sphere, --remove-sphere)");
  ImGui::EndDisabled();
  for (std::size_t i = 0; i < edit.crops.size();) {
    ImGui::PushID(static_cast<int>(i));
    const bool kept = crop_row(kDragShare * size, edit.crops[i]);
    ImGui::PopID();
    if (kept)
      ++i;
    else
      edit.crops.erase(edit.crops.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

void SplatsPanel::limit_rows(const UiSplats& splats, SplatEdit& edit) {
  const float width = std::max(40.0f, ImGui::GetContentRegionAvail().x - (kSplatLabel + kSplatReading) * frame_->scale);
  splat_label("Opacity", frame_->scale);
  ImGui::SetNextItemWidth(width);
  auto opacity = static_cast<float>(edit.least_opacity);
  if (ImGui::SliderFloat("##opacity", &opacity, 0, 1, "", ImGuiSliderFlags_AlwaysClamp))
    edit.least_opacity = std::round(double{opacity} * 1000) / 1000;
  frame_->tooltips.show("Removes fainter splats, such as haze (--min-opacity)");
  ImGui::SameLine();
  text(edit.least_opacity > 0 ? "> " + readable_value(edit.least_opacity * 100) + " %" : "all");
  const LogScale scale{std::max(splats.extent.largest * kSmallestShare, 1e-30f),
                       std::max(splats.extent.largest, 2e-30f)};
  splat_label("Size", frame_->scale);
  ImGui::SetNextItemWidth(width);
  float place = edit.most_size > 0 ? scale.place_of(static_cast<float>(edit.most_size)) : 1;
  if (ImGui::SliderFloat("##size", &place, 0, 1, "", ImGuiSliderFlags_AlwaysClamp))
    edit.most_size = place < 1 ? static_cast<double>(scale.value_at(place)) : 0;
  frame_->tooltips.show(
      "Removes larger splats, such as floaters: those with a longer standard deviation "
      "(--max-splat-size)");
  ImGui::SameLine();
  text(edit.most_size > 0 ? "< " + readable_value(edit.most_size) : "all");
}

void SplatsPanel::transform_rows(const UiSplats& splats, SplatEdit& edit) {
  constexpr double kDegrees = 0.5;
  vector_row("Turn", "##turn", &edit.turn.x, kDegrees, "%.4g",
             "Degrees about the axes X, Y and Z through 0 0 0 (--turn)");
  vector_row("Move", "##move", &edit.move.x, kDragShare * size_of_scene(splats.extent) * edit.scale, "%.4g",
             "Distance along X, Y and Z, after scaling and turning (--move)");
  splat_label("Scale", frame_->scale);
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x);
  const double least = 1 / SplatEdit::kMostScale, most = SplatEdit::kMostScale;
  ImGui::DragScalar("##scale", ImGuiDataType_Double, &edit.scale, static_cast<float>(0.005 * edit.scale), &least, &most,
                    "%.4g");
  edit.scale = std::clamp(edit.scale, least, most);
  frame_->tooltips.show("Factor about the point 0 0 0 (--scale)");
  splat_label("Exposure", frame_->scale);
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x);
  auto stops = static_cast<float>(edit.exposure);
  if (ImGui::SliderFloat("##exposure", &stops, -kShownStops, kShownStops, "%.2f"))
    edit.exposure =
        std::clamp(std::round(double{stops} * 100) / 100, -SplatEdit::kMostExposure, SplatEdit::kMostExposure);
  frame_->tooltips.show("Stops; 1 doubles the light (--exposure)");
}

void SplatsPanel::button_rows(const UiSplats& splats, SplatEdit& edit, UiActions& actions) {
  const bool edits = !splats.edit.empty();
  ImGui::BeginDisabled(!edits);
  if (ImGui::Button("Reset all")) edit = {};
  ImGui::EndDisabled();
  frame_->tooltips.show("Removes all edits");
  ImGui::SameLine();
  if (ImGui::Button("Save as...")) actions.run = Action::save_as;
  frame_->tooltips.show("Writes the edited splats as .ply, .spz, .sog, .splats.glb or .qnv");
  ImGui::SameLine();
  ImGui::BeginDisabled(!edits);
  if (ImGui::Button("Copy command")) ImGui::SetClipboardText(splats.command.c_str());
  ImGui::EndDisabled();
  frame_->tooltips.show("Copies a command line that makes the edited file");
}

void SplatsPanel::draw(const PanelFrame& frame, const UiModel& model, UiActions& actions) {
  const UiSplats& splats = model.splats;
  if (!splats.editable) {
    ImGui::PushTextWrapPos(0);
    colored_text(UiColors::kQuiet, "This panel edits files of Gaussian splats. Open such a file to edit it.");
    ImGui::PopTextWrapPos();
    return;
  }
  frame_ = &frame;
  SplatEdit edit = splats.edit;
  const std::size_t all = splats.removed.before > 0 ? splats.removed.before : splats.shown;
  text(splat_count_text(splats.shown) + " of " + splat_count_text(all) + " splats");
  if (splats.busy) {
    ImGui::SameLine();
    colored_text(UiColors::kQuiet, "(changing)");
  }
  if (!splats.problem.empty()) colored_text(UiColors::kError, shortened(splats.problem, 300));
  ImGui::Separator();
  crop_rows(splats, edit);
  ImGui::Separator();
  limit_rows(splats, edit);
  ImGui::Separator();
  transform_rows(splats, edit);
  ImGui::Separator();
  button_rows(splats, edit, actions);
  if (!ImGui::IsAnyItemActive()) ++gesture_;
  if (edit != splats.edit) {
    actions.splats.edit = edit;
    actions.splats.gesture = gesture_;
  }
  frame_ = nullptr;
}

}  // namespace gs::app
