#pragma once

#include "qnv/base/geometry.h"
#include "render/scene/fog.h"
#include "render/scene/splat_style.h"

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

/// Drawing model of a volume's vectors. raycast() and rasterize_volumes() both use it.
///
/// Vector k is a soft disc that faces the viewer: parallel to the image plane, at the vector's depth. The ray of a
/// pixel meets the disc's plane at distance d from its centre. The disc's opacity there is (paper, 3.1)
///
///     alpha(u; x_k) = a_k exp(-d^2 / A_k),   A_k = kVolumeFootprint s_k^2
///
/// s_k is the spacing of the vectors around k, so that discs overlap even in a short prefix.
///
///     a_k = min(kVolumeMostAlpha, opacity t(class) m(weight) / (pi kVolumeFootprint))
///
/// t is the optical depth of a layer of such vectors: -log(1 - o), with the opacity o of the transfer function for the
/// vector's class. m grows linearly with the magnitude, to 1 at VolumeModel::full_magnitude. a_k does not depend on
/// s_k: if fewer vectors are drawn, they have larger areas. The paper conserves the integrated area in this way.
///
/// A pixel has an area. So A_k is at least kVolumePixel square pixels, and a_k is then reduced in proportion.
///
/// The image is equation (1): c(x_k) alpha(u; x_k), composited over the background in order of depth. At equal depth,
/// the vector with the lower index is in front. Vectors are skipped if they have no opacity, or are nearer than the
/// near plane or than their own s_k.
inline constexpr float kVolumeFootprint = 0.8f, kVolumeMostAlpha = 0.98f, kVolumePixel = 0.5f;
inline constexpr float kVolumePi = 3.14159265f;

/// Light in camera space. A light with all colours 0 has no effect.
struct VolumeLight {
  bool directional = true;
  glm::vec3 place{0, 0, 1};  // position, or unit vector towards a directional light
  glm::vec3 color{1};  // colour times intensity
  float ambient = 0;         // ambientIntensity / intensity
  glm::vec3 attenuation{1, 0, 0};
  float radius = 0;
  glm::vec3 direction{0, 0, -1};  // for spot lights: unit vector
  float beam_width = 4, cut_off_angle = 4;
};

/// By class: RGB from 0 to 1, and the optical depth t.
using VolumeTransfer = std::array<glm::vec4, 256>;

/// Returns the table of a transfer function. If `points` is empty, uses the points of the description, or else
/// default_transfer(). Points that are not finite or out of order hide the points after them. Takes microseconds.
/// Thread-safe; accepts any numbers.
[[nodiscard]] VolumeTransfer volume_transfer(const qnv::Description& about,
                                             std::span<const qnv::TransferPoint> points = {});

/// Drawing options of a volume.
struct VolumeOptions {
  float opacity = 2;                         // factor of the optical depth
  float least_magnitude = 0;  // vectors with a smaller weight are hidden
  std::optional<glm::vec4> clip;  // node space: vectors with dot(clip.xyz, position) + clip.w < 0 are hidden
  std::optional<glm::vec3> color;  // replaces the colours of transfer function and vectors
  ColorBy color_by = ColorBy::own;  // unless `own`, replaces all colours, including `color`; opacities stay
  const VolumeTransfer* transfer = nullptr;  // null means the table of the model
  float ambient = 0.25f, diffuse = 0.75f;  // weights of ambient and directional light
  float specular = 0.12f;  // weight of the highlight, which is white
  std::span<const VolumeLight> lights;       // empty means one light at the viewer
  CameraFog fog;
};

/// Data of a volume, or of a prefix of its vectors, that does not depend on the view.
struct VolumeModel {
  /// s_k in node units:
  /// - Description::spacing, if the vectors around k are as dense as in a boundary three voxels thick;
  /// - e sqrt(3 / n) if they are sparser, with n vectors in a cube of edge e around k;
  /// - e cbrt(1 / n) if they are denser than in a solid.
  /// At most twice the 90th percentile. If all vectors are drawn, at most the edge of the vector's cell.
  std::vector<float> spacing;
  VolumeTransfer transfer{};  // table of the volume's description
  float full_magnitude = 0;  // median weight of the whole volume

