#include "app/media/sound_device.h"

#include <AL/al.h>
#include <AL/alc.h>
#include <dlfcn.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <type_traits>
#include <utility>

/// OpenAL functions that this file uses.
#define GHOSTSPACE_OPENAL_FUNCTIONS(X) \
  X(alBufferData)                      \
  X(alDeleteBuffers)                   \
  X(alDeleteSources)                   \
  X(alGenBuffers)                      \
  X(alGenSources)                      \
  X(alGetError)                        \
  X(alGetSourcei)                      \
  X(alSourcePlay)                      \
  X(alSourceQueueBuffers)              \
  X(alSourceStop)                      \
  X(alSourceUnqueueBuffers)            \
  X(alSourcei)                         \
  X(alcCloseDevice)                    \
  X(alcCreateContext)                  \
  X(alcDestroyContext)                 \
  X(alcMakeContextCurrent)             \
  X(alcOpenDevice)

namespace gs::app {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kPairs = 512;  // stereo pairs per buffer
constexpr int kBuffers = 4;
constexpr double kBuffer = static_cast<double>(kPairs) / kMixRate;  // seconds per buffer
constexpr double kClocksApart = 0.05;  // seconds; a larger clock difference causes a jump
constexpr double kSilence = 2;  // seconds without sound before the device is closed

/// OpenAL library. It is loaded when the first sound plays.
struct OpenAl {
#define GHOSTSPACE_OPENAL_MEMBER(name) decltype(&::name) name = nullptr;
  GHOSTSPACE_OPENAL_FUNCTIONS(GHOSTSPACE_OPENAL_MEMBER)
#undef GHOSTSPACE_OPENAL_MEMBER
  bool good = false;

