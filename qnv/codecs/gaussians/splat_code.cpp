#include "qnv/codecs/gaussians/splat_code.h"

#include "qnv/base/kernel_pragmas.inc"

#include <algorithm>
#include <bit>
#include <cmath>

namespace gs::qnv::gaussians {
namespace {

// Steps of the most important Gaussians: places in standard deviations, turns of lines twice as long as wide, colours.
constexpr double kPlaceStep = 0.1, kTurnStep = 0.18;
// Largest factor of the steps of places and turns of less important Gaussians.
constexpr double kMostPlaceFactor = 2;
/// Steps that differ between the codings.
struct CodingSteps {
  double color;      // of the most important Gaussians
  int most_less;     // log2 of the largest factor of the steps of colours of less important ones, in eighths
  double inner;      // factor of the steps of Gaussians that children replace
  double harmonics;  // step of harmonics, relative to that of the colour
};
constexpr CodingSteps kUntrainedSteps{1.0 / 128, 2 * kScaleSteps, 3, 2};
constexpr CodingSteps kTrainedSteps{1.0 / 90, kScaleSteps, 4, 1.4};
constexpr const CodingSteps& coding_steps(bool trained) { return trained ? kTrainedSteps : kUntrainedSteps; }

// Thin axes count as having an eighth of the largest deviation.
constexpr int kThinScales = 3 * kScaleSteps;
constexpr double kLeastTurnStep = 0.01, kMostTurnStep = 0.35;

/// 2^(i/8)
constexpr std::array<double, 8> kEighths = {1,
                                            1.0905077326652577,
                                            1.189207115002721,
                                            1.2968395546510096,
                                            1.4142135623730951,
                                            1.5422108254079407,
                                            1.681792830507429,
                                            1.8340080864093424};

/// Returns 2^(eighths/8), for results that are normal numbers.
constexpr double power_of(int eighths) {
  constexpr int kShift = 100;  // octaves, so that the division rounds down
  const int octave = (eighths + kShift * kScaleSteps) / kScaleSteps - kShift;
  const auto place = static_cast<std::size_t>(eighths - octave * kScaleSteps);
  // 2^octave: the exponent of a double has an offset of 1023 and follows 52 bits.
  return kEighths[place] * std::bit_cast<double>(static_cast<std::uint64_t>(1023 + octave) << 52);
}

/// Returns power_of() for `count` consecutive exponents from `first` on.
template <std::size_t count>
constexpr std::array<double, count> powers_from(int first) {
  std::array<double, count> all{};
  for (std::size_t i = 0; i < count; ++i) all[i] = power_of(first + static_cast<int>(i));
  return all;
}
constexpr auto kScales = powers_from<kMostScale + 1>(kLeastOctave * kScaleSteps);

/// Returns the middle of a part of a step. A step reaches from -0.5 to 0.5, and has 2^bits parts.
double offset_of(int part, int bits) { return (part + 0.5) / (1 << bits) - 0.5; }

/// Returns the part of a step that contains an offset.
int part_of(double offset, int bits) {
  const int parts = 1 << bits;
  return static_cast<int>(std::clamp(std::floor((offset + 0.5) * parts), 0.0, static_cast<double>(parts - 1)));
}

/// Divisors of the steps of turns, by the ratio of the scales in the plane of the turn, in eighths of an octave.
constexpr int kMostRatio = 40;
constexpr auto kTurnDivisors = [] {
  std::array<double, kMostRatio + 1> all{};
  for (int i = 0; i <= kMostRatio; ++i) {
    const double ratio = power_of(i);
    all[static_cast<std::size_t>(i)] = ratio - 1 / ratio + 0.05;
  }
  return all;
}();

/// log2 of opacities in eighths, rounded down, by code; at least -48.
constexpr auto kFaint = [] {
  std::array<int, kMostOpacity + 1> all{};
  for (int code = 0; code <= kMostOpacity; ++code) {
    int& faint = all[static_cast<std::size_t>(code)];
    while (faint > -6 * kScaleSteps && static_cast<double>(code) / kMostOpacity < power_of(faint)) --faint;
  }
  return all;
}();

}  // namespace

SplatErrors splat_errors(int steps, bool trained, int fine) {
  const CodingSteps& coding = coding_steps(trained);
  // The three components of a colour add up.
  const double color = 1.5 * coding.color * power_of(steps), place = kPlaceStep / 2 * power_of(steps);
  return {{place, place * kMostPlaceFactor},
          {color, color * power_of(coding.most_less)},
          std::exp2(0.5 / (kScaleSteps << fine)) - 1,
          1.0 / (kMostOpacity << fine)};  // of splats below half a step, which keep the least opacity
}

double harmonic_factor(bool trained) { return coding_steps(trained).harmonics; }

double scale_of(int code) { return kScales[static_cast<std::size_t>(code)]; }

int scale_code(double scale) {
  if (!(scale > 0)) return 0;
  const double steps = (std::log2(scale) - kLeastOctave) * kScaleSteps;
  return static_cast<int>(std::clamp(std::nearbyint(steps), 0.0, static_cast<double>(kMostScale)));
}

int fine_bits(int steps) { return std::clamp((kScaleSteps / 2 - steps) / kScaleSteps, 0, GaussianCoding::kMostFine); }

double scale_of(const SplatNode& node, std::size_t axis, int bits) {
  const double scale = scale_of(node.scales[axis]);
  return node.leaf && bits > 0 ? scale * std::exp2(offset_of(node.fine[axis], bits) / kScaleSteps) : scale;
}

double opacity_of(const SplatNode& node, int bits) {
  const double code = node.opacity + (node.leaf && bits > 0 ? offset_of(node.fine[3], bits) : 0);
  return std::min(code / kMostOpacity, 1.0);
}

int fine_scale(double scale, int code, int bits) {
  return scale > 0 ? part_of((std::log2(scale) - kLeastOctave) * kScaleSteps - code, bits) : 0;
}

int fine_opacity(double opacity, int code, int bits) { return part_of(opacity * kMostOpacity - code, bits); }

double opacity_of(int code) { return static_cast<double>(code) / kMostOpacity; }

int opacity_code(double opacity) {
  return static_cast<int>(std::clamp(std::nearbyint(opacity * kMostOpacity), 1.0, static_cast<double>(kMostOpacity)));
}

int importance(const std::array<int, 3>& scales, int opacity) {
  return scales[0] + scales[1] + 2 * kFaint[static_cast<std::size_t>(opacity)];
}

SplatSteps steps_of(const SplatCode& code, const Precision& precision) {
  SplatSteps steps{};
  const int less = (precision.important - importance(code.scales, code.opacity)) / 2;
  const CodingSteps& coding = coding_steps(precision.trained);
  const double factor = power_of(std::clamp(less, 0, coding.most_less));
  const double inner = (code.leaf ? 1 : coding.inner) * power_of(precision.steps);
  const double fine = inner * std::min(factor, kMostPlaceFactor);
  for (std::size_t k = 0; k < 3; ++k) {
    const int scale = std::max({code.scales[k], code.scales[0] - kThinScales, precision.finest});
    steps.place[k] = kPlaceStep * fine * scale_of(scale);
    // Turns about an axis exchange the other two.
    const int a = code.scales[(k + 1) % 3], b = code.scales[(k + 2) % 3];
    const int ratio = std::clamp(std::max(a, b) - std::max(std::min(a, b), precision.finest), 0, kMostRatio);
    steps.turn[k] =
        std::clamp(kTurnStep * fine / kTurnDivisors[static_cast<std::size_t>(ratio)], kLeastTurnStep, kMostTurnStep);
  }
  steps.color = coding.color * inner * factor;
  return steps;
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
