#pragma once

#include "app/media/mixer.h"
#include "base/noncopyable.h"

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

namespace gs::app {

/// Output of a mixer on the system's sound device through OpenAL. It decodes and mixes on its own thread: this never
/// delays frames, and sounds continue while no frame is drawn. Without the library or a device, it stays silent.
class SoundDevice : NonCopyable {
 public:
  /// Delay of sound relative to pictures, in seconds. The device mixes in advance; because of the delay, a sound that
  /// has just started still plays from its first sample.
  static constexpr double kBehind = 0.06;

  /// `clock` returns the present time in seconds since 1970, on any thread. `mixer` and `clock` must outlive this
  /// object.
  SoundDevice(Mixer& mixer, std::function<double()> clock);
  ~SoundDevice();

  /// Wakes the thread, because there may be sound to play.
  void wake();
  enum class State : std::uint8_t { resting, playing, silent };  // silent means that there is no output device
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
