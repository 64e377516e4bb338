#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <variant>

namespace gs::render {

/// Error of reading a sound or movie, with the expected input.
struct MediaError {
  std::string message;
};

/// Stream of sound samples, decoded on demand, so that memory does not grow with the length. Used by one thread at a
/// time.
class SampleReader {
 public:
  SampleReader() = default;
  SampleReader(const SampleReader&) = delete;
  SampleReader& operator=(const SampleReader&) = delete;
  virtual ~SampleReader() = default;

  /// Returns the samples per second and channel; > 0.
  [[nodiscard]] virtual double rate() const = 0;
  /// Returns 1 or 2; files with more channels are mixed down to two.
  [[nodiscard]] virtual int channels() const = 0;
  /// Reads interleaved left and right samples (equal for one channel), mostly within -1 and 1. Returns the number of
  /// pairs: less than the capacity of `to` at the end or after an error.
  [[nodiscard]] virtual std::size_t read(std::span<float> to) = 0;
  /// Seeks to `seconds` from the start, exact to the sample.
  virtual void seek(double seconds) = 0;
};

/// Playable parts of a file.
struct MediaInfo {
  double duration = -1;  // seconds, of the pictures if any, else of the sound; negative if unknown
  bool pictures = false, sound = false;
};

/// Determines whether a sound or movie is readable, and its duration. `bytes` is any container of media_input.cpp, or
/// MIDI (midi_reader.h). Accepts untrusted input; `stopped` as in MediaInput. Thread-safe.
[[nodiscard]] std::variant<MediaInfo, MediaError> examine_media(std::span<const std::byte> bytes,
                                                                const std::function<bool()>& stopped = {});

/// Opens the sound of a file or movie; `bytes` must outlive it. `synthesis_rate` applies to MIDI, which has no rate of
/// its own.
[[nodiscard]] std::variant<std::unique_ptr<SampleReader>, MediaError> open_samples(
    std::span<const std::byte> bytes, double synthesis_rate = 48000, const std::function<bool()>& stopped = {});

}  // namespace gs::render
