#pragma once

#include "app/confined/decoder_channel.h"
#include "app/confined/decoder_child.h"
#include "base/noncopyable.h"

#include <chrono>
#include <span>
#include <string>
#include <variant>

#include <sys/types.h>

namespace gs::app {

/// Confined child process that decodes images. One thread at a time.
class DecoderProcess : NonCopyable {
 public:
  /// Starts `program` as a decoder child. If that fails, decode() says so.
  DecoderProcess(const std::string& program, DecoderKind kind);
  /// Ends the child.
  ~DecoderProcess();

  /// Decodes an image in the child. Returns an error if the child crashes, gives an impossible answer or takes longer
  /// than `patience`; good() then returns false. Calls `limits.stopped` about 50 times a second.
  [[nodiscard]] std::variant<render::Image, render::ImageError> decode(std::span<const std::byte> bytes,
                                                                       const render::ImageLimits& limits,
                                                                       std::chrono::milliseconds patience);
  /// Reports whether the child can decode more images.
  [[nodiscard]] bool good() const { return child_ > 0; }
  /// Reports whether the child runs. One that ended is of no more use (see good()).
  [[nodiscard]] bool runs();
  [[nodiscard]] pid_t process() const { return child_; }

 private:
  using Clock = std::chrono::steady_clock;
  enum class Wait : unsigned char { answered, ended, stopped, late };
  void start(const std::string& program, DecoderKind kind);
  [[nodiscard]] bool send(std::span<const std::byte> bytes) const;
  [[nodiscard]] Wait receive(std::span<std::byte> bytes, const render::ImageLimits& limits, Clock::time_point end);
  [[nodiscard]] render::ImageError failure(Wait wait);
  /// Ends the child. Returns the reason as text if the child had already ended, else an empty text.
  std::string end();

  pid_t child_ = 0;
  net::Descriptor socket_;
  SharedMemory input_, result_;
};

}  // namespace gs::app
