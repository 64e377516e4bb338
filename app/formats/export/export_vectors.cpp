#include "app/formats/export/export_vectors.h"

#include "app/formats/splats/splat_axes.h"
#include "app/formats/splats/splats.h"
#include "base/finite.h"

#include <glm/common.hpp>

#include <algorithm>
#include <array>
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

ExportSplats splats_of_gaussians(const qnv::Gaussians& gaussians, const glm::vec3& axes) {
  ExportSplats made;
  made.degree = gaussians.degree;
  made.antialiased = gaussians.antialiased;
  made.splats.reserve(gaussians.size());
  made.harmonics.reserve(gaussians.harmonics.size());
  for (std::size_t i = 0; i < gaussians.size(); ++i) {
    ExportSplat splat;
    splat.position = gaussians.positions[i] * axes;
    splat.normal = gaussians.normals[i] * axes;
    splat.scale = glm::max(gaussians.scales[i], glm::vec3(kLeastScale));
    splat.rotation = turned(gaussians.rotations[i], axes);
    if (splat.rotation.w < 0) splat.rotation = -splat.rotation;
    splat.dc = (gaussians.bases[i] - 0.5f) / kSphericalHarmonic0;
    splat.opacity = std::min(gaussians.opacities[i], kMostOpacity);
    made.splats.push_back(splat);
  }
  const std::array<float, 15> signs = harmonic_signs(axes);
  const std::size_t per = qnv::harmonic_count(gaussians.degree);
  for (std::size_t k = 0; k < gaussians.harmonics.size(); ++k)
    made.harmonics.push_back(gaussians.harmonics[k] * signs[k % per]);
  return made;
}

}  // namespace

ExportVectors::ExportVectors(const qnv::VectorView& vectors) : vectors_(vectors) {
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

ExportVector ExportVectors::operator[](std::size_t i) const {
  ExportVector item;
  item.position = vectors_.positions[i];
  if (!vectors_.normals.empty()) item.normal = vectors_.normals[i];
  if (!vectors_.weights.empty()) item.area = vectors_.weights[i];
  item.color = vectors_.colors.empty() ? vectors_.color : vectors_.colors[i];
  if (balls()) shade_volume(i, item);
  return item;
}

void ExportVectors::shade_volume(std::size_t i, ExportVector& item) const {
  const std::vector<qnv::TransferPoint>& transfer = vectors_.description.transfer;
  const std::uint8_t level = vectors_.classes.empty() ? 255 : vectors_.classes[i];
  item.opacity = std::clamp(item.area / most_weight_, 0.0f, 1.0f);
  item.area = ball_area_;
  item.normal = -item.normal;  // gradients point inwards, normals outwards
  if (transfer.empty()) {
    if (!vectors_.classes.empty()) item.color = {level, level, level};
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
  item.color = {mix(from.color.r, to.color.r), mix(from.color.g, to.color.g), mix(from.color.b, to.color.b)};
  item.opacity = std::clamp(from.opacity + (to.opacity - from.opacity) * t, 0.0f, 1.0f);
}

std::vector<ExportVector> visible_vectors(const ExportVectors& exported) {
  std::vector<ExportVector> visible;
  visible.reserve(exported.size());
  for (std::size_t i = 0; i < exported.size(); ++i) {
    const ExportVector item = exported[i];
    if (finite(item.position) && finite(item.normal) && std::isnormal(item.area) && item.area > 0 &&
        item.opacity >= kMinOpacity)
      visible.push_back(item);
  }
  return visible;
}

ExportSplats splats_of(const qnv::Geometry& geometry, const glm::vec3& axes) {
  if (const auto* gaussians = geometry.as<qnv::Gaussians>()) return splats_of_gaussians(*gaussians, axes);
  const qnv::VectorView vectors(geometry);
  const ExportVectors exported(vectors);
  ExportSplats made;
  std::vector<ExportSplat>& splats = made.splats;
  splats.reserve(exported.size());
  const auto coefficient = [](std::uint8_t c) { return (static_cast<float>(c) / 255 - 0.5f) / kSphericalHarmonic0; };
  for (const ExportVector& item : visible_vectors(exported)) {
    ExportSplat splat;
    splat.position = item.position * axes;
    splat.normal = item.normal * axes;
    splat.rotation = rotation_to(splat.normal);
    const float sigma = kSigmaOfRadius * std::sqrt(item.area / std::numbers::pi_v<float>);
    splat.scale = {sigma, sigma, exported.balls() ? sigma : sigma * kSplatThickness};
    splat.dc = {coefficient(item.color.r), coefficient(item.color.g), coefficient(item.color.b)};
    splat.opacity = std::min(item.opacity, kSurfaceOpacity);
    splats.push_back(splat);
  }
  return made;
}

}  // namespace gs::app
