#pragma once

#include "app/media/mixer.h"

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

namespace gs::app {

/// Plays what a mixer mixes on the sound device of the system, by OpenAL, on a thread of its own: decoding and mixing
/// keep no frame waiting, and sounds go on while none is drawn. Without a library or a device nothing is heard, and
/// nothing else happens.
class SoundDevice {
 public:
  /// So much later than the pictures sounds are heard, in seconds: what a step starts is heard from its first sample,
  /// although the device asks for samples in advance.
  static constexpr double kBehind = 0.06;

  /// `clock`: seconds since 1970, on any thread. Both outlive this.
  SoundDevice(Mixer& mixer, std::function<double()> clock);
  ~SoundDevice();
  SoundDevice(const SoundDevice&) = delete;
  SoundDevice& operator=(const SoundDevice&) = delete;

  /// Something is to be heard, perhaps.
  void wake();
  enum class State : std::uint8_t { resting, playing, silent };  // silent: there is nothing to play on
  [[nodiscard]] State state() const { return state_; }

 private:
  void run(const std::stop_token& stop);
  [[nodiscard]] bool play(const std::stop_token& stop);

  Mixer& mixer_;
  std::function<double()> clock_;
  std::atomic<State> state_ = State::resting;
  std::mutex mutex_;
  std::condition_variable_any something_;
  bool awake_ = false;   // guarded by mutex_
  std::jthread thread_;  // last: joined before what it uses goes; begins with the first sound
};

}  // namespace gs::app
