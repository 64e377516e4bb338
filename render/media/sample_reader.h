#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <variant>

namespace gs::render {

/// What a sound or movie could not be read for, and what was expected.
struct MediaError {
  std::string message;
};

/// Sound as samples, decoded as they are read: memory does not grow with the length. One thread at a time.
class SampleReader {
 public:
  SampleReader() = default;
  SampleReader(const SampleReader&) = delete;
  SampleReader& operator=(const SampleReader&) = delete;
  virtual ~SampleReader() = default;

  /// Samples a second of each channel; > 0.
  [[nodiscard]] virtual double rate() const = 0;
  /// 1 or 2; more of a file are folded into two.
  [[nodiscard]] virtual int channels() const = 0;
  /// The next samples, left and right by turns (of one channel, the same twice), mostly within -1 and 1. How many
  /// pairs: fewer than `to` has room for at the end, and where the rest cannot be read.
  [[nodiscard]] virtual std::size_t read(std::span<float> to) = 0;
  /// Goes on at `seconds` from the start, to the sample.
  virtual void seek(double seconds) = 0;
};

/// What of a file can be played.
struct MediaInfo {
  double duration = -1;  // in seconds, of the pictures if there are any, else of the sound; negative: not known
  bool pictures = false, sound = false;
};

/// Whether a sound or movie can be read, and how long it is. `bytes` of any kind of file of media_input.cpp, or MIDI
/// (midi_reader.h). Safe for untrusted bytes; `stopped` as in MediaInput. Any thread.
[[nodiscard]] std::variant<MediaInfo, MediaError> examine_media(std::span<const std::byte> bytes,
                                                                const std::function<bool()>& stopped = {});

/// The sound of a file, of a movie too. `bytes` outlive it. `synthesis_rate`: of MIDI, which has none of its own.
[[nodiscard]] std::variant<std::unique_ptr<SampleReader>, MediaError> open_samples(
    std::span<const std::byte> bytes, double synthesis_rate = 48000, const std::function<bool()>& stopped = {});

}  // namespace gs::render
