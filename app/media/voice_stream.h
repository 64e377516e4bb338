#pragma once

#include "app/media/media_file.h"
#include "render/media/sample_reader.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace gs::app {

/// Endless stream of samples of one sound: it loops, or is silent after its end. Buffers the current window and a
/// little more, or one whole loop if that is short. Use from one thread at a time.
class VoiceStream {
 public:
  /// `duration` is in seconds; negative means until the samples end.
  VoiceStream(std::shared_ptr<const MediaFile> file, std::unique_ptr<render::SampleReader> reader, double duration,
              bool loop);

  /// Sample rate in Hz.
  [[nodiscard]] double rate() const { return rate_; }
  /// Number of stereo pairs in one loop; 0 means unknown.
  [[nodiscard]] std::int64_t length() const { return length_; }
  /// Returns `count` stereo pairs from index `first` on. Negative indices are silent; indices count on across loops.
  /// Calls should move forward: a step back, or one beyond the buffer, makes the reader seek. Valid until the next
  /// call.
  [[nodiscard]] const float* window(std::int64_t first, std::size_t count);

 private:
  void fill(std::size_t pairs);
  void read_turn();

  std::shared_ptr<const MediaFile> file_;  // owns the bytes that reader_ reads
  std::unique_ptr<render::SampleReader> reader_;
  double rate_;
  std::int64_t length_ = 0;
  bool loop_;
  std::vector<float> turn_;  // one whole loop, if the sound repeats and is short
  std::vector<float> held_;
  std::int64_t first_ = 0;  // index of the first buffered pair
  std::int64_t next_ = 0;   // index of the pair to read next
  bool over_ = false;       // this loop has no more samples
};

}  // namespace gs::app
