#pragma once

#include "app/base/read_file.h"
#include "app/confined/decoder_channel.h"
#include "app/confined/decoder_child.h"
#include "base/noncopyable.h"

#include <chrono>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <sys/types.h>

namespace gs::app {

/// Confined child process that decodes images, sounds and movies. One thread at a time.
class DecoderProcess : NonCopyable {
 public:
  using Stopped = std::function<bool()>;

  /// Memory of a child, if the limits of its requests imply less.
  static constexpr std::uint64_t kMemory = std::uint64_t{3} << 30;

  /// Starts `program` as a decoder child, with `memory` bytes. If that fails, requests say so. If `file` is not
  /// negative, the child reads that open file instead of bytes from load().
  DecoderProcess(const std::string& program, DecoderKind kind, int file = -1, std::uint64_t memory = kMemory);
  /// Ends the child.
  ~DecoderProcess();

  /// Decodes an image in the child. Returns an error if the child crashes, gives an impossible answer or takes longer
  /// than `patience`; good() then returns false. Calls `limits.stopped` about 50 times a second.
  [[nodiscard]] std::variant<render::Image, render::ImageError> decode(std::span<const std::byte> bytes,
                                                                       const render::ImageLimits& limits,
                                                                       std::chrono::milliseconds patience);
  /// Copies the bytes that the next requests decode to the child's memory. Returns false if memory is insufficient.
  [[nodiscard]] bool load(std::span<const std::byte> bytes, std::span<const std::byte> more = {});
  /// Copies bytes to the memory for results, for a child that asked for them. Returns false if memory is insufficient.
  [[nodiscard]] bool put_result(std::span<const std::byte> bytes);
  /// Returns the bytes that an answer announces, or its error. Fails if there are more than `most`.
  [[nodiscard]] std::variant<std::vector<std::byte>, render::ImageError> take_bytes(const DecodeAnswer& answer,
                                                                                    const Stopped& stopped,
                                                                                    std::chrono::milliseconds patience,
                                                                                    std::uint64_t most);
  /// Sends a request and waits for its answer, as decode() does. Makes room for `result_bytes` bytes of results first.
  [[nodiscard]] std::variant<DecodeAnswer, render::ImageError> ask(const DecodeRequest& request, const Stopped& stopped,
                                                                   std::chrono::milliseconds patience,
                                                                   std::size_t result_bytes = 0);
  /// Sends a request without waiting; await_answer() then waits for its answer. Returns false if the child ended.
  [[nodiscard]] bool begin(const DecodeRequest& request, std::size_t result_bytes);
  [[nodiscard]] std::variant<DecodeAnswer, render::ImageError> await_answer(const Stopped& stopped,
                                                                            std::chrono::milliseconds patience);
  /// Reports whether an answer, or the end of the child, has arrived.
  [[nodiscard]] bool has_answer() const;
  /// Answers a child that asked for a file: gives the file, as a descriptor if it is mapped, or the error. Waits for
  /// the next answer.
  [[nodiscard]] std::variant<DecodeAnswer, render::ImageError> give_file(const BytesResult& file,
                                                                         const Stopped& stopped,
                                                                         std::chrono::milliseconds patience);
  /// Like ask(), for requests that give an image. `answer` receives the answer.
  [[nodiscard]] std::variant<render::Image, render::ImageError> ask_image(const DecodeRequest& request,
                                                                          const Stopped& stopped,
                                                                          std::chrono::milliseconds patience,
                                                                          DecodeAnswer& answer);
  /// Returns the first `bytes` bytes of the memory for results; fewer than that if they cannot be mapped.
  [[nodiscard]] std::span<const std::byte> results(std::size_t bytes);
  /// Reports whether the child can decode more.
  [[nodiscard]] bool good() const { return child_ > 0; }
  /// Reports whether the child still runs. If it has ended, good() returns false, too.
  [[nodiscard]] bool runs();
  [[nodiscard]] pid_t process() const { return child_; }

 private:
  using Clock = std::chrono::steady_clock;
  enum class Wait : unsigned char { answered, ended, stopped, late };
  void start(const std::string& program, DecoderKind kind, int file, std::uint64_t memory);
  /// Makes room for results that the child has announced, and waits until it has copied them.
  [[nodiscard]] std::optional<render::ImageError> await_results(std::size_t bytes, const Stopped& stopped,
                                                                Clock::time_point end);
  [[nodiscard]] bool send(std::span<const std::byte> bytes) const;
  [[nodiscard]] Wait receive(std::span<std::byte> bytes, const Stopped& stopped, Clock::time_point end);
  [[nodiscard]] render::ImageError failure(Wait wait);
  /// Ends the child. Returns the reason as text if the child had already ended, else an empty text.
  std::string end();

  pid_t child_ = 0;
  net::Descriptor socket_;
  SharedMemory input_, result_;
};

}  // namespace gs::app
