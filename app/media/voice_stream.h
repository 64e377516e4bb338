#pragma once

#include "app/formats/media_file.h"
#include "render/media/sample_reader.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace gs::app {

/// A sound as one stream of samples that goes on for ever: again and again from its start, or silent behind its end.
/// Holds what is looked at and a little more, or a whole turn if that is short. One thread at a time.
class VoiceStream {
 public:
  /// `duration` in seconds; negative: as long as there are samples.
  VoiceStream(std::shared_ptr<const MediaFile> file, std::unique_ptr<render::SampleReader> reader, double duration,
              bool loop);

  /// Samples a second.
  [[nodiscard]] double rate() const { return rate_; }
  /// How many pairs a turn has; 0: it has no end that is known.
  [[nodiscard]] std::int64_t length() const { return length_; }
  /// Pairs left and right, from the one numbered `first` on, which may be negative: silence. Numbers count on over all
  /// turns. Forwards from call to call; after a step back, or over more than is held, the reader jumps. Valid until
  /// the next call.
  [[nodiscard]] const float* window(std::int64_t first, std::size_t count);

 private:
  void fill(std::size_t pairs);
  void read_turn();

  std::shared_ptr<const MediaFile> file_;  // whose bytes the reader reads
  std::unique_ptr<render::SampleReader> reader_;
  double rate_;
  std::int64_t length_ = 0;
  bool loop_;
  std::vector<float> turn_;  // all of it, of a short one that is repeated
  std::vector<float> held_;
  std::int64_t first_ = 0;  // number of the first pair that is held
  std::int64_t next_ = 0;   // of the pair that is read next
  bool over_ = false;       // of this turn there are no more
};

}  // namespace gs::app
