#include "render/media/sample_reader.h"

#include "render/media/midi_reader.h"
#include "tests/render/media/media_files.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace gs::render::sample_reader_test {
namespace {

using media::Bytes;
using media::bytes_of;

std::unique_ptr<SampleReader> opened(const Bytes& bytes) {
  auto result = open_samples(bytes);
  if (const auto* wrong = std::get_if<MediaError>(&result)) FAIL(wrong->message);
  return std::move(std::get<0>(result));
}

std::vector<float> all_of(SampleReader& reader, std::size_t piece = 1000) {
  std::vector<float> samples, some(2 * piece);
  constexpr std::size_t kMax = 10'000'000;
  while (samples.size() < kMax) {
    const std::size_t count = reader.read(some);
    samples.insert(samples.end(), some.begin(), some.begin() + static_cast<std::ptrdiff_t>(2 * count));
    if (count < piece) break;
  }
  return samples;
}

// Ramp: the left channel rises, the right channel falls.
double ramp(std::size_t i, int channel) { return (channel == 0 ? 1 : -1) * static_cast<double>(i % 30'000) / 32'768; }

TEST_CASE("reads a WAV sample by sample, and seeks to any time") {
  for (const int channels : {1, 2}) {
    const Bytes bytes = bytes_of(media::wav(11'025, channels, 40'000, ramp));
    const auto reader = opened(bytes);
    CHECK(reader->rate() == 11'025);
    CHECK(reader->channels() == channels);
    const std::vector<float> all = all_of(*reader);
    REQUIRE(all.size() == 2 * 40'000);
    bool same = true;
    for (std::size_t i = 0; i < 40'000; ++i)
      same = same && std::abs(all[2 * i] - ramp(i, 0)) < 1e-4 &&
             std::abs(all[2 * i + 1] - ramp(i, channels == 1 ? 0 : 1)) < 1e-4;
    CHECK(same);
    for (const std::size_t from : {0u, 1u, 777u, 11'025u, 35'000u, 39'999u, 5u}) {
      reader->seek(static_cast<double>(from) / 11'025);
      float some[8] = {};
      const std::size_t count = reader->read(some);
      REQUIRE(count == std::min<std::size_t>(4, 40'000 - from));
      for (std::size_t i = 0; i < count; ++i) CHECK(some[2 * i] == all[2 * (from + i)]);
    }
    const auto info = examine_media(bytes);
    REQUIRE(info.index() == 0);
    CHECK(std::get<0>(info).duration == Approx(40'000 / 11'025.0).margin(1e-9));
    CHECK(std::get<0>(info).sound);
    CHECK_FALSE(std::get<0>(info).pictures);
  }
}

TEST_CASE("reads MP3, Ogg and FLAC with their durations") {
  // Each file is one second of 440 Hz with 22,050 samples per second.
  for (const std::string name : {"tone.mp3", "tone.ogg", "tone.flac", "tone.au"}) {
    INFO(name);
    const Bytes bytes = bytes_of(media::file_text(std::string(GHOSTSPACE_TESTS) + "/fuzz/corpus/render/sound/" + name));
    const auto info = examine_media(bytes);
    REQUIRE(info.index() == 0);
    CHECK(std::get<0>(info).duration == Approx(1).margin(0.1));
    const auto reader = opened(bytes);
    CHECK(reader->rate() == 22'050);
    const std::vector<float> all = all_of(*reader);
    CHECK(static_cast<double>(all.size()) / 2 == Approx(22'050).margin(2300));
    // Level and number of upward zero crossings.
    double squares = 0;
    int crossings = 0;
    for (std::size_t i = 3000; i < 19'000; ++i) {
      squares += all[2 * i] * all[2 * i];
      if (all[2 * i] < 0 && all[2 * i + 2] >= 0) ++crossings;
    }
    CHECK(std::sqrt(squares / 16'000) == Approx(0.5 / std::sqrt(2.0)).margin(0.02));
    CHECK(crossings == Approx(440 * 16'000 / 22'050.0).margin(2));
    // After a jump, the samples are equal within the loss of the codec.
    reader->seek(0.5);
    std::vector<float> some(2 * 2000);
    REQUIRE(reader->read(some) == 2000);
    double apart = 0;
    for (std::size_t i = 0; i < some.size(); ++i) apart = std::max(apart, double{std::abs(some[i] - all[22'050 + i])});
    CHECK(apart < 0.02);
  }
}

TEST_CASE("reads the sound of an MPEG-1 system stream") {
  const Bytes bytes = bytes_of(media::file_text(std::string(GHOSTSPACE_TESTS) + "/fuzz/corpus/render/sound/tone.mpg"));
  const auto info = examine_media(bytes);
  REQUIRE(info.index() == 0);
  CHECK(std::get<0>(info).sound);
  CHECK(std::get<0>(info).pictures);
  const auto reader = opened(bytes);
  CHECK(all_of(*reader).size() > 2 * 20'000);
}

TEST_CASE("decodes the intact part of truncated or damaged sounds, or reports an error") {
  const Bytes whole[] = {
      bytes_of(media::tone(0.05)),
      bytes_of(media::file_text(std::string(GHOSTSPACE_TESTS) + "/fuzz/corpus/render/sound/tone.mp3")),
      bytes_of(media::file_text(std::string(GHOSTSPACE_TESTS) + "/fuzz/corpus/render/sound/tone.ogg")),
      bytes_of(media::midi_song())};
  for (const Bytes& bytes : whole) {
    const auto check = [](const Bytes& some) {
      const auto info = examine_media(some);
      if (const auto* wrong = std::get_if<MediaError>(&info)) CHECK(wrong->message.size() > 10);
      if (is_midi(some)) return;  // the synthesiser is slow
      const auto result = open_samples(some);
      if (const auto* wrong = std::get_if<MediaError>(&result)) {
        CHECK(wrong->message.size() > 10);
        return;
      }
      SampleReader& reader = *std::get<0>(result);
      for (const float value : all_of(reader)) REQUIRE(std::abs(value) <= 4);
      reader.seek(0.7);
      (void)all_of(reader);
    };
    media::each_damaged(bytes, 40, check);
  }
}

TEST_CASE("rejects files that are no sound, and names the expected formats") {
  for (const std::string text :
       {"", "plain text", "RIFF\x10\x00\x00\x00WAVEfmt ", "GIF89a", "ffconcat version 1.0\n"}) {
    const auto info = examine_media(bytes_of(text));
    REQUIRE(info.index() == 1);
    CHECK(std::get<1>(info).message.size() > 20);
    CHECK(open_samples(bytes_of(text)).index() == 1);
  }
}

}  // namespace
}  // namespace gs::render::sample_reader_test
