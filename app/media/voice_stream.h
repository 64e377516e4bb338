#pragma once

#include "app/media/media_file.h"
#include "render/media/sample_reader.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace gs::app {

/// Samples of one sound as an endless stream: the sound repeats, or is followed by silence. Buffers little more than
/// the requested window, or one whole repetition if that is short. One thread at a time.
class VoiceStream {
 public:
  /// `duration` is in seconds; negative means until the samples end.
  VoiceStream(std::shared_ptr<const MediaFile> file, std::unique_ptr<render::SampleReader> reader, double duration,
              bool loop);

  /// Returns the sample rate in Hz.
  [[nodiscard]] double rate() const { return rate_; }
  /// Returns the number of stereo pairs in one repetition; 0 means unknown.
  [[nodiscard]] std::int64_t length() const { return length_; }
  /// Returns `count` stereo pairs from index `first` on. Pairs at negative indices are silent. Indices continue to
  /// count across repetitions. A call with an earlier `first`, or one far beyond the buffer, needs a slow seek. The
  /// result is valid until the next call.
  [[nodiscard]] const float* window(std::int64_t first, std::size_t count);

 private:
  void fill(std::size_t pairs);
  void read_turn();

  std::shared_ptr<const MediaFile> file_;  // owns the bytes that reader_ reads
  std::unique_ptr<render::SampleReader> reader_;
  double rate_;
  std::int64_t length_ = 0;
  bool loop_;
  std::vector<float> turn_;  // one whole repetition, if the sound repeats and is short
  std::vector<float> held_;
  std::int64_t first_ = 0;  // index of the first buffered pair
  std::int64_t next_ = 0;   // index of the pair to read next
  bool over_ = false;  // the samples of this repetition have ended
};

}  // namespace gs::app
