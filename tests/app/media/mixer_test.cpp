#include "app/media/mixer.h"

#include "app/media/sound_device.h"
#include "app/media/wave_file.h"
#include "tests/render/media/media_files.h"

#include <catch2/catch.hpp>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>
#include <thread>
#include <vector>

namespace gs::app::mixer_test {
namespace {

constexpr double kStart = 946684800;
constexpr double kNever = std::numeric_limits<double>::infinity();

std::shared_ptr<const MediaFile> file_of(const std::string& text) {
  auto file = std::make_shared<MediaFile>(media::bytes_of(text), Share());
  const auto info = render::examine_media(file->bytes());
  REQUIRE(info.index() == 0);
  file->info = std::get<0>(info);
  return file;
}

Voice voice_of(const std::shared_ptr<const MediaFile>& file, double start, double end = kNever, double rate = 1) {
  Voice voice;
  voice.who = file.get();
  voice.file = file;
  voice.start = kStart + start;
  voice.duration = file->info.duration;
  voice.loop = end == kNever;
  voice.end = voice.loop ? kNever : kStart + end;
  voice.rate = rate;
  return voice;
}

// Mixes in steps of 1/60 second.
struct Ear {
  Mixer mixer;
  std::vector<float> pairs;
  void hear(double until, double step = 1.0 / 60) {
    const auto end = static_cast<std::size_t>(std::llround(until * kMixRate));
    const auto most = static_cast<std::size_t>(std::llround(step * kMixRate));
    while (pairs.size() / 2 < end) {
      const std::size_t from = pairs.size() / 2, count = std::min(most, end - from);
      std::vector<float> piece(2 * count);
      mixer.mix(kStart + static_cast<double>(from) / kMixRate, kStart + static_cast<double>(from + count) / kMixRate,
                piece);
      pairs.insert(pairs.end(), piece.begin(), piece.end());
    }
  }
  [[nodiscard]] double left(double time) const {
    return pairs[2 * static_cast<std::size_t>(std::llround(time * kMixRate))];
  }
};

// Returns a second with sample i = i / 48000.
std::string ramp(double seconds, int rate = kMixRate) {
  return media::wav(rate, 1, static_cast<std::size_t>(seconds * rate),
                    [&](std::size_t i, int) { return static_cast<double>(i) / rate; });
}

TEST_CASE("starts a sound with its first sample at startTime, and plays the samples of the file") {
  Ear ear;
  const auto file = file_of(ramp(0.5));
  ear.mixer.set({voice_of(file, 0.1003125, 0.6003125)}, kStart);  // sample 4815
  ear.hear(1);
  bool silent = true, same = true;
  for (std::size_t i = 0; i < 4815; ++i) silent = silent && ear.pairs[2 * i] == 0;
  for (std::size_t i = 0; i < 24'000; ++i) {
    const double expected = std::lround(static_cast<double>(i) / 48'000 * 32767) / 32768.0;
    same = same && std::abs(ear.pairs[2 * (4815 + i)] - expected) < 1e-6 &&
           ear.pairs[2 * (4815 + i)] == ear.pairs[2 * (4815 + i) + 1];
  }
  for (std::size_t i = 4815 + 24'000; i < 48'000; ++i) silent = silent && ear.pairs[2 * i] == 0;
  CHECK(silent);
  CHECK(same);
}

TEST_CASE("loops in world time: t = (now - startTime) modulo (duration / pitch) (6.4)") {
  Ear ear;
  const auto file = file_of(ramp(0.5));
  ear.mixer.set({voice_of(file, -1000.2)}, kStart);
  ear.hear(2);
  for (const double time : {0.05, 0.29, 0.31, 1.0, 1.77})
    CHECK(ear.left(time) == Approx(std::fmod(time + 1000.2, 0.5)).margin(1e-3));
  // A file with another sample rate plays at twice the speed.
  Ear other;
  other.mixer.set({voice_of(file_of(ramp(0.5, 11'025)), -7.1, kNever, 2)}, kStart);
  other.hear(1);
  for (const double time : {0.1, 0.2, 0.33, 0.8})
    CHECK(other.left(time) == Approx(std::fmod((time + 7.1) * 2, 0.5)).margin(2e-3));
}

TEST_CASE("raises the tone by pitch, and keeps it for files of another sample rate (6.4)") {
  const auto crossings = [](const std::string& sound, double pitch) {
    Ear ear;
    ear.mixer.set({voice_of(file_of(sound), 0, kNever, pitch)}, kStart);
    ear.hear(1);
    int count = 0;
    double squares = 0;
    for (std::size_t i = 4800; i + 1 < 43'200; ++i) {
      if (ear.pairs[2 * i] < 0 && ear.pairs[2 * i + 2] >= 0) ++count;
      squares += ear.pairs[2 * i] * ear.pairs[2 * i];
    }
    CHECK(std::sqrt(squares / 38'400) == Approx(0.5 / std::sqrt(2.0)).margin(0.01));
    return count / 0.8;
  };
  CHECK(crossings(media::tone(4, 440, 0.5, 22'050), 1) == Approx(440).margin(3));
  CHECK(crossings(media::tone(4, 440, 0.5, 22'050), 2) == Approx(880).margin(3));
  CHECK(crossings(media::tone(4, 440), 0.5) == Approx(220).margin(3));
  CHECK(crossings(media::tone(4, 2000, 0.5, 44'100), 1.5) == Approx(3000).margin(3));
}

TEST_CASE("adds two simultaneous sounds (7.3.3)") {
  Ear ear;
  const auto one = file_of(media::constant(1, 0.25)), other = file_of(media::constant(1, 0.5));
  Voice quiet = voice_of(other, 0.5, 1.5);
  quiet.left = 0.5;
  quiet.right = 0.25;
  ear.mixer.set({voice_of(one, 0, 1), quiet}, kStart);
  ear.hear(2);
  CHECK(ear.left(0.25) == Approx(0.25).margin(1e-3));
  CHECK(ear.left(0.75) == Approx(0.5).margin(1e-3));
  CHECK(ear.pairs[2 * 36'000 + 1] == Approx(0.375).margin(1e-3));
  CHECK(ear.left(1.25) == Approx(0.25).margin(1e-3));
  CHECK(ear.left(1.75) == 0);
}

TEST_CASE("changes levels without steps, and fades out stopped sounds") {
  Ear ear;
  const auto file = file_of(media::constant(10, 0.5));
  Voice voice = voice_of(file, 0, 10);
  ear.mixer.set({voice}, kStart);
  ear.hear(0.5);
  voice.left = 0.2;
  ear.mixer.set({voice}, kStart + 0.5);
  ear.hear(1);
  CHECK(ear.left(0.49) == Approx(0.5).margin(1e-3));
  CHECK(ear.left(0.9) == Approx(0.1).margin(1e-3));
  ear.mixer.set({}, kStart + 1);  // stopped
  CHECK(ear.mixer.sounding());
  ear.hear(1.1);
  CHECK(ear.left(1.0075) == 0);
  CHECK_FALSE(ear.mixer.sounding());
  float steepest = 0;
  for (std::size_t i = 100; i + 1 < ear.pairs.size() / 2; ++i)
    steepest = std::max(steepest, std::abs(ear.pairs[2 * i + 2] - ear.pairs[2 * i]));
  CHECK(steepest < 0.01f);
  // A sound that ends by itself plays to its end, although the world no longer requests it.
  Ear other;
  other.mixer.set({voice_of(file_of(media::constant(0.05, 0.5)), 0, 0.05)}, kStart);
  other.hear(0.01);
  other.mixer.set({}, kStart + 0.06);
  other.hear(0.1);
  CHECK(other.left(0.045) == Approx(0.5).margin(1e-3));
  CHECK(other.left(0.055) == 0);
}

TEST_CASE("clips samples that are too loud, and applies mute and volume to all") {
  Ear ear;
  const auto file = file_of(media::constant(10, 0.9));
  std::vector<Voice> voices(4, voice_of(file, 0));
  for (std::size_t i = 0; i < voices.size(); ++i) voices[i].number = i;
  ear.mixer.set(voices, kStart);
  ear.hear(0.2);
  CHECK(ear.left(0.1) == 1);
  ear.mixer.set_gain(0.1);
  ear.hear(0.4);
  CHECK(ear.left(0.3) == Approx(0.36).margin(1e-3));
  ear.mixer.set_gain(0);
  ear.hear(0.6);
  CHECK(ear.left(0.5) == 0);
}

TEST_CASE("reads a sound stream at any position with little memory") {
  const auto file = file_of(ramp(0.5));
  auto reader = render::open_samples(file->bytes());
  REQUIRE(reader.index() == 0);
  VoiceStream stream(file, std::move(std::get<0>(reader)), 0.5, true);
  CHECK(stream.length() == 24'000);
  const auto at = [&](std::int64_t number) { return std::lround(stream.window(number, 1)[0] * 48'000); };
  CHECK(at(-3) == 0);
  CHECK(at(100) == Approx(100).margin(1.5));
  CHECK(at(24'010) == Approx(10).margin(1.5));
  CHECK(at(23'990) == Approx(23'990).margin(1.5));
  CHECK(at(std::int64_t{24'000} * 1'000'000 + 77) == Approx(77).margin(1.5));
}

TEST_CASE("writes a mix as a WAV that reads back") {
  WaveFile wave;
  const std::vector<float> pairs = {0, 0, 0.5f, -0.5f, 1, -1, 3, -3};
  wave.add(pairs);
  const std::vector<std::byte> bytes = wave.bytes();
  const auto samples = media::samples_of(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  REQUIRE(samples.size() == 8);
  CHECK(samples[2] == Approx(0.5).margin(1e-4));
  CHECK(samples[5] == Approx(-1).margin(1e-4));
  CHECK(samples[6] == samples[4]);
  const auto info = render::examine_media(bytes);
  REQUIRE(info.index() == 0);
  CHECK(std::get<0>(info).duration == Approx(4.0 / kMixRate));
}

// These variables select devices of OpenAL Soft. The null device consumes samples like a real device. "none" means no
// device.
TEST_CASE("runs silently without a sound device") {
  const auto state_with = [](const char* drivers) {
    setenv("ALSOFT_DRIVERS", drivers, 1);
    Mixer mixer;
    std::atomic<double> now = kStart;
    SoundDevice device(mixer, [&] { return now.load(); });
    device.wake();
    CHECK(device.state() == SoundDevice::State::resting);  // no sound is requested
    mixer.set({voice_of(file_of(media::constant(1)), 0)}, kStart);
    device.wake();
    for (int i = 0; i < 2000 && device.state() == SoundDevice::State::resting; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return device.state();
  };
  const SoundDevice::State with = state_with("null");
  CHECK((with == SoundDevice::State::playing || with == SoundDevice::State::silent));
}

}  // namespace
}  // namespace gs::app::mixer_test
