#include "qnv/codecs/gaussians/fit/gaussian_fit.h"

#include "qnv/codecs/gaussians/ellipsoid.h"

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace gs::qnv::gaussians {
namespace {

// Pixels along the edge of a picture per square root of the number of Gaussians. Maximum factor of the reduction.
constexpr float kFitDetail = 2.5f;
constexpr int kMostReduction = 16;
// Rounds times the square root of the number of Gaussians. In larger levels, a round gains less and costs more.
constexpr float kFitRounds = 6600;
constexpr int kLeastRounds = 24, kMostRounds = 160;
// Decay of the mean gradient and of the mean square in a round in which a Gaussian is visible.
constexpr float kMeanDecay = 0.9f, kSquareDecay = 0.98f;
// Gradients below this share of the root mean square of all Gaussians count less.
constexpr float kFitDamping = 0.3f;
// When a Gaussian moves, a thin axis counts with this share of the largest deviation.
constexpr float kThinnest = 0.125f;
constexpr float kLeastLogit = -5, kMostLogit = 5, kMostStart = 0.98f, kLeastStart = 0.004f;
// Gaussians that a thread changes at a time.
constexpr std::size_t kStepRange = 512;

/// Kinds of parameters, and their steps. Positions and turns relate to the axes of the Gaussian. Units: standard
/// deviations, logarithms of scales, radians, logits of opacities, colours.
enum FitKind : std::size_t { kFitMove, kFitScale, kFitTurn, kFitOpacity, kFitColor, kFitKinds };
constexpr std::array<float, kFitKinds> kFitSteps{0.04f, 0.08f, 0.015f, 0.08f, 0.02f};
constexpr std::size_t kParameters = 13;
constexpr std::array<std::size_t, kParameters> kKindOf{kFitMove,  kFitMove,  kFitMove, kFitScale, kFitScale,
                                                       kFitScale, kFitTurn,  kFitTurn, kFitTurn,  kFitOpacity,
                                                       kFitColor, kFitColor, kFitColor};
using FitStep = std::array<float, kParameters>;
using KindSquares = std::array<double, kFitKinds>;

/// Gaussian that changes, with the state of its descent.
struct FreeGaussian {
  glm::vec3 scales{0};
  glm::quat rotation{1, 0, 0, 0};
  float logit = 0;
  FitStep gradient{}, mean{}, square{};
  float mean_share = 1, square_share = 1;  // weights of the initial zeros in the means
};

void set_covariance(FitGaussian& one, const glm::mat3& axes, const glm::vec3& scales) {
  one.covariance = {};
  for (int k = 0; k < 3; ++k) {
    const glm::vec3 axis = axes[k] * scales[k];
    one.covariance[0] += axis.x * axis.x;
    one.covariance[1] += axis.x * axis.y;
    one.covariance[2] += axis.x * axis.z;
    one.covariance[3] += axis.y * axis.y;
    one.covariance[4] += axis.y * axis.z;
    one.covariance[5] += axis.z * axis.z;
  }
}

float opacity_of_logit(float logit) { return 1 / (1 + std::exp(-logit)); }

glm::vec3 moving_scales(const glm::vec3& scales) {
  return glm::max(scales, glm::vec3(kThinnest * std::max({scales.x, scales.y, scales.z})));
}

/// Descent of the Gaussians of one level.
class Descent {
 public:
  Descent(std::vector<FitGaussian>& gaussians, std::span<const std::uint32_t> indices, float detail, unsigned threads)
      : gaussians_(gaussians), indices_(indices), threads_(threads), free_(indices.size()) {
    for_ranges([&](std::size_t, std::size_t i) {
      FitGaussian& one = gaussians_[indices_[i]];
      const Ellipsoid shape = ellipsoid_of(one.covariance);
      FreeGaussian& own = free_[i];
      own.scales = glm::max(shape.scales, glm::vec3(detail));
      own.rotation = glm::quat_cast(shape.axes);
      const float opacity = std::clamp(one.opacity, kLeastStart, kMostStart);
      own.logit = std::log(opacity / (1 - opacity));
      one.opacity = opacity;
      set_covariance(one, shape.axes, own.scales);
    });
  }

  /// Changes the visible Gaussians against the gradient, by `share` of the full steps.
  void step(const std::vector<FitGradient>& gradient, float share) {
    std::vector<KindSquares> squares(ranges());
    std::vector<std::size_t> visible(ranges());
    for_ranges([&](std::size_t range, std::size_t i) {
      const FitGradient& by = gradient[indices_[i]];
      if (!by.visible) return;
      set_gradient(free_[i], by);
      ++visible[range];
      for (std::size_t k = 0; k < kParameters; ++k)
        squares[range][kKindOf[k]] += double{free_[i].gradient[k]} * free_[i].gradient[k];
    });
    // Adds in a fixed order, so that results do not depend on threads.
    KindSquares sums{};
    double count = 1;
    for (std::size_t range = 0; range < ranges(); ++range) {
      count += static_cast<double>(visible[range]);
      for (std::size_t kind = 0; kind < kFitKinds; ++kind) sums[kind] += squares[range][kind];
    }
    std::array<float, kFitKinds> damping{};
    for (std::size_t kind = 0; kind < kFitKinds; ++kind) {
      const double per = kind == kFitOpacity ? 1 : 3;
      damping[kind] = kFitDamping * static_cast<float>(std::sqrt(sums[kind] / (per * count))) + 1e-30f;
    }
    for_ranges([&](std::size_t, std::size_t i) {
      if (gradient[indices_[i]].visible) change(free_[i], gaussians_[indices_[i]], damping, share);
    });
  }

 private:
  [[nodiscard]] std::size_t ranges() const { return (free_.size() + kStepRange - 1) / kStepRange; }

  /// Calls work(range, i) for all free Gaussians.
  template <class Work>
  void for_ranges(const Work& work) {
    (void)parallel_for(
        ranges(),
        [&](std::size_t range) {
          for (std::size_t i = range * kStepRange; i < std::min(free_.size(), (range + 1) * kStepRange); ++i)
            work(range, i);
        },
        threads_);
  }

  static void set_gradient(FreeGaussian& own, const FitGradient& by) {
    const glm::mat3 axes = glm::mat3_cast(own.rotation);
    const auto& c = by.covariance;
    const glm::mat3 turned =
        glm::transpose(axes) * glm::mat3(c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5]) * axes;
    const glm::vec3 square = own.scales * own.scales, moving = moving_scales(own.scales);
    for (int k = 0; k < 3; ++k) {
      const auto to = static_cast<std::size_t>(k);
      // A turn about an axis mixes the other two axes.
      const int p = (k + 1) % 3, q = (k + 2) % 3;
      own.gradient[to] = glm::dot(axes[k], by.mean) * moving[k];
      own.gradient[3 + to] = 2 * square[k] * turned[k][k];
      own.gradient[6 + to] = 2 * turned[p][q] * (square[p] - square[q]);
      own.gradient[10 + to] = by.color[k];
    }
    own.gradient[9] = by.opacity * (1 - opacity_of_logit(own.logit));
  }

  static void change(FreeGaussian& own, FitGaussian& one, const std::array<float, kFitKinds>& damping, float share) {
    own.mean_share *= kMeanDecay;
    own.square_share *= kSquareDecay;
    FitStep step{};
    float sum = 0;
    for (std::size_t k = 0; k < kParameters; ++k) {
      const float g = own.gradient[k];
      own.mean[k] = kMeanDecay * own.mean[k] + (1 - kMeanDecay) * g;
      own.square[k] = kSquareDecay * own.square[k] + (1 - kSquareDecay) * g * g;
      const float usual = std::sqrt(own.square[k] / (1 - own.square_share)) + damping[kKindOf[k]];
      step[k] = -share * kFitSteps[kKindOf[k]] * (own.mean[k] / (1 - own.mean_share)) / usual;
      sum += step[k];
    }
    if (!std::isfinite(sum)) return;  // a number exceeds the range of float
    const glm::mat3 axes = glm::mat3_cast(own.rotation);
    const glm::vec3 moving = moving_scales(own.scales);
    for (int k = 0; k < 3; ++k) {
      const auto from = static_cast<std::size_t>(k);
      one.mean += axes[k] * (step[from] * moving[k]);
      own.scales[k] *= std::exp(step[3 + from]);
      one.color[k] = std::max(one.color[k] + step[10 + from], 0.0f);
    }
    own.rotation = glm::normalize(own.rotation * glm::quat(1, step[6] / 2, step[7] / 2, step[8] / 2));
    own.logit = std::clamp(own.logit + step[9], kLeastLogit, kMostLogit);
    one.opacity = opacity_of_logit(own.logit);
    set_covariance(one, glm::mat3_cast(own.rotation), own.scales);
  }

  std::vector<FitGaussian>& gaussians_;
  std::span<const std::uint32_t> indices_;
  unsigned threads_;
  std::vector<FreeGaussian> free_;
};

}  // namespace

