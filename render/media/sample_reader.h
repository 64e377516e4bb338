#pragma once

#include "base/noncopyable.h"

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <variant>

namespace gs::render {

/// Reason why a sound or movie cannot be read. The message names the expected input.
struct MediaError {
  std::string message;
};

/// Stream of sound samples, decoded on demand: memory does not grow with the length. One thread at a time.
class SampleReader : NonCopyable {
 public:
  virtual ~SampleReader() = default;

  /// Returns the sampling rate in samples per second and channel, more than 0.
  [[nodiscard]] virtual double rate() const = 0;
  /// Returns the number of channels, 1 or 2. Files with more channels are mixed to two.
  [[nodiscard]] virtual int channels() const = 0;
  /// Reads pairs of left and right samples (equal for one channel), mostly within -1 and 1. Returns the number of
  /// pairs. It is less than `to` can hold at the end or after an error.
  [[nodiscard]] virtual std::size_t read(std::span<float> to) = 0;
  /// Seeks to `seconds` from the start, exact to the sample.
  virtual void seek(double seconds) = 0;
};

/// Playable contents of a file.
struct MediaInfo {
  double duration = -1;  // seconds, of the pictures, or of the sound if there are none; negative if unknown
  bool pictures = false, sound = false;
};

/// Finds out whether a sound or movie can be played, and its duration. Reads the containers of media_input.cpp, and
/// MIDI (midi_reader.h). `stopped` returns true to cancel. Thread-safe. Safe for untrusted bytes.
[[nodiscard]] std::variant<MediaInfo, MediaError> examine_media(std::span<const std::byte> bytes,
                                                                const std::function<bool()>& stopped = {});

/// Opens the sound of a sound or movie file. `bytes` must outlive the reader. `synthesis_rate` is the rate for MIDI,
/// which has no own rate.
[[nodiscard]] std::variant<std::unique_ptr<SampleReader>, MediaError> open_samples(
    std::span<const std::byte> bytes, double synthesis_rate = 48000, const std::function<bool()>& stopped = {});

}  // namespace gs::render
