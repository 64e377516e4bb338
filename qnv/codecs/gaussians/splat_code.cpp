#include "qnv/codecs/gaussians/splat_code.h"

#include "qnv/codecs/gaussians/power.h"

#include "qnv/base/kernel_pragmas.inc"

#include <algorithm>
#include <cmath>

namespace gs::qnv::gaussians {
namespace {

/// Returns power_of() for `count` consecutive exponents from `first` on.
template <std::size_t count>
constexpr std::array<double, count> powers_from(int first) {
  std::array<double, count> all{};
  for (std::size_t i = 0; i < count; ++i) all[i] = power_of(first + static_cast<int>(i));
  return all;
}
constexpr auto kScales = powers_from<kMostScale + 1>(kLeastOctave * kScaleSteps);

}  // namespace

double scale_of(int code) { return kScales[static_cast<std::size_t>(code)]; }

int scale_code(double scale) {
  if (!(scale > 0)) return 0;
  const double steps = (std::log2(scale) - kLeastOctave) * kScaleSteps;
  return static_cast<int>(std::clamp(std::nearbyint(steps), 0.0, static_cast<double>(kMostScale)));
}

double opacity_of(int code) { return static_cast<double>(code) / kMostOpacity; }

int opacity_code(double opacity) {
  return static_cast<int>(std::clamp(std::nearbyint(opacity * kMostOpacity), 1.0, static_cast<double>(kMostOpacity)));
}

SplatAxes axes_of(const glm::vec4& q) {
  const double x = q.x, y = q.y, z = q.z, w = q.w;
  return {{{1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)},
           {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)},
           {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)}}};
}

SplatFrame frame_of(const SplatNode& parent) {
  return {axes_of(parent.rotation),
          {scale_of(parent.scales[0]), scale_of(parent.scales[1]), scale_of(parent.scales[2])}};
}

glm::vec4 turned(const glm::vec4& p, const std::array<int, 3>& turn, const std::array<double, 3>& steps) {
  const double x = turn[0] * steps[0], y = turn[1] * steps[1], z = turn[2] * steps[2];
  const double square = x * x + y * y + z * z;
  const double w = square < 1 ? std::sqrt(1 - square) : 0;
  const double px = p.x, py = p.y, pz = p.z, pw = p.w;
  const double rx = pw * x + px * w + py * z - pz * y, ry = pw * y - px * z + py * w + pz * x,
               rz = pw * z + px * y - py * x + pz * w, rw = pw * w - px * x - py * y - pz * z;
  const double length = std::sqrt(rx * rx + ry * ry + rz * rz + rw * rw);
  return {static_cast<float>(rx / length), static_cast<float>(ry / length), static_cast<float>(rz / length),
          static_cast<float>(rw / length)};
}

std::array<double, 3> place_spread(const SplatFrame& parent, const SplatAxes& own, const SplatSteps& steps) {
  const SplatAxes& frame = parent.axes;
  std::array<double, 3> spread{};
  for (std::size_t k = 0; k < 3; ++k) {
    double variance = 0;
    for (std::size_t j = 0; j < 3; ++j) {
      const double along =
          (own[k][0] * frame[j][0] + own[k][1] * frame[j][1] + own[k][2] * frame[j][2]) * parent.scales[j];
      variance += along * along;
    }
    spread[k] = std::sqrt(variance) / steps.place[k];
  }
  return spread;
}

glm::dvec3 rgb_of(const std::array<int, 3>& code, double step) {
  const double y = code[0] * step, orange = code[1] * step, green = code[2] * step;
  return {y + orange - green, y + green, y - orange - green};
}

std::array<int, 3> color_code(const glm::dvec3& rgb, double step) {
  const std::array<double, 3> parts{(rgb.x + 2 * rgb.y + rgb.z) / 4, (rgb.x - rgb.z) / 2,
                                    (2 * rgb.y - rgb.x - rgb.z) / 4};
  std::array<int, 3> code{};
  for (std::size_t k = 0; k < 3; ++k) {
    const double number = std::nearbyint(parts[k] / step);
    code[k] = static_cast<int>(std::clamp(number, -double{kMostColor}, double{kMostColor}));
  }
  return code;
}

SplatNode node_of(const SplatNode& parent, const SplatCode& code, const SplatShape& shape, const Precision& precision) {
  SplatNode node;
  node.rotation = shape.rotation;
  for (int i = 0; i < 3; ++i) {
    double at = parent.position[i];
    for (std::size_t k = 0; k < 3; ++k)
      at += shape.axes[k][static_cast<std::size_t>(i)] * (code.place[k] * shape.steps.place[k]);
    node.position[i] = std::clamp(static_cast<float>(at), precision.box.lower[i], precision.box.upper[i]);
  }
  for (std::size_t k = 0; k < 3; ++k) node.scales[k] = static_cast<std::int16_t>(code.scales[k]);
  node.opacity = static_cast<std::uint8_t>(code.opacity);
  node.leaf = code.leaf;
  for (std::size_t k = 0; k < 4; ++k) node.fine[k] = static_cast<std::uint8_t>(code.fine[k]);
  const glm::dvec3 change = rgb_of(code.color, shape.steps.color);
  for (int i = 0; i < 3; ++i) node.color[i] = static_cast<float>(parent.color[i] + change[i]);
  return node;
}

}  // namespace gs::qnv::gaussians