  [[nodiscard]] bool empty() const { return spacing.empty(); }
};

/// Numbers of vectors: `shown` are drawn, and the spacings are computed for `counted`.
struct VolumePrefix {
  std::size_t shown = 0, counted = 0;
  friend bool operator==(const VolumePrefix&, const VolumePrefix&) = default;
};
/// Returns the prefix that a budget permits (0 means all), of `size` vectors in progressive order. If not all are
/// shown, `counted` is the largest power of sqrt(2) up to `shown`. So few models are sufficient for all budgets, but
/// vectors overlap by up to a fifth more than necessary.
[[nodiscard]] VolumePrefix volume_prefix(std::size_t size, std::size_t budget);

/// Computes the model of a volume. By default, the model is for images of all vectors.
///
/// With `counted` from volume_prefix() and less than the size, the model is for all prefixes with that `counted`. It
/// has spacings for all vectors of these prefixes, as among the first `counted` vectors.
///
/// Returns an empty model if the volume is empty or its arrays are inconsistent. Thread-safe; accepts any numbers. The
/// number of threads does not affect the result. Takes a few bytes per vector and at most 16 MB.
[[nodiscard]] VolumeModel volume_model(const qnv::Volume& volume, unsigned threads = 0,
                                       std::size_t counted = std::numeric_limits<std::size_t>::max());

/// Returns the transfer table that applies: that of the options, or else of the model.
[[nodiscard]] inline const VolumeTransfer& volume_transfer(const VolumeModel& model, const VolumeOptions& options) {
  return options.transfer ? *options.transfer : model.transfer;
}

/// Returns a_k of a vector, before the reduction for pixels. 0 means that the vector is invisible.
[[nodiscard]] inline float volume_alpha(const qnv::Volume& volume, const VolumeModel& model,
                                        const VolumeOptions& options, std::size_t k) {
  const float weight = volume.weights[k];
  if (!(weight >= options.least_magnitude)) return 0;
  if (options.clip) {
    const glm::vec4& c = *options.clip;
    const glm::vec3& p = volume.positions[k];
    if (!(c.x * p.x + c.y * p.y + c.z * p.z + c.w >= 0)) return 0;
  }
  const float depth = volume_transfer(model, options)[volume.classes.empty() ? 255u : volume.classes[k]].w;
  const float magnitude = weight < model.full_magnitude ? weight / model.full_magnitude : 1.0f;
  const float alpha = options.opacity * depth * magnitude * (1 / (kVolumePi * kVolumeFootprint));
  return alpha > 0 ? (alpha < kVolumeMostAlpha ? alpha : kVolumeMostAlpha) : 0.0f;
}

/// Returns the colour of vector k for a ColorBy, 0 to 1. Returns white for ColorBy::own.
[[nodiscard]] glm::vec3 volume_color_by(const qnv::Volume& volume, ColorBy by, std::size_t k);

/// Returns the unlit colour of vector k, 0 to 1.
[[nodiscard]] inline glm::vec3 volume_color(const qnv::Volume& volume, const VolumeModel& model,
                                            const VolumeOptions& options, std::size_t k) {
  if (options.color_by != ColorBy::own) return volume_color_by(volume, options.color_by, k);
  if (options.color) return *options.color;
  if (!volume.colors.empty())
    return glm::vec3(volume.colors[k].r, volume.colors[k].g, volume.colors[k].b) * (1 / 255.0f);
  return glm::vec3(volume_transfer(model, options)[volume.classes.empty() ? 255u : volume.classes[k]]);
}

/// Returns c(x_k): `color` with lighting and fog, 0 to 1. `place` and `normal` are in camera space; `normal` may have
/// any length. Both sides of the normal are lit. If it is 0, light comes from all directions.
[[nodiscard]] glm::vec3 volume_shade(const VolumeOptions& options, const glm::vec3& color, const glm::vec3& place,
                                     const glm::vec3& normal);

/// Returns a list of one light at the viewer.
[[nodiscard]] std::span<const VolumeLight> volume_headlight();

}  // namespace gs::render
