#include "app/formats/export/export_discs.h"

#include "app/formats/splats/splats.h"
#include "base/finite.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gs::app {
namespace {

/// Returns the shortest rotation from +Z to a unit vector, as a quaternion x, y, z, w.
glm::vec4 rotation_to(const glm::vec3& n) {
  const double w = 1.0 + static_cast<double>(n.z);
  const double length = std::sqrt(w * w + static_cast<double>(n.x) * n.x + static_cast<double>(n.y) * n.y);
  if (!(length > 1e-6)) return {1, 0, 0, 0};  // opposite direction: half a turn about x
  return {static_cast<float>(-n.y / length), static_cast<float>(n.x / length), 0, static_cast<float>(w / length)};
}

}  // namespace

ExportDiscs::ExportDiscs(const qnv::VectorView& vectors) : vectors_(vectors) {
  if (!balls()) return;
  most_weight_ = std::numeric_limits<float>::min();
  for (const float weight : vectors.weights)
    if (std::isfinite(weight)) most_weight_ = std::max(most_weight_, weight);
  float width = vectors.description.spacing;
  if (!(width > 0) && !vectors.description.box.empty()) {
    const glm::vec3 size = vectors.description.box.size();
    width = std::cbrt(size.x * size.y * size.z / static_cast<float>(std::max<std::size_t>(vectors.size(), 1)));
  }
  if (std::isnormal(width * width)) ball_area_ = width * width;
}

ExportDisc ExportDiscs::operator[](std::size_t i) const {
  ExportDisc disc;
  disc.position = vectors_.positions[i];
  if (!vectors_.normals.empty()) disc.normal = vectors_.normals[i];
  if (!vectors_.weights.empty()) disc.area = vectors_.weights[i];
  disc.color = vectors_.colors.empty() ? vectors_.color : vectors_.colors[i];
  if (balls()) shade_volume(i, disc);
  return disc;
}

void ExportDiscs::shade_volume(std::size_t i, ExportDisc& disc) const {
  const std::vector<qnv::TransferPoint>& transfer = vectors_.description.transfer;
  const std::uint8_t level = vectors_.classes.empty() ? 255 : vectors_.classes[i];
  disc.opacity = std::clamp(disc.area / most_weight_, 0.0f, 1.0f);
  disc.area = ball_area_;
  disc.normal = -disc.normal;  // gradients point inwards, normals outwards
  if (transfer.empty()) {
    if (!vectors_.classes.empty()) disc.color = {level, level, level};
    return;
  }
  const float value = static_cast<float>(level) / 255;
  const auto above = std::find_if(transfer.begin(), transfer.end(), [&](const auto& p) { return p.value >= value; });
  const qnv::TransferPoint& to = above == transfer.end() ? transfer.back() : *above;
  const qnv::TransferPoint& from = above == transfer.begin() ? to : *(above - 1);
  const float t = to.value > from.value ? std::clamp((value - from.value) / (to.value - from.value), 0.0f, 1.0f) : 1.0f;
  const auto mix = [&](std::uint8_t a, std::uint8_t b) {
    return static_cast<std::uint8_t>(
        std::lround(static_cast<float>(a) + (static_cast<float>(b) - static_cast<float>(a)) * t));
  };
  disc.color = {mix(from.color.r, to.color.r), mix(from.color.g, to.color.g), mix(from.color.b, to.color.b)};
  disc.opacity = std::clamp(from.opacity + (to.opacity - from.opacity) * t, 0.0f, 1.0f);
}

std::vector<ExportDisc> visible_discs(const ExportDiscs& discs) {
  std::vector<ExportDisc> visible;
  visible.reserve(discs.size());
  for (std::size_t i = 0; i < discs.size(); ++i) {
    const ExportDisc disc = discs[i];
    if (finite(disc.position) && finite(disc.normal) && std::isnormal(disc.area) && disc.area > 0 &&
        disc.opacity >= kMinOpacity)
      visible.push_back(disc);
  }
  return visible;
}

std::vector<ExportSplat> splats_of(const qnv::VectorView& vectors, const glm::vec3& axes) {
  const ExportDiscs discs(vectors);
  std::vector<ExportSplat> splats;
  splats.reserve(discs.size());
  const auto coefficient = [](std::uint8_t c) { return (static_cast<float>(c) / 255 - 0.5f) / kSphericalHarmonic0; };
  for (const ExportDisc& disc : visible_discs(discs)) {
    ExportSplat splat;
    splat.position = disc.position * axes;
    splat.normal = disc.normal * axes;
    splat.rotation = rotation_to(splat.normal);
    const float sigma = kSigmaOfRadius * std::sqrt(disc.area / std::numbers::pi_v<float>);
    splat.scale = {sigma, sigma, discs.balls() ? sigma : sigma * kDiscThickness};
    splat.dc = {coefficient(disc.color.r), coefficient(disc.color.g), coefficient(disc.color.b)};
    splat.opacity = std::min(disc.opacity, kSurfaceOpacity);
    splats.push_back(splat);
  }
  return splats;
}

}  // namespace gs::app
