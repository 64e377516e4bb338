#include "app/media/mixer.h"

#include <glm/gtc/constants.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

namespace gs::app {
namespace {

constexpr double kFade = 0.005;  // seconds; fade-out of a sound that ends early
constexpr double kMaxApart = 0.02;  // seconds; max drift of a sound before its position is corrected by a jump
constexpr double kNear = 0.02;  // sample pairs; tolerance that covers the rounding of times since 1970
constexpr double kFastest = 64;  // max file samples per output sample; a faster sound is not played
constexpr int kLobes = 8;  // lobes of the sinc filter on each side
constexpr int kFilterSteps = 512;  // table entries per lobe of the filter
constexpr double kNever = std::numeric_limits<double>::infinity();

/// Windowed sinc function for resampling.
struct SincFilter {
  std::array<float, static_cast<std::size_t>(kLobes* kFilterSteps) + 2> values{};
  SincFilter() {
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double x = static_cast<double>(i) / kFilterSteps, pi = glm::pi<double>();
      if (x >= kLobes) continue;
      const double sinc = i == 0 ? 1 : i % kFilterSteps == 0 ? 0 : std::sin(pi * x) / (pi * x);
      const double window = 0.42 + 0.5 * std::cos(pi * x / kLobes) + 0.08 * std::cos(2 * pi * x / kLobes);
      values[i] = static_cast<float>(sinc * window);
    }
  }
  [[nodiscard]] float at(double x) const {
    const double place = std::abs(x) * kFilterSteps;
    const auto i = static_cast<std::size_t>(place);
    if (i >= static_cast<std::size_t>(kLobes * kFilterSteps)) return 0;
    const auto part = static_cast<float>(place - static_cast<double>(i));
    return values[i] + part * (values[i + 1] - values[i]);
  }
};

const SincFilter& sinc_filter() {
  static const SincFilter the_filter;
  return the_filter;
}

}  // namespace

struct Mixer::Playing {
  Voice voice;
  std::unique_ptr<VoiceStream> stream;  // null if the file cannot be decoded
  double place = 0;  // next position in the stream, in sample pairs
  bool placed = false;  // `place` is valid
  bool leaves = false;  // absent from the voices last set; plays until `end`
  double left = 0, right = 0;           // channel gains at the end of the last block
  bool began = false;  // `left` and `right` are valid
  double end = kNever;
  bool cut = false;  // `end` is before the natural end of the sound
};

Mixer::Mixer() = default;
Mixer::~Mixer() = default;

void Mixer::set(std::vector<Voice> voices, double now) {
  const std::lock_guard lock(mutex_);
  wanted_ = std::move(voices);
  wanted_at_ = now;
  fresh_ = true;
  sounding_ = sounding_ || !wanted_.empty();
}

void Mixer::set_gain(double gain) {
  const std::lock_guard lock(mutex_);
  gain_ = std::isfinite(gain) ? std::max(gain, 0.0) : 0;
}

bool Mixer::sounding() const {
  const std::lock_guard lock(mutex_);
  return sounding_;
}

// Replaces the playing sounds by the voices last set. A sound with an unchanged voice continues.
void Mixer::take_over() {
  std::vector<Voice> wanted;
  double now = 0;
  {
    const std::lock_guard lock(mutex_);
    if (!std::exchange(fresh_, false)) return;
    wanted = std::move(wanted_);
    now = wanted_at_;
  }
  std::vector<std::unique_ptr<Playing>> next;
  for (Voice& voice : wanted) {
    const auto known = std::find_if(playing_.begin(), playing_.end(), [&](const auto& one) {
      return one && !one->leaves && one->voice.who == voice.who && one->voice.number == voice.number &&
             one->voice.file == voice.file && one->voice.start == voice.start && one->voice.rate == voice.rate &&
             one->voice.duration == voice.duration;
    });
    std::unique_ptr<Playing> playing;
    if (known != playing_.end()) {
      playing = std::move(*known);
    } else {
      playing = std::make_unique<Playing>();
      auto reader = open_samples_confined(voice.file->encoded(), kMixRate);
      if (auto* good = std::get_if<std::unique_ptr<render::SampleReader>>(&reader))
        playing->stream =
            std::make_unique<VoiceStream>(voice.file, std::move(*good), voice.duration,
                                          voice.loop || voice.end > voice.start + voice.duration / voice.rate + 1e-6);
    }
    playing->voice = std::move(voice);
    const Voice& of = playing->voice;
    const double natural = of.duration >= 0 ? of.start + of.duration / of.rate : kNever;
    playing->end = of.end;
    playing->cut = of.end < natural || (of.loop && of.end < kNever);
    next.push_back(std::move(playing));
  }
  for (std::unique_ptr<Playing>& one : playing_) {
    if (!one) continue;
    if (!std::exchange(one->leaves, true) && one->end > now) {
      one->end = now;
      one->cut = true;
    }
    next.push_back(std::move(one));
  }
  playing_ = std::move(next);
}

