#pragma once

#include "app/confined/decoder_process.h"

#include <array>
#include <cstddef>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace gs::app {

/// Pool of decoder children that wait for work. Any thread.
class DecoderPool {
 public:
  /// Returns the pool of the program.
  [[nodiscard]] static DecoderPool& of_program();

  /// Sets the program that runs as a decoder child. With an empty path, all is decoded in this process.
  void set_program(std::string program) { program_ = std::move(program); }
  [[nodiscard]] const std::string& program() const { return program_; }
  /// Returns a child that waited, or a new one.
  [[nodiscard]] std::unique_ptr<DecoderProcess> take(DecoderKind kind);
  /// Keeps a child for later work, unless it failed or enough wait.
  void give_back(DecoderKind kind, std::unique_ptr<DecoderProcess> process);

 private:
  static constexpr std::size_t kMostIdle = 2;  // of each kind

  std::mutex mutex_;
  std::string program_;
  std::array<std::vector<std::unique_ptr<DecoderProcess>>, kDecoderKinds> idle_;  // guarded by mutex_
};

/// Makes the pool of the program use this program for its children. Call it at the start of main(). Without it, or with
/// an empty path, all content is decoded in this process, as tests and children do.
inline void set_decoder_program(std::string program) { DecoderPool::of_program().set_program(std::move(program)); }

}  // namespace gs::app
