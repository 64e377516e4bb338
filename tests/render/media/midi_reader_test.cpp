#include "render/media/midi_reader.h"

#include "tests/render/media/media_files.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace gs::render::midi_reader_test {
namespace {

using media::Bytes;
using media::bytes_of;

MidiSong song_of(const std::string& text) {
  auto song = read_midi(bytes_of(text));
  if (const auto* wrong = std::get_if<MediaError>(&song)) FAIL(wrong->message);
  return std::get<MidiSong>(std::move(song));
}

// Returns a track of these messages, with 96 ticks per quarter.
std::string song_with(const std::string& track, const std::string& division = std::string("\0\x60", 2)) {
  std::string text("MThd\0\0\0\6\0\0\0\1", 12);
  text += division + "MTrk";
  for (int shift = 24; shift >= 0; shift -= 8) text += static_cast<char>(track.size() >> shift & 0xff);
  return text + track;
}

TEST_CASE("computes the times of MIDI notes by the tempo changes") {
  const MidiSong song = song_of(media::midi_song());
  REQUIRE(song.events.size() == 5);
  CHECK(song.events[0].status == 0xc0);
  CHECK(song.events[1].time == 0);
  CHECK(song.events[2].time == Approx(0.5));  // 96 ticks per quarter, 120 quarters per minute
  CHECK(song.events[3].first == 0x48);
  CHECK(song.events[4].time == Approx(1));
  CHECK(song.duration == Approx(1));
  // A tempo of 250,000 microseconds from the second quarter on; running status; a length in two bytes.
  const MidiSong faster =
      song_of(song_with(std::string("\x60\x90\x40\x40\0\xff\x51\3\3\xd0\x90\x60\x40\0\x81\x40\x41\x7f"
                                    "\0\xff\x2f\0",
                                    23)));
  REQUIRE(faster.events.size() == 3);
  CHECK(faster.events[0].time == Approx(0.5));
  CHECK(faster.events[1].time == Approx(0.75));
  CHECK(faster.events[1].status == 0x90);
  CHECK(faster.events[2].time == Approx(1.25));
  // The division has 25 frames per second and 40 ticks per frame.
  CHECK(song_of(song_with(std::string("\x64\x90\x40\x40\0\xff\x2f\0", 8), "\xe7\x28")).duration == Approx(0.1));
}

TEST_CASE("decodes the intact part of truncated or damaged MIDI files, or reports an error") {
  const std::string whole = media::midi_song();
  for (std::size_t part = 0; part < whole.size(); ++part) {
    const auto song = read_midi(bytes_of(whole.substr(0, part)));
    if (const auto* wrong = std::get_if<MediaError>(&song)) CHECK(wrong->message.size() > 10);
  }
  for (const std::string& bad :
       {std::string("MThd\0\0\0\6\0\2\0\1\0\x60", 14), std::string("MThd\0\0\0\6\0\0\0\1\0\0", 14),
        song_with(std::string("\0\xff\x2f\0", 4)), song_with(std::string("\xff\xff\xff\xff\x90", 5))})
    CHECK(read_midi(bytes_of(bad)).index() == 1);
  // The track is longer than any song.
  std::string endless;
  for (int i = 0; i < 40; ++i) endless += std::string("\xff\xff\xff\x7f\x90\x40\x40", 7);
  CHECK(read_midi(bytes_of(song_with(std::string("\0\xff\x51\3\xff\xff\xff", 7) + endless))).index() == 1);
}

TEST_CASE("plays MIDI by FluidSynth if it and a sound font are installed (6.4)") {
  const Bytes bytes = bytes_of(media::midi_song());
  auto opened = open_samples(bytes, 44'100);
  if (const auto* wrong = std::get_if<MediaError>(&opened)) {
    // The message names the missing library.
    CHECK(wrong->message.find("MIDI needs FluidSynth and a sound font") != std::string::npos);
    WARN(wrong->message);
    return;
  }
  SampleReader& reader = *std::get<0>(opened);
  CHECK(reader.rate() == 44'100);
  std::vector<float> samples(2 * 60'000);
  REQUIRE(reader.read(samples) == 44'100);  // a second, the length of the song
  const auto level = [&](double from, double to) {
    double squares = 0;
    const auto first = static_cast<std::size_t>(from * 44'100), last = static_cast<std::size_t>(to * 44'100);
    for (std::size_t i = first; i < last; ++i) squares += samples[2 * i] * samples[2 * i];
    return std::sqrt(squares / static_cast<double>(last - first));
  };
  CHECK(level(0.05, 0.4) > 0.005);
  CHECK(level(0.55, 0.9) > 0.005);
  // The first key is middle C, 261.6 Hz, the second an octave higher.
  const auto crossings = [&](double from, double to) {
    int count = 0;
    for (auto i = static_cast<std::size_t>(from * 44'100); i < static_cast<std::size_t>(to * 44'100); ++i)
      count += samples[2 * i] < 0 && samples[2 * i + 2] >= 0 ? 1 : 0;
    return count / (to - from);
  };
  CHECK(crossings(0.6, 0.9) > 1.3 * crossings(0.1, 0.4));
  reader.seek(0.5);
  std::vector<float> again(2 * 1000);
  CHECK(reader.read(again) == 1000);
}

}  // namespace
}  // namespace gs::render::midi_reader_test