void Mixer::mix_one(Playing& playing, double from, double to, std::span<float> pairs) {
  const Voice& voice = playing.voice;
  const std::size_t count = pairs.size() / 2;
  // Times since 1970 have a resolution of some tenths of a microsecond. A block of nearly the usual length is treated
  // as having exactly that length.
  constexpr double kRounding = 5e-7;
  const double usual = static_cast<double>(count) / kMixRate;
  const double a_pair = (std::abs(to - from - usual) < kRounding ? usual : to - from) / static_cast<double>(count);
  // A sound that starts now begins at its full level. A sound that started earlier fades in over this block.
  if (!playing.began && voice.start >= from - kFade) {
    playing.left = voice.left;
    playing.right = voice.right;
  }
  const double left_step = (voice.left - playing.left) / static_cast<double>(count),
               right_step = (voice.right - playing.right) / static_cast<double>(count);
  const double left_before = std::exchange(playing.left, voice.left),
               right_before = std::exchange(playing.right, voice.right);
  playing.began = true;
  const double fade = playing.cut ? kFade : 0;
  if (!playing.stream || to <= voice.start || from >= playing.end + fade) return;
  VoiceStream& stream = *playing.stream;
  const auto first = static_cast<std::size_t>(
      std::clamp(std::ceil((voice.start - from) / a_pair - kNear), 0.0, static_cast<double>(count)));
  const double time = from + static_cast<double>(first) * a_pair;
  const double step = a_pair * voice.rate * stream.rate();
  if (!(step > 0) || step > kFastest || first >= count) return;
  // Compute the position at which the stream should be. The position in a loop is compared modulo its length.
  double should = std::max(0.0, time - voice.start) * voice.rate * stream.rate();
  const auto turn = static_cast<double>(stream.length());
  if (voice.loop && turn > 0) should = std::fmod(should, turn);
  double apart = should - (voice.loop && turn > 0 ? std::fmod(playing.place, turn) : playing.place);
  if (voice.loop && turn > 0) apart -= turn * std::round(apart / turn);
  if (!playing.placed || std::abs(apart) > kMaxApart * stream.rate() * voice.rate) playing.place = should;
  // If the sample rates match, round the position to a sample of the file.
  if (std::abs(step - 1) < 1e-9 && std::abs(playing.place - std::round(playing.place)) < kNear)
    playing.place = std::round(playing.place);
  playing.placed = true;

  const double scale = std::max(1.0, step), reach = kLobes * scale;
  const auto before = static_cast<std::int64_t>(std::floor(playing.place - reach)) + 1;
  const auto behind =
      static_cast<std::int64_t>(std::floor(playing.place + step * static_cast<double>(count - first) + reach)) + 1;
  const float* const samples = stream.window(before, static_cast<std::size_t>(behind - before));
  const SincFilter& sinc = sinc_filter();
  for (std::size_t i = first; i < count; ++i) {
    const double at = playing.place + step * static_cast<double>(i - first);
    double level = 1;
    const double over = from + static_cast<double>(i) * a_pair - playing.end;
    if (over >= -1e-7) level *= fade > 0 ? std::max(0.0, 1 - over / fade) : 0;
    if (level == 0) continue;
    float left = 0, right = 0;
    const auto whole = static_cast<std::int64_t>(std::floor(at));
    if (static_cast<double>(whole) == at && scale == 1) {
      const float* pair = samples + 2 * (whole - before);
      left = pair[0];
      right = pair[1];
    } else {
      const auto low = static_cast<std::int64_t>(std::floor(at - reach)) + 1,
                 high = static_cast<std::int64_t>(std::floor(at + reach));
      for (std::int64_t k = low; k <= high; ++k) {
        const float weight = sinc.at((at - static_cast<double>(k)) / scale);
        left += weight * samples[2 * (k - before)];
        right += weight * samples[2 * (k - before) + 1];
      }
      left /= static_cast<float>(scale);
      right /= static_cast<float>(scale);
    }
    const auto part = static_cast<double>(i + 1);
    pairs[2 * i] += static_cast<float>(level * (left_before + part * left_step)) * left;
    pairs[2 * i + 1] += static_cast<float>(level * (right_before + part * right_step)) * right;
  }
  playing.place += step * static_cast<double>(count - first);
}

void Mixer::mix(double from, double to, std::span<float> pairs) {
  std::fill(pairs.begin(), pairs.end(), 0.0f);
  take_over();
  double gain = 1;
  {
    const std::lock_guard lock(mutex_);
    gain = gain_;
  }
  if (pairs.size() < 2 || !(to > from)) return;
  for (const auto& one : playing_) mix_one(*one, from, to, pairs);
  std::erase_if(playing_, [&](const auto& one) { return one->leaves && to > one->end + kFade; });
  const std::size_t count = pairs.size() / 2;
  for (std::size_t i = 0; i < count; ++i) {
    const double part = static_cast<double>(i + 1) / static_cast<double>(count);
    const auto factor = static_cast<float>(heard_gain_ + part * (gain - heard_gain_));
    for (std::size_t c = 2 * i; c < 2 * i + 2; ++c) pairs[c] = std::clamp(factor * pairs[c], -1.0f, 1.0f);
  }
  heard_gain_ = gain;
  const std::lock_guard lock(mutex_);
  sounding_ = !playing_.empty() || fresh_;
}

}  // namespace gs::app
