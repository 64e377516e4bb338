#pragma once

#include "app/media/voice_stream.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

namespace gs::app {

/// Sample rate of the mix: stereo pairs per second.
inline constexpr int kMixRate = 48000;
/// Maximum number of sounds played at a time; see SoundRank.
inline constexpr std::size_t kMaxVoices = 32;

/// One sound to be mixed.
struct Voice {
  const void* who = nullptr;  // identity of the sound, together with `number`
  std::size_t number = 0;
  std::shared_ptr<const MediaFile> file;
  double start = 0, end = 0;  // seconds since 1970; an infinite `end` means unknown
  double rate = 1;            // > 0; scales pitch or speed
  double duration = -1;       // duration of the file in seconds; negative means unknown
  bool loop = false;
  double left = 1, right = 1;  // channel gains
};

/// Mixes voices. `set` and the other functions may run on any thread. `mix` decodes and must run on one thread, never
/// the thread that draws frames.
class Mixer {
 public:
  Mixer();
  ~Mixer();
  Mixer(const Mixer&) = delete;
  Mixer& operator=(const Mixer&) = delete;

  /// Replaces the voices as of `now`, in seconds since 1970. A voice that is missing from `voices` stops at its former
  /// `end` if that has passed, else at `now`.
  void set(std::vector<Voice> voices, double now);
  /// Sets the master gain, >= 0.
  void set_gain(double gain);
  /// Mixes stereo pairs in -1..1 for the time span `from`..`to`, about one pair per 1/kMixRate seconds. Gains ramp
  /// linearly to the values last set.
  void mix(double from, double to, std::span<float> pairs);
  /// Reports whether any voice plays now or later.
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
