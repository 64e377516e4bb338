#pragma once

#include "app/media/mixer.h"

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

namespace gs::app {

/// Plays a mixer's output on the system's sound device through OpenAL, on its own thread. Decoding and mixing never
/// delay frames, and sounds continue while no frame is drawn. Without the library or a device, stays silent.
class SoundDevice {
 public:
  /// Delay of sound relative to pictures, in seconds. The device requests samples in advance. The delay ensures that a
  /// sound plays from its first sample.
  static constexpr double kBehind = 0.06;

  /// `clock` returns seconds since 1970 and may be called on any thread. `mixer` and `clock` must outlive this object.
  SoundDevice(Mixer& mixer, std::function<double()> clock);
  ~SoundDevice();
  SoundDevice(const SoundDevice&) = delete;
  SoundDevice& operator=(const SoundDevice&) = delete;

  /// Tells the thread that there may be sound to play.
  void wake();
  enum class State : std::uint8_t { resting, playing, silent };  // silent: no output device
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
  std::jthread thread_;  // last member, so that it joins first; starts with the first sound
};

}  // namespace gs::app
