#pragma once

#include "app/media/voice_stream.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

namespace gs::app {

/// Pairs a second that are mixed.
inline constexpr int kMixRate = 48000;
/// Sounds that are heard at a time; see SoundRank.
inline constexpr std::size_t kMostVoices = 32;

/// A sound that is to be heard.
struct Voice {
  const void* who = nullptr;  // tells it apart from others, with `number`
  std::size_t number = 0;
  std::shared_ptr<const MediaFile> file;
  double start = 0, end = 0;  // in seconds since 1970; `end` infinite: not known
  double rate = 1;            // > 0: pitch or speed
  double duration = -1;       // of the file, in seconds; negative: not known
  bool loop = false;
  double left = 1, right = 1;  // factors
};

/// Adds sounds up. `set` and the others on any threads; `mix` on one, which decodes: never that of the frames.
class Mixer {
 public:
  Mixer();
  ~Mixer();
  Mixer(const Mixer&) = delete;
  Mixer& operator=(const Mixer&) = delete;

  /// What is to be heard as of `now`, in seconds since 1970. What is not among it any more is over when its `end` said
  /// so, else at `now`.
  void set(std::vector<Voice> voices, double now);
  /// Everything is made louder by this, 0 and more.
  void set_gain(double gain);
  /// Pairs left and right, from -1 to 1, of the time from `from` to `to`: that of one pair for each 1/kMixRate of it,
  /// or nearly so. Levels go to what was set as straight lines.
  void mix(double from, double to, std::span<float> pairs);
  /// Whether anything is to be heard, now or later.
  [[nodiscard]] bool sounding() const;

 private:
  struct Playing;
  void take_over();
  void mix_one(Playing& playing, double from, double to, std::span<float> pairs);

  mutable std::mutex mutex_;
  std::vector<Voice> wanted_;  // guarded by mutex_
  double wanted_at_ = 0;       // likewise
  bool fresh_ = false;         // likewise
  double gain_ = 1;            // likewise
  bool sounding_ = false;      // likewise
  std::vector<std::unique_ptr<Playing>> playing_;
  double heard_gain_ = 1;
};

}  // namespace gs::app
