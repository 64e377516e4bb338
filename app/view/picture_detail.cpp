#include "app/view/picture_detail.h"

#include <algorithm>
#include <cmath>

namespace gs::app {
namespace {

constexpr double kSamplesCost = 2.7;   // usual ratio of the times with four samples and with one
constexpr double kFinerMargin = 0.9;   // pictures of the next finer level must take less than this fraction of the goal
constexpr double kFarTooLong = 3;      // multiple of the goal; one picture above it suffices to choose a coarser level
constexpr double kWorth = 1.1;         // min ratio of times that makes a coarser level useful
constexpr double kWeight = 0.3;        // weight of a new time in the mean
constexpr int kSlow = 3, kSteady = 8;  // pictures before a coarser and before a finer level is chosen
constexpr int kRestPictures = 150;     // pictures before a coarser level is tried again after one that saved no time
/// Fading Gaussians exceed the maximum for some pictures. Their times do not count. If the excess lasts longer, no
/// coarser Gaussians exist.
constexpr double kExcess = 1.3;
constexpr int kFadingPictures = 6;
/// Factors of the number of Gaussians: margin below the goal, bounds of one reduction, and one increase.
constexpr double kFewer = 0.85, kFewest = 0.5, kSlightlyFewer = 0.95, kMore = 1.25;
constexpr double kLeastPictureShare = 0.4;  // fraction of the goal that a picture always has for itself
constexpr double kIdle = 0.65;              // fraction of the goal below which more Gaussians are drawn
constexpr double kUsed = 0.75;              // fraction of the maximum above which the maximum limits a picture
/// Decoding for views at rest: seconds for the smallest amount, maximum doublings of it, and maximum amounts.
constexpr double kAmountSeconds = 0.02;
constexpr unsigned kMostDoublings = 5;
constexpr double kMostAmounts = std::size_t{1} << kMostDoublings;
constexpr std::size_t kHalving = 4;  // levels that a cancelled picture loses: more than half of its pixels
constexpr std::size_t kLast = PictureDetail::kQualities.size() - 1;
/// coarsest level for pictures that are late but complete; only cancelled pictures need a coarser one
constexpr std::size_t kCoarsestComplete = 6;
static_assert(PictureDetail::kQualities[kCoarsestComplete].coarseness == 2);

/// Returns the usual time of a picture at a level, relative to one sample at full resolution.
double usual_cost(std::size_t level) {
  const PictureQuality& quality = PictureDetail::kQualities[level];
  return (quality.one_sample ? 1 : kSamplesCost) / (double{quality.coarseness} * double{quality.coarseness});
}

}  // namespace

/// Returns the maximum time of a frame. Exceeds kGoal if other work leaves too little for the picture.
double PictureDetail::goal() const { return std::max(kGoal, other_ + kLeastPictureShare * kGoal); }

void PictureDetail::choose(std::size_t level) {
  former_ = level_;
  former_mean_ = mean_;
  level_ = level;
  pictures_ = 0;
}

/// Compares the times before and after the last change of the level. Returns to the former level if a coarser one
/// saves no time, because the time does not depend on the pixels. Keeps it while fewer Gaussians can still save time.
void PictureDetail::learn(std::size_t gaussians) {
  const std::size_t low = std::min(former_, level_), high = std::max(former_, level_);
  const double finer = former_ < level_ ? former_mean_ : mean_, coarser = former_ < level_ ? mean_ : former_mean_;
  const double step = std::pow(finer / std::max(coarser, 1e-9), 1.0 / static_cast<double>(high - low));
  for (std::size_t level = low + 1; level <= high; ++level) growth_[level] = std::max(step, 1.0);
  const bool useless = former_ < level_ && finer < kWorth * coarser && (excess_ > 0 || gaussians <= kFewestGaussians);
  if (useless) choose(former_);
  if (useless) resting_ = kRestPictures;
  former_ = level_;
}

/// Reduces the number of Gaussians after slow pictures. Returns false if that is impossible.
bool PictureDetail::draw_fewer(std::size_t level, std::size_t gaussians) {
  const std::size_t now = std::min(gaussians, most_gaussians_);
  if (level == 0 || excess_ > 0 || now <= kFewestGaussians) return false;
  const double factor =
      std::clamp((kFewer * goal() - other_) / std::max(mean_ - other_, 1e-9), kFewest, kSlightlyFewer);
  most_gaussians_ = std::max(kFewestGaussians, static_cast<std::size_t>(static_cast<double>(now) * factor));
  pictures_ = 0;
  return true;
}

std::size_t PictureDetail::decoded_amounts(unsigned rests) const {
  if (rests == 0) return 1;
  // The first picture takes kRestGoal. Later ones decode as long as they draw, because each draws all Gaussians again.
  const double doubled = static_cast<double>(std::size_t{1} << std::min(rests, kMostDoublings));
  const double seconds = rests == 1 ? kRestGoal - rest_seconds_ : rest_seconds_;
  return static_cast<std::size_t>(std::clamp(seconds / kAmountSeconds, doubled, kMostAmounts));
}

void PictureDetail::note(std::size_t level, bool given_up, double seconds, std::size_t gaussians,
                         double other_seconds) {
  if (level == 0) rest_seconds_ = given_up ? std::max(rest_seconds_, seconds) : seconds;
  if (given_up) {
    if (level + kHalving <= level_ || level_ == kLast) return;
    choose(std::min(level + kHalving, kLast));
    former_ = level_;  // the time of the finer picture is unknown
    return;
  }
  if (level != level_) return;
  const auto most = static_cast<double>(most_gaussians_);
  excess_ = level > 0 && static_cast<double>(gaussians) > kExcess * most ? excess_ + 1 : 0;
  if (excess_ > 0 && excess_ <= kFadingPictures) return;
  mean_ = pictures_ == 0 ? seconds : mean_ + kWeight * (seconds - mean_);
  other_ = pictures_ == 0 ? other_seconds : other_ + kWeight * (other_seconds - other_);
  ++pictures_;
  resting_ = std::max(resting_ - 1, 0);
  if (former_ != level_ && pictures_ == kSlow) return learn(gaussians);
  if (mean_ > goal()) {
    const bool sure = pictures_ >= kSlow || seconds > kFarTooLong * goal();
    if (!sure || draw_fewer(level, gaussians) || level >= kCoarsestComplete || resting_ > 0) return;
    std::size_t coarser = level + 1;
    const bool thins = level == 0 && gaussians > most_gaussians_;  // the next level has fewer Gaussians
    while (!thins && coarser < kCoarsestComplete && mean_ * usual_cost(coarser) > goal() * usual_cost(level)) ++coarser;
    return choose(coarser);
  }
  if (level == 0 || pictures_ < kSteady) return;
  const double growth = growth_[level] > 0 ? growth_[level] : usual_cost(level - 1) / usual_cost(level);
  if (mean_ * growth < kFinerMargin * goal()) return choose(level - 1);
  if (mean_ > kIdle * goal() || static_cast<double>(gaussians) < kUsed * most) return;
  most_gaussians_ = std::min(kMostGaussians, static_cast<std::size_t>(most * kMore));
  pictures_ = 0;
}

}  // namespace gs::app
