#include "qnv/codecs/gaussians/splat_steps.h"

#include "qnv/codecs/gaussians/power.h"

#include "qnv/base/kernel_pragmas.inc"

#include <algorithm>
#include <cmath>

namespace gs::qnv::gaussians {
namespace {

using Version = GaussianCoding::Version;

// Steps of the most important Gaussians: places in standard deviations, turns before the division by kTurnDivisors.
constexpr double kPlaceStep = 0.1, kTurnStep = 0.18;
// log2 of the largest factor of the steps of places and turns of less important Gaussians, in eighths.
constexpr int kMostPlaceLess = kScaleSteps;
/// Steps that differ between the versions.
struct CodingSteps {
  double color;      // of the most important Gaussians
  int most_less;     // log2 of the largest factor of the steps of colours of less important ones, in eighths
  double inner;      // factor of the steps of Gaussians that children replace
  double harmonics;  // step of harmonics, relative to that of the colour
};
constexpr CodingSteps kPlainSteps{1.0 / 128, 2 * kScaleSteps, 3, 2};
constexpr CodingSteps kTrainedSteps{1.0 / 90, kScaleSteps, 4, 1.4};
constexpr const CodingSteps& coding_steps(bool trained) { return trained ? kTrainedSteps : kPlainSteps; }

/// Steps of the leaves of tuned streams, as log2 of factors in eighths.
struct LeafSteps {
  int place, turn, color;    // of kPlaceStep, kTurnStep and the colour of trained streams
  int scale, opacity;        // of a code
  int most_more, most_less;  // limits for more and for less important leaves
  int lift;                  // share of the gap to the next scale, in eighths, by which thin axes count as wider
  int thin;                  // share of this gap, in eighths, by which the steps of the smallest scale are larger
  int floor;                 // importance() counts smaller axes as Precision::finest times this factor
};
constexpr LeafSteps kLeafSteps{-2, -6, 8, 8, 3, 8, 16, 3, 11, 28};
// The basis functions of degree 1 to 3 have a mean square of 1 / 4 pi. With this step, the error of a coefficient is as
// visible as that of a colour.
constexpr double kTunedHarmonics = 3.5;
constexpr int kMostFineBits = 8;

// Thin axes count as having an eighth of the largest deviation.
constexpr int kThinScales = 3 * kScaleSteps;
constexpr double kLeastTurnStep = 0.01, kLeastTunedTurnStep = 0.0005, kMostTurnStep = 0.35;

/// Returns the middle of a part of the unit interval, which has 2^bits parts.
double middle_of(int part, int bits) { return (part + 0.5) / (1 << bits); }

/// Returns the part of the unit interval that contains a point. The interval has 2^bits parts.
int part_of(double at, int bits) {
  const int parts = 1 << bits;
  return static_cast<int>(std::clamp(std::floor(at * parts), 0.0, static_cast<double>(parts - 1)));
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

/// Compares the importance of a Gaussian with that of Gaussians with usual steps. Returns log2 of the root of the
/// ratio, in eighths; positive if the Gaussian is less important.
int less_important(const SplatCode& code, const Precision& precision) {
  return (precision.important - importance(code.scales, code.opacity, precision)) / 2;
}

/// Returns the number of bits that divide a width into parts of about a step. Both arguments are log2, in eighths.
int bits_for(int width, int step) {
  constexpr int kShift = 100;  // octaves, so that the division rounds down
  return std::clamp((width - step + kScaleSteps / 2 + kShift * kScaleSteps) / kScaleSteps - kShift, 0, kMostFineBits);
}

/// Returns the shortest standard deviation of a leaf of a tuned stream.
double thin_scale(const SplatNode& node, int bits) {
  const GapCell cell = cell_of_gap(node.scales[1] - node.scales[2]);
  const double gap = cell.lower - 0.5 + cell.width * middle_of(node.fine[2], bits);
  return scale_of(node.scales[1]) * std::exp2(-gap / kScaleSteps);
}

SplatSteps leaf_steps(const SplatCode& code, const Precision& precision) {
  SplatSteps steps{};
  const int less = std::clamp(less_important(code, precision), -kLeafSteps.most_more, kLeafSteps.most_less);
  const int all = precision.steps + less;
  // In the mean of all views, the width across a thin axis lies between its own deviation and that of the next axis.
  const int lift = (code.scales[1] - code.scales[2]) * kLeafSteps.lift / kScaleSteps;
  for (std::size_t k = 0; k < 3; ++k) {
    const int own = code.scales[k] + (k == 2 ? lift : 0);
    const int scale = std::max({own, code.scales[0] - kThinScales, precision.finest});
    steps.place[k] = kPlaceStep * power_of(all + kLeafSteps.place) * scale_of(scale);
    // Turns about an axis exchange the other two.
    const int a = code.scales[(k + 1) % 3], b = code.scales[(k + 2) % 3];
    const int ratio = std::clamp(std::max(a, b) - std::max(std::min(a, b), precision.finest), 0, kMostRatio);
    const int wider = k == 2 ? 0 : std::min(lift, ratio);
    steps.turn[k] =
        std::clamp(kTurnStep * power_of(all + kLeafSteps.turn + wider) / kTurnDivisors[static_cast<std::size_t>(ratio)],
                   kLeastTunedTurnStep, kMostTurnStep);
  }
  steps.color = kTrainedSteps.color * power_of(all + kLeafSteps.color);
  return steps;
}

}  // namespace

SplatErrors splat_errors(const GaussianCoding& coding) {
  const bool tuned = coding.version == Version::tuned;
  const CodingSteps& own = coding_steps(coding.version != Version::plain);
  const LeafSteps leaf = tuned ? kLeafSteps : LeafSteps{};
  const auto fine_error = [](double cell, int bits) { return std::exp2(0.5 * cell / (kScaleSteps << bits)) - 1; };
  SplatErrors errors{};
  for (std::size_t i = 0; i < 2; ++i) {
    const int less = i == 0 ? 0 : tuned ? leaf.most_less : kMostPlaceLess, all = coding.steps + less;
    errors.place[i] = kPlaceStep / 2 * power_of(all + leaf.place);
    // The three components of a colour add up.
    errors.color[i] = 1.5 * own.color * power_of(tuned || i == 0 ? all + leaf.color : coding.steps + own.most_less);
    const int scale = tuned ? bits_for(0, all + leaf.scale) : coding.fine;
    errors.scale[i] = errors.thin[i] = fine_error(1, scale);
    errors.opacity[i] = 1.0 / (kMostOpacity << (tuned ? bits_for(0, all + leaf.opacity) : coding.fine));
  }
  if (tuned) errors.thin[1] = fine_error(cell_of_gap(kMostScale).width, 0);
  return errors;
}

SplatErrors splat_errors(int steps) {
  GaussianCoding coding;
  coding.version = Version::tuned;
  coding.steps = steps;
  return splat_errors(coding);
}

Precision precision_of(const GaussianCoding& coding, const Box& box) {
  return {coding.important, coding.finest, coding.steps, box, coding.version, coding.fine};
}

double harmonic_factor(const Precision& precision) {
  return precision.tuned() ? kTunedHarmonics : coding_steps(precision.trained()).harmonics;
}

int importance(const std::array<int, 3>& scales, int opacity, const Precision& precision) {
  // Renderers draw a tiny splat as large as a pixel.
  const int least = precision.tuned() ? precision.finest + kLeafSteps.floor : 0;
  return std::max(scales[0], least) + std::max(scales[1], least) + 2 * kFaint[static_cast<std::size_t>(opacity)];
}

SplatSteps steps_of(const SplatCode& code, const Precision& precision) {
  if (precision.tuned() && code.leaf) return leaf_steps(code, precision);
  SplatSteps steps{};
  const CodingSteps& coding = coding_steps(precision.trained());
  const double factor = power_of(std::clamp(less_important(code, precision), 0, coding.most_less));
  // Only leaves of tuned streams get finer steps, because they replace all other Gaussians of a complete stream.
  const double inner =
      (code.leaf ? 1 : coding.inner) * power_of(precision.tuned() ? std::max(precision.steps, 0) : precision.steps);
  const double fine = inner * std::min(factor, power_of(kMostPlaceLess));
  for (std::size_t k = 0; k < 3; ++k) {
    const int scale = std::max({code.scales[k], code.scales[0] - kThinScales, precision.finest});
    steps.place[k] = kPlaceStep * fine * scale_of(scale);
    const int a = code.scales[(k + 1) % 3], b = code.scales[(k + 2) % 3];
    const int ratio = std::clamp(std::max(a, b) - std::max(std::min(a, b), precision.finest), 0, kMostRatio);
    steps.turn[k] =
        std::clamp(kTurnStep * fine / kTurnDivisors[static_cast<std::size_t>(ratio)], kLeastTurnStep, kMostTurnStep);
  }
  steps.color = coding.color * inner * factor;
  return steps;
}

GapCell gap_cell(int index) {
  if (index < 4) return {index, 1};
  if (index < 6) return {4 + 2 * (index - 4), 2};
  if (index < 8) return {8 + 4 * (index - 6), 4};
  return {16 + 8 * (index - 8), 8};
}

int cell_index(int gap) {
  if (gap < 4) return gap;
  if (gap < 8) return 4 + (gap - 4) / 2;
  if (gap < 16) return 6 + (gap - 8) / 4;
  return 8 + (gap - 16) / 8;
}

GapCell cell_of_gap(int gap) { return gap_cell(cell_index(gap)); }

int thinned(int middle_scale, int least_scale, bool leaf) {
  const int coarse = leaf ? 0 : 1;
  return std::max(middle_scale - (cell_of_gap((middle_scale - least_scale) >> coarse).middle() << coarse), 0);
}

FineBits fine_bits(const SplatCode& code, const Precision& precision) {
  if (!precision.tuned()) return {precision.fine, precision.fine, precision.fine, precision.fine};
  const int less = less_important(code, precision);
  const auto step = [&](int more) {
    return precision.steps + std::clamp(less + more, -kLeafSteps.most_more, kLeafSteps.most_less);
  };
  const int gap = code.scales[1] - code.scales[2], scale = step(0) + kLeafSteps.scale;
  int width = 0;  // log2 of the width of the cell, in eighths
  for (int left = cell_of_gap(gap).width; left > 1; left /= 2) width += kScaleSteps;
  const int wide = bits_for(0, scale), thin = bits_for(width, scale + gap * kLeafSteps.thin / kScaleSteps);
  // The opacities of faint Gaussians matter as much as those of others with the same area.
  const int faint = kFaint[static_cast<std::size_t>(code.opacity)];
  return {wide, wide, thin, bits_for(0, step(faint) + kLeafSteps.opacity)};
}

std::array<int, 4> fine_codes(const SplatCode& code, const std::array<double, 3>& scales, double opacity,
                              const Precision& precision) {
  const FineBits bits = fine_bits(code, precision);
  std::array<int, 4> fine{};
  const auto exponent = [&](std::size_t k) { return (std::log2(scales[k]) - kLeastOctave) * kScaleSteps; };
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(scales[k] > 0)) continue;
    if (k < 2 || !precision.tuned()) {
      fine[k] = part_of(exponent(k) - code.scales[k] + 0.5, bits[k]);
    } else {
      const GapCell cell = cell_of_gap(code.scales[1] - code.scales[2]);
      fine[k] = part_of((code.scales[1] - exponent(k) - cell.lower + 0.5) / cell.width, bits[k]);
    }
  }
  fine[3] = part_of(opacity * kMostOpacity - code.opacity + 0.5, bits[3]);
  return fine;
}

SplatLook look_of(const SplatNode& node, const Precision& precision) {
  SplatLook look{};
  for (std::size_t k = 0; k < 3; ++k) look.scales[k] = scale_of(node.scales[k]);
  double opacity = node.opacity;
  SplatCode code;
  for (std::size_t k = 0; k < 3; ++k) code.scales[k] = node.scales[k];
  code.opacity = node.opacity;
  const FineBits bits = node.leaf ? fine_bits(code, precision) : FineBits{};
  for (std::size_t k = 0; k < 3; ++k)
    if (bits[k] > 0) look.scales[k] *= std::exp2((middle_of(node.fine[k], bits[k]) - 0.5) / kScaleSteps);
  if (bits[3] > 0) opacity += middle_of(node.fine[3], bits[3]) - 0.5;
  if (node.leaf && precision.tuned()) look.scales[2] = thin_scale(node, bits[2]);
  look.opacity = std::min(opacity / kMostOpacity, 1.0);
  return look;
}

}  // namespace gs::qnv::gaussians