  OpenAl() {
    void* const library = dlopen("libopenal.so.1", RTLD_NOW | RTLD_LOCAL);
    if (!library) return;
    good = true;
#define GHOSTSPACE_OPENAL_FIND(name)                                    \
  name = reinterpret_cast<decltype(this->name)>(dlsym(library, #name)); \
  good = good && name;
    GHOSTSPACE_OPENAL_FUNCTIONS(GHOSTSPACE_OPENAL_FIND)
#undef GHOSTSPACE_OPENAL_FIND
  }
};

const OpenAl& openal() {
  static const OpenAl library;
  return library;
}

void say_nothing(const char*, int, const char*, int, const char*, ...) {}

/// Suppresses ALSA's messages on the terminal.
void keep_alsa_quiet() {
  using Handler = void (*)(const char*, int, const char*, int, const char*, ...);
  void* const library = dlopen("libasound.so.2", RTLD_NOW | RTLD_GLOBAL);
  if (!library) return;
  const auto set = reinterpret_cast<int (*)(Handler)>(dlsym(library, "snd_lib_error_set_handler"));
  if (set) (void)set(say_nothing);
}

/// Sound device that is open, with one source and a queue of buffers.
class Output {
 public:
  ~Output() {
    const OpenAl& al = openal();
    if (source_) {
      al.alSourceStop(source_);
      al.alSourcei(source_, AL_BUFFER, 0);
      al.alDeleteSources(1, &source_);
      al.alDeleteBuffers(kBuffers, buffers_.data());
    }
    if (context_) {
      al.alcMakeContextCurrent(nullptr);
      al.alcDestroyContext(context_);
    }
    if (device_) al.alcCloseDevice(device_);
  }

  bool open() {
    const OpenAl& al = openal();
    if (!al.good) return false;
    keep_alsa_quiet();
    device_ = al.alcOpenDevice(nullptr);
    if (!device_) return false;
    context_ = al.alcCreateContext(device_, nullptr);
    if (!context_ || !al.alcMakeContextCurrent(context_)) return false;
    (void)al.alGetError();
    al.alGenSources(1, &source_);
    al.alGenBuffers(kBuffers, buffers_.data());
    free_.assign(buffers_.begin(), buffers_.end());
    return al.alGetError() == AL_NO_ERROR;
  }

  /// Reports whether a buffer is free.
  bool wants() {
    const OpenAl& al = openal();
    ALint done = 0;
    al.alGetSourcei(source_, AL_BUFFERS_PROCESSED, &done);
    for (; done > 0; --done) {
      ALuint buffer = 0;
      al.alSourceUnqueueBuffers(source_, 1, &buffer);
      if (al.alGetError() == AL_NO_ERROR) free_.push_back(buffer);
    }
    return !free_.empty();
  }

  /// Returns the seconds of queued sound that have not played yet.
  double waiting() {
    ALint offset = 0;
    openal().alGetSourcei(source_, AL_SAMPLE_OFFSET, &offset);
    const double queued = static_cast<double>(kBuffers - static_cast<int>(free_.size())) * kBuffer;
    return std::max(0.0, queued - static_cast<double>(offset) / kMixRate);
  }

  bool give(std::span<const float> pairs) {
    const OpenAl& al = openal();
    std::array<std::int16_t, 2 * kPairs> samples{};
    for (std::size_t i = 0; i < samples.size(); ++i)
      samples[i] = static_cast<std::int16_t>(std::lround(pairs[i] * 32767));
    const ALuint buffer = free_.back();
    free_.pop_back();
    al.alBufferData(buffer, AL_FORMAT_STEREO16, samples.data(), sizeof samples, kMixRate);
    al.alSourceQueueBuffers(source_, 1, &buffer);
    ALint state = 0;
    al.alGetSourcei(source_, AL_SOURCE_STATE, &state);
    if (state != AL_PLAYING) al.alSourcePlay(source_);
    return al.alGetError() == AL_NO_ERROR;
  }

 private:
  ALCdevice* device_ = nullptr;
  ALCcontext* context_ = nullptr;
  ALuint source_ = 0;
  std::array<ALuint, kBuffers> buffers_{};
  std::vector<ALuint> free_;
};

}  // namespace

SoundDevice::SoundDevice(Mixer& mixer, std::function<double()> clock) : mixer_(mixer), clock_(std::move(clock)) {}

SoundDevice::~SoundDevice() = default;

void SoundDevice::wake() {
  if (state_ != State::resting || !mixer_.sounding()) return;
  if (!thread_.joinable()) thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  {
    const std::lock_guard lock(mutex_);
    awake_ = true;
  }
  something_.notify_one();
}

void SoundDevice::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    {
      std::unique_lock lock(mutex_);
      if (!something_.wait(lock, stop, [this] { return std::exchange(awake_, false); })) return;
    }
    state_ = State::playing;
    if (!play(stop)) {
      state_ = State::silent;
      return;
    }
    state_ = State::resting;
  }
}

// Plays until there has been no sound for kSilence. Returns false if the device cannot be opened or fails.
bool SoundDevice::play(const std::stop_token& stop) {
  Output output;
  if (!output.open()) return false;
  std::array<float, 2 * kPairs> pairs{};
  std::optional<double> next;  // world time of the next pair to mix
  double silent_since = clock_();
  while (!stop.stop_requested()) {
    while (output.wants()) {
      const double heard_at = clock_() + output.waiting() - kBehind;
      if (!next || std::abs(*next - heard_at) > kClocksApart) next = heard_at;
      // The clocks of device and system drift apart. Correct the speed by at most 0.1 %, which is inaudible.
      const double correction = std::clamp((heard_at - *next) * 0.05, -0.001 * kBuffer, 0.001 * kBuffer);
      const bool even = std::abs(heard_at - *next) < 0.01;
      const double to = *next + kBuffer + (even ? 0 : correction);
      mixer_.mix(*next, to, pairs);
      next = to;
      if (!output.give(pairs)) return false;
    }
    const double now = clock_();
    if (mixer_.sounding()) silent_since = now;
    if (now - silent_since > kSilence) return true;
    std::unique_lock lock(mutex_);
    (void)something_.wait_for(lock, stop, std::chrono::duration<double>(kBuffer / 2), [] { return false; });
  }
  return true;
}

}  // namespace gs::app
