#include "app/media/wave_file.h"

#include <algorithm>
#include <cmath>
#include <string_view>

namespace gs::app {

void WaveFile::add(std::span<const float> pairs) {
  constexpr auto kMax = static_cast<std::size_t>(kLongest * kMixRate * 2);
  for (const float value : pairs.first(std::min(pairs.size(), kMax - std::min(kMax, samples_.size()))))
    samples_.push_back(static_cast<std::int16_t>(std::lround(std::clamp(value, -1.0f, 1.0f) * 32767)));
}

std::vector<std::byte> WaveFile::bytes() const {
  constexpr std::uint32_t kChannels = 2, kSample = 2, kFormat = 16, kHead = 36;
  const auto size = static_cast<std::uint32_t>(samples_.size() * kSample);
  std::vector<std::byte> bytes;
  bytes.reserve(size + kHead + 8);
  const auto text = [&](std::string_view letters) {
    for (const char letter : letters) bytes.push_back(static_cast<std::byte>(letter));
  };
  const auto number = [&](std::uint32_t value, int count) {
    for (int i = 0; i < count; ++i) bytes.push_back(static_cast<std::byte>(value >> (8 * i)));
  };
  text("RIFF");
  number(kHead + size, 4);
  text("WAVEfmt ");
  number(kFormat, 4);
  number(1, 2);  // PCM
  number(kChannels, 2);
  number(kMixRate, 4);
  number(kMixRate * kChannels * kSample, 4);
  number(kChannels * kSample, 2);
  number(8 * kSample, 2);
  text("data");
  number(size, 4);
  for (const std::int16_t sample : samples_) number(static_cast<std::uint16_t>(sample), 2);
  return bytes;
}

}  // namespace gs::app
