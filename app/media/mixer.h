#pragma once

#include "app/media/voice_stream.h"
#include "base/noncopyable.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

namespace gs::app {

/// Sample rate of the mix in stereo pairs per second.
inline constexpr int kMixRate = 48000;
/// Maximum number of sounds that play at a time. SoundRank orders the candidates.
inline constexpr std::size_t kMaxVoices = 32;

/// Sound for the mixer.
struct Voice {
  const void* who = nullptr;  // with `number`, the identity of the sound; never dereferenced
  std::size_t number = 0;
  std::shared_ptr<const MediaFile> file;
  double start = 0, end = 0;  // seconds since 1970; an infinite `end` means that the end is unknown
  double rate = 1;  // playback speed, > 0; also scales the pitch
  double duration = -1;  // seconds of the whole file; negative means unknown
  bool loop = false;
  double left = 1, right = 1;  // channel gains
};

/// Mixer of voices. Any thread, except for mix(): it decodes files and must run on one thread, which must not draw
/// frames.
class Mixer : NonCopyable {
 public:
  Mixer();
  ~Mixer();

  /// Sets the voices that play from `now` on, in seconds since 1970. A voice that is missing from `voices` stops at
  /// `now` or at its `end`, whichever is earlier.
  void set(std::vector<Voice> voices, double now);
  /// Sets the master gain; 1 is unchanged, 0 is silent.
  void set_gain(double gain);
  /// Mixes the time span `from`..`to`, in seconds since 1970, into stereo pairs in -1..1. The span should be about as
  /// long as the pairs at kMixRate. Gains ramp linearly to the values set last.
  void mix(double from, double to, std::span<float> pairs);
  /// Reports whether any voice plays now or will play later.
  [[nodiscard]] bool sounding() const;

 private:
  struct Playing;
  void take_over();
  void mix_one(Playing& playing, double from, double to, std::span<float> pairs);

  mutable std::mutex mutex_;
  std::vector<Voice> wanted_;  // guarded by mutex_
  double wanted_at_ = 0;       // guarded by mutex_
  bool fresh_ = false;         // guarded by mutex_
  double gain_ = 1;            // guarded by mutex_
  bool sounding_ = false;      // guarded by mutex_
  std::vector<std::unique_ptr<Playing>> playing_;
  double heard_gain_ = 1;
};

}  // namespace gs::app
