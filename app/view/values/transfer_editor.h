#pragma once

#include "qnv/base/cloud.h"
#include "render/scene/world_bounds.h"

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

/// What the panel for clouds does, without the panel: pure functions.
namespace gs::app {

// The transfer function ------------------------------------------------------------------------------

/// Sorted by value; values and opacities 0..1.
using Transfer = std::vector<qnv::TransferPoint>;

inline constexpr std::size_t kMostTransferPoints = 64;

/// The same function, as far as it is one: sorted, within 0..1, without what is no number, with no more than
/// kMostTransferPoints points. Never empty.
[[nodiscard]] Transfer sound_transfer(Transfer points);
/// What a volume is shown with that nobody has edited: its own function, or the one that is made for it.
[[nodiscard]] Transfer own_transfer(const qnv::Description& volume);
/// Colour and opacity at a value 0..1: linear between points, constant beyond them, as volume_model has it.
[[nodiscard]] qnv::TransferPoint transfer_at(const Transfer& transfer, float value);

/// A point where the function has none yet: it takes the colour that is there. Its index; nothing when there are
/// kMostTransferPoints already.
std::optional<std::size_t> add_point(Transfer& transfer, float value, float opacity);
/// Moves a point, but not past its neighbours.
void move_point(Transfer& transfer, std::size_t index, float value, float opacity);
/// Removes a point, unless it is the last one. True when it did.
bool remove_point(Transfer& transfer, std::size_t index);

/// A transfer function to begin with.
struct TransferPreset {
  const char* label;
  const char* help;
  Transfer (*make)(std::pair<float, float> value_range);
};
/// All but a volume's own. Those for computed tomography know Hounsfield units, and values that lie 1000 above
/// them, by the range; in others they take about the same parts of it.
[[nodiscard]] std::span<const TransferPreset> transfer_presets();

// What is in the volumes ----------------------------------------------------------------------------

/// Worth computing once for a cloud: takes time in proportion to its vectors.
struct VolumeSummary {
  std::array<float, 256> classes{};  // by class: the sum of the magnitudes, the largest one is 1
  std::vector<float> magnitudes;     // > 0, sorted; of up to 65,536 vectors that stand for all
  [[nodiscard]] float least() const { return magnitudes.empty() ? 0.0f : magnitudes.front(); }
  [[nodiscard]] float largest() const { return magnitudes.empty() ? 0.0f : magnitudes.back(); }
};
[[nodiscard]] VolumeSummary summarize(std::span<const std::shared_ptr<const qnv::Cloud>> volumes);
/// The part, 0..1, of the vectors that are as long or longer.
[[nodiscard]] float share_left(const VolumeSummary& summary, float least_magnitude);

// Sliders ---------------------------------------------------------------------------------------------

/// Values on a slider from 0 to 1 whose steps are proportional to the value. 0 < least < largest.
struct LogScale {
  float least = 0.1f, largest = 10;
  bool zero = false;  // the lower end stands for 0
  [[nodiscard]] float value_at(float place) const;
  [[nodiscard]] float place_of(float value) const;
};
/// For CloudLook::opacity: what it is by itself lies in the middle.
[[nodiscard]] LogScale opacity_scale();
/// For CloudLook::least_magnitude.
[[nodiscard]] LogScale magnitude_scale(const VolumeSummary& summary);

// The clipping plane ------------------------------------------------------------------------------------

enum class ClipAxis : std::uint8_t { x, y, z, view };

struct ClipChoice {
  ClipAxis axis = ClipAxis::x;
  bool flip = false;         // of x, y, z: keep the lower part
  glm::vec3 view{0, 0, -1};  // of `view`: towards what is kept, unit length
  float place = 0.5f;        // 0: everything is kept, 1: nothing
};

/// The plane, world space, for CloudLook::clip: kept is what has xyz . position + w >= 0.
[[nodiscard]] glm::dvec4 clip_plane(const ClipChoice& choice, const render::WorldBounds& bounds);
/// The choice that makes this plane.
[[nodiscard]] ClipChoice clip_choice(const glm::dvec4& plane, const render::WorldBounds& bounds);
/// The plane stays where it is, and the other side is kept.
[[nodiscard]] ClipChoice flipped(ClipChoice choice);

}  // namespace gs::app
