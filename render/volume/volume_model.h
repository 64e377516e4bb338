#pragma once

#include "qnv/base/cloud.h"
#include "render/scene/cloud_look.h"
#include "render/scene/fog.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace gs::render {

/// How the vectors of a volume are drawn; what raycast and rasterize_volume have in common.
///
/// Vector k is a soft disc that faces the viewer: parallel to the picture, at the vector's depth. Where the ray of a
/// pixel meets its plane at a distance d of its centre, it has the opacity (paper, 3.1)
///
///     alpha(u; x_k) = a_k exp(-d^2 / A_k),   A_k = kVolumeFootprint s_k^2
///
/// where s_k is the spacing of the vectors about k, so that they overlap however few have arrived, and
/// a_k = min(kVolumeMostAlpha, opacity t(class) m(weight) / (pi kVolumeFootprint)). t is the optical depth of a layer
/// of such vectors: -log(1 - o), o the transfer function's opacity of the vector's class. m rises in proportion to
/// the magnitude and is 1 from VolumeModel::full_magnitude on. The peak does not depend on s_k: what is lost in
/// vectors is gained in area, as in the paper's conservation of the integrated area.
///
/// A pixel is no point: A_k is at least kVolumePixel pixels^2, and a_k then less in proportion.
///
/// The picture is equation (1): c(x_k) alpha(u; x_k) over what lies behind, in the order of depth; vectors of the same
/// depth in the order of their numbers, the first one in front. Vectors that are nearer than the near plane or
/// than their own s_k are left out, and so are those without opacity.
inline constexpr float kVolumeFootprint = 0.8f, kVolumeMostAlpha = 0.98f, kVolumePixel = 0.5f;
inline constexpr float kVolumePi = 3.14159265f;

/// Camera space. All zero: a light that adds nothing.
struct VolumeLight {
  bool directional = true;
  glm::vec3 place{0, 0, 1};  // directional: towards the light, unit length
  glm::vec3 color{1};        // times the intensity
  float ambient = 0;         // ambientIntensity / intensity
  glm::vec3 attenuation{1, 0, 0};
  float radius = 0;
  glm::vec3 direction{0, 0, -1};  // of a spot light, unit length
  float beam_width = 4, cut_off_angle = 4;
};

/// By class: RGB 0..1, optical depth t.
using VolumeTransfer = std::array<glm::vec4, 256>;

/// The table of a transfer function; `points` empty: the description's, or default_transfer(). Points out of order
/// or without a number hide those behind them. Takes microseconds; any thread; safe for any numbers.
[[nodiscard]] VolumeTransfer volume_transfer(const qnv::Description& about,
                                             std::span<const qnv::TransferPoint> points = {});

/// What the viewer chooses.
struct VolumeOptions {
  float opacity = 2;                         // times the optical depth
  float least_magnitude = 0;                 // shorter vectors are left out
  std::optional<glm::vec4> clip;             // node space: vectors with clip.xyz . position + clip.w < 0 are left out
  std::optional<glm::vec3> color;            // in place of the transfer function's and the vectors' colours
  ColorBy color_by = ColorBy::own;           // likewise, and in place of `color`; the opacity stays
  const VolumeTransfer* transfer = nullptr;  // null: the model's
  float ambient = 0.25f, diffuse = 0.75f;    // of the light that falls on a vector, whatever its direction, and by it
  float specular = 0.12f;                    // gloss, towards white
  std::span<const VolumeLight> lights;       // none: one with the viewer
  CameraFog fog;
};

/// What is the same in all pictures of a cloud, or of the first vectors of it.
struct VolumeModel {
  /// s_k, node units: Description::spacing where the vectors about k stand as close as in a boundary that is three
  /// voxels thick; where fewer are there, e sqrt(3 / n) for n vectors in a cube of edge e about k; where more than in
  /// a solid, e cbrt(1 / n). At most twice what nine tenths of the vectors have. Where all vectors are drawn, at most
  /// the edge of the cell that a vector stands for, if it has one.
  std::vector<float> spacing;
  VolumeTransfer transfer{};  // of the cloud's description
  float full_magnitude = 0;   // the median of the weights of the whole cloud

