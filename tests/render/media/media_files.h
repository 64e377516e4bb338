#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

// Sounds made by formulas.
namespace gs::media {

using Bytes = std::vector<std::byte>;

inline Bytes bytes_of(const std::string& text) {
  Bytes bytes(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) bytes[i] = static_cast<std::byte>(text[i]);
  return bytes;
}

/// Calls `check` with beginnings of a file, and with the whole file after random changes, `count` of each.
template <class Check>
void each_damaged(const Bytes& bytes, std::size_t count, Check check) {
  for (std::size_t part = 0; part < bytes.size(); part += 1 + bytes.size() / count)
    check(Bytes(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(part)));
  std::uint32_t random = 7;
  for (std::size_t turn = 0; turn < count; ++turn) {
    Bytes damaged = bytes;
    for (int i = 0; i < 8; ++i) {
      random = random * 1664525 + 1013904223;
      damaged[(random >> 8) % damaged.size()] = static_cast<std::byte>(random);
    }
    check(damaged);
  }
}

inline void put(std::string& text, std::uint64_t value, int count) {
  for (int i = 0; i < count; ++i) text += static_cast<char>(value >> (8 * i) & 0xff);
}

/// Returns a WAV of 16 bits, with `sample(i, channel)` from -1 to 1.
template <class Sample>
std::string wav(int rate, int channels, std::size_t count, Sample sample) {
  std::string data;
  for (std::size_t i = 0; i < count; ++i)
    for (int c = 0; c < channels; ++c)
      put(data, static_cast<std::uint16_t>(static_cast<std::int16_t>(std::lround(sample(i, c) * 32767))), 2);
  std::string text = "RIFF";
  put(text, 36 + data.size(), 4);
  text += "WAVEfmt ";
  put(text, 16, 4);
  put(text, 1, 2);
  put(text, static_cast<std::uint64_t>(channels), 2);
  put(text, static_cast<std::uint64_t>(rate), 4);
  put(text, static_cast<std::uint64_t>(rate) * static_cast<std::uint64_t>(channels) * 2, 4);
  put(text, static_cast<std::uint64_t>(channels) * 2, 2);
  put(text, 16, 2);
  text += "data";
  put(text, data.size(), 4);
  return text + data;
}

/// Returns a tone of one channel.
inline std::string tone(double seconds, double frequency = 440, double level = 0.5, int rate = 48000) {
  return wav(rate, 1, static_cast<std::size_t>(std::llround(seconds * rate)), [&](std::size_t i, int) {
    return level * std::sin(6.283185307179586 * frequency * static_cast<double>(i) / rate);
  });
}

/// Returns a constant signal, which shows the applied gain.
inline std::string constant(double seconds, double level = 0.5, int rate = 48000) {
  return wav(rate, 1, static_cast<std::size_t>(std::llround(seconds * rate)), [&](std::size_t, int) { return level; });
}

/// Returns the samples of a 16-bit stereo WAV from -1 to 1, left and right in turn, or an empty list for other files.
inline std::vector<float> samples_of(const std::string& text) {
  if (text.size() < 44 || text.substr(0, 4) != "RIFF" || text.substr(8, 8) != "WAVEfmt ") return {};
  std::vector<float> samples;
  for (std::size_t i = 44; i + 1 < text.size(); i += 2) {
    std::int16_t value = 0;
    std::memcpy(&value, text.data() + i, 2);
    samples.push_back(static_cast<float>(value) / 32768);
  }
  return samples;
}

inline std::string file_text(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Returns a standard MIDI file of two notes, quarters of 0.5 s each.
inline std::string midi_song() {
  const char song[] =
      "MThd\0\0\0\6\0\1\0\2\0\x60"
      "MTrk\0\0\0\x0b\0\xff\x51\3\x07\xa1\x20\0\xff\x2f\0"
      "MTrk\0\0\0\x17\0\xc0\x0d\0\x90\x3c\x64\x60\x80\x3c\x40\0\x90\x48\x64\x60\x80\x48\x40\0\xff\x2f\0";
  return {song, sizeof song - 1};
}

}  // namespace gs::media