bool fit_gaussians(std::vector<FitGaussian>& gaussians, std::span<const std::uint32_t> free, const FitViews& views,
                   float detail, unsigned threads, Progress* progress) {
  if (free.empty()) return true;
  const float root = std::sqrt(static_cast<float>(gaussians.size()));
  const int factor = std::clamp(static_cast<int>(std::lround(static_cast<float>(views.side()) / (kFitDetail * root))),
                                1, kMostReduction),
            side = views.side() / factor / kFitTile * kFitTile,
            rounds = std::clamp(static_cast<int>(kFitRounds / root), kLeastRounds, kMostRounds);
  std::vector<FitCamera> cameras(views.cameras().begin(), views.cameras().end());
  for (FitCamera& camera : cameras)
    camera.tangent *= static_cast<float>(side * factor) / static_cast<float>(views.side());
  std::vector<FitPixels> targets(cameras.size());
  for (std::size_t i = 0; factor > 1 && i < targets.size(); ++i) targets[i] = views.reduced(i, side, factor);
  FitPainter painter(side, views.blur(factor), threads);
  Descent descent(gaussians, free, detail, threads);
  std::vector<FitGradient> gradient;
  for (int round = 0; round < rounds; ++round) {
    if (is_cancelled(progress)) return false;
    const std::size_t view = static_cast<std::size_t>(round) % cameras.size();
    // Targets of full size are not kept, to save memory.
    const FitPixels whole = factor > 1 ? FitPixels() : views.reduced(view, side, factor);
    (void)painter.differentiate(gaussians, cameras[view], factor > 1 ? targets[view] : whole, gradient);
    const float angle = std::numbers::pi_v<float> * static_cast<float>(round) / static_cast<float>(rounds);
    descent.step(gradient, 0.5f * (1 + std::cos(angle)));
  }
  return true;
}

}  // namespace gs::qnv::gaussians