  [[nodiscard]] bool empty() const { return spacing.empty(); }
};

/// How many of the vectors of a cloud are drawn, and of how many their spacing is taken.
struct VolumePrefix {
  std::size_t shown = 0, counted = 0;
  friend bool operator==(const VolumePrefix&, const VolumePrefix&) = default;
};
/// Of `size` vectors in progressive order those that a budget allows (0: all). Where that is less than all, `counted`
/// is the largest power of the square root of two that is not more than `shown`, so that few models serve all
/// budgets; the vectors then overlap by up to a fifth more than they have to.
[[nodiscard]] VolumePrefix volume_prefix(std::size_t size, std::size_t budget);

/// The model of pictures that show all vectors, or, where `counted` is one of volume_prefix() and less than the cloud's
/// size, any number of the first ones that has this `counted`: the spacings are then those among the first `counted`,
/// given for all vectors that may be shown.
///
/// Empty when the cloud is, or when its arrays do not fit together. Any thread; safe for any numbers; the same for
/// every number of threads. Needs a few bytes a vector and at most 16 MB more.
[[nodiscard]] VolumeModel volume_model(const qnv::Cloud& cloud, unsigned threads = 0,
                                       std::size_t counted = std::numeric_limits<std::size_t>::max());

/// The table that holds.
[[nodiscard]] inline const VolumeTransfer& volume_transfer(const VolumeModel& model, const VolumeOptions& options) {
  return options.transfer ? *options.transfer : model.transfer;
}

/// a_k at full size. 0: not to be drawn.
[[nodiscard]] inline float volume_alpha(const qnv::Cloud& cloud, const VolumeModel& model, const VolumeOptions& options,
                                        std::size_t k) {
  const float weight = cloud.weights[k];
  if (!(weight >= options.least_magnitude)) return 0;
  if (options.clip) {
    const glm::vec4& c = *options.clip;
    const glm::vec3& p = cloud.positions[k];
    if (!(c.x * p.x + c.y * p.y + c.z * p.z + c.w >= 0)) return 0;
  }
  const float depth = volume_transfer(model, options)[cloud.classes.empty() ? 255u : cloud.classes[k]].w;
  const float magnitude = weight < model.full_magnitude ? weight / model.full_magnitude : 1.0f;
  const float alpha = options.opacity * depth * magnitude * (1 / (kVolumePi * kVolumeFootprint));
  return alpha > 0 ? (alpha < kVolumeMostAlpha ? alpha : kVolumeMostAlpha) : 0.0f;
}

/// What `by` gives vector k, 0..1: ColorBy::own white.
[[nodiscard]] glm::vec3 volume_color_by(const qnv::Cloud& cloud, ColorBy by, std::size_t k);

/// The colour of vector k, 0..1, without light.
[[nodiscard]] inline glm::vec3 volume_color(const qnv::Cloud& cloud, const VolumeModel& model,
                                            const VolumeOptions& options, std::size_t k) {
  if (options.color_by != ColorBy::own) return volume_color_by(cloud, options.color_by, k);
  if (options.color) return *options.color;
  if (!cloud.colors.empty()) return glm::vec3(cloud.colors[k].r, cloud.colors[k].g, cloud.colors[k].b) * (1 / 255.0f);
  return glm::vec3(volume_transfer(model, options)[cloud.classes.empty() ? 255u : cloud.classes[k]]);
}

/// c(x_k): `color` in the light of all lights and behind the fog, 0..1. `place` and `normal` (of any length) are in
/// camera space; the normal has two sides; without a direction the light falls on it from everywhere.
[[nodiscard]] glm::vec3 volume_shade(const VolumeOptions& options, const glm::vec3& color, const glm::vec3& place,
                                     const glm::vec3& normal);

/// One light, with the viewer.
[[nodiscard]] std::span<const VolumeLight> volume_headlight();

}  // namespace gs::render
