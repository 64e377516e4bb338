#pragma once

#include "qnv/base/geometry.h"
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

/// Drawing model of a volume's vectors, shared by raycast and rasterize_volume.
///
/// Vector k is a soft disc that faces the viewer: parallel to the image plane, at the vector's depth. If the ray of a
/// pixel meets its plane at distance d from its centre, its opacity is (paper, 3.1)
///
///     alpha(u; x_k) = a_k exp(-d^2 / A_k),   A_k = kVolumeFootprint s_k^2
///
/// s_k is the spacing of the vectors around k, so that they overlap even in a short prefix. a_k = min(kVolumeMostAlpha,
/// opacity t(class) m(weight) / (pi kVolumeFootprint)). t is the optical depth of a layer of such vectors: -log(1 - o),
/// where o is the transfer function's opacity for the vector's class. m grows linearly with the magnitude and is 1 from
/// VolumeModel::full_magnitude on. The peak does not depend on s_k: fewer vectors have larger areas, as in the paper's
/// conservation of the integrated area.
///
/// A pixel has an area: A_k is at least kVolumePixel pixels^2, and a_k is then reduced in proportion.
///
/// The image is equation (1): c(x_k) alpha(u; x_k) composited over the background in depth order. At equal depth, the
/// vector with the lower index is in front. Vectors closer than the near plane or than their own s_k are skipped, and
/// so are those without opacity.
inline constexpr float kVolumeFootprint = 0.8f, kVolumeMostAlpha = 0.98f, kVolumePixel = 0.5f;
inline constexpr float kVolumePi = 3.14159265f;

/// Light in camera space. All zero means no effect.
struct VolumeLight {
  bool directional = true;
  glm::vec3 place{0, 0, 1};  // directional: unit vector towards the light
  glm::vec3 color{1};        // times the intensity
  float ambient = 0;         // ambientIntensity / intensity
  glm::vec3 attenuation{1, 0, 0};
  float radius = 0;
  glm::vec3 direction{0, 0, -1};  // spot lights: unit vector
  float beam_width = 4, cut_off_angle = 4;
};

/// By class: RGB 0..1, optical depth t.
using VolumeTransfer = std::array<glm::vec4, 256>;

/// Returns the table of a transfer function; empty `points` mean the description's, or default_transfer(). An unordered
/// or non-finite point hides the following ones. Takes microseconds. Thread-safe; accepts any numbers.
[[nodiscard]] VolumeTransfer volume_transfer(const qnv::Description& about,
                                             std::span<const qnv::TransferPoint> points = {});

/// Drawing options of a volume.
struct VolumeOptions {
  float opacity = 2;                         // factor of the optical depth
  float least_magnitude = 0;                 // shorter vectors are hidden
  std::optional<glm::vec4> clip;             // node space: hides vectors with clip.xyz . position + clip.w < 0
  std::optional<glm::vec3> color;            // replaces colours of the transfer function and the vectors
  ColorBy color_by = ColorBy::own;           // replaces all colours, including `color`; the opacity stays
  const VolumeTransfer* transfer = nullptr;  // null means the model's
  float ambient = 0.25f, diffuse = 0.75f;    // ambient and directional part of the light on a vector
  float specular = 0.12f;                    // highlight, towards white
  std::span<const VolumeLight> lights;       // empty means one light at the viewer
  CameraFog fog;
};

/// View-independent data of a point set, or of a prefix of its vectors.
struct VolumeModel {
  /// s_k in node units. It is Description::spacing if vectors around k are as dense as in a boundary three voxels
  /// thick. For sparser vectors it is e sqrt(3 / n) for n vectors in a cube of edge e around k; for vectors denser than
  /// a solid, e cbrt(1 / n). At most twice the 90th percentile. If all vectors are drawn, at most the edge of the
  /// vector's cell, if it has one.
  std::vector<float> spacing;
  VolumeTransfer transfer{};  // from the point set's description
  float full_magnitude = 0;   // median of the weights of the whole point set

  [[nodiscard]] bool empty() const { return spacing.empty(); }
};

/// Number of vectors to draw, and number from which their spacing is computed.
struct VolumePrefix {
  std::size_t shown = 0, counted = 0;
  friend bool operator==(const VolumePrefix&, const VolumePrefix&) = default;
};
/// Returns the prefix of `size` vectors in progressive order that a budget permits (0 means all). For a partial prefix,
/// `counted` is the largest power of sqrt(2) that is at most `shown`, so that few models serve all budgets; vectors
/// then overlap by up to a fifth more than needed.
[[nodiscard]] VolumePrefix volume_prefix(std::size_t size, std::size_t budget);

/// Computes the model for images of all vectors. If `counted` comes from volume_prefix() and is less than the point
/// set's size, computes it for any prefix with that `counted`: the spacings are those among the first `counted`
/// vectors, given for all vectors that may be shown.
///
/// Empty if the point set is empty or its arrays are inconsistent. Thread-safe; accepts any numbers; the result does
/// not depend on the number of threads. Takes a few bytes per vector plus at most 16 MB.
[[nodiscard]] VolumeModel volume_model(const qnv::Volume& volume, unsigned threads = 0,
                                       std::size_t counted = std::numeric_limits<std::size_t>::max());

/// Returns the transfer table in effect.
[[nodiscard]] inline const VolumeTransfer& volume_transfer(const VolumeModel& model, const VolumeOptions& options) {
  return options.transfer ? *options.transfer : model.transfer;
}

/// Returns a_k at full size. 0 means invisible.
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

/// Returns the colour of vector k by `by`, 0..1; white for ColorBy::own.
[[nodiscard]] glm::vec3 volume_color_by(const qnv::Volume& volume, ColorBy by, std::size_t k);

/// Returns the unlit colour of vector k, 0..1.
[[nodiscard]] inline glm::vec3 volume_color(const qnv::Volume& volume, const VolumeModel& model,
                                            const VolumeOptions& options, std::size_t k) {
  if (options.color_by != ColorBy::own) return volume_color_by(volume, options.color_by, k);
  if (options.color) return *options.color;
  if (!volume.colors.empty())
    return glm::vec3(volume.colors[k].r, volume.colors[k].g, volume.colors[k].b) * (1 / 255.0f);
  return glm::vec3(volume_transfer(model, options)[volume.classes.empty() ? 255u : volume.classes[k]]);
}

/// Returns c(x_k): `color` after lighting and fog, 0..1. `place` and `normal` (of any length) are in camera space. The
/// normal is two-sided; without a direction, light arrives from everywhere.
[[nodiscard]] glm::vec3 volume_shade(const VolumeOptions& options, const glm::vec3& color, const glm::vec3& place,
                                     const glm::vec3& normal);

/// Returns one light at the viewer.
[[nodiscard]] std::span<const VolumeLight> volume_headlight();

}  // namespace gs::render
