#pragma once

#include "net/base/descriptor.h"

#include <chrono>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <sys/types.h>

namespace gs::net {

/// Program with pipes to its standard input, output and error. Movable.
class SshProcess {
 public:
  SshProcess() = default;
  /// Starts a program from the search path, with the environment of this process. Returns an error on failure.
  [[nodiscard]] static std::variant<SshProcess, std::string> start(const std::string& program,
                                                                   std::vector<std::string> arguments);
  SshProcess(SshProcess&& other) noexcept;
  SshProcess& operator=(SshProcess&& other) noexcept;
  SshProcess(const SshProcess&) = delete;
  SshProcess& operator=(const SshProcess&) = delete;
  /// Calls end(0).
  ~SshProcess();

  [[nodiscard]] int input() const { return input_.get(); }
  [[nodiscard]] int output() const { return output_.get(); }
  [[nodiscard]] int errors() const { return errors_.get(); }
  /// Closes the pipe to the program, which should then end, and waits. After `patience`, asks it to end; after twice
  /// the time, kills it. Returns its exit status; nullopt if a signal ended it.
  std::optional<int> end(std::chrono::milliseconds patience);

 private:
  [[nodiscard]] bool wait(std::chrono::milliseconds time);

  pid_t child_ = 0;  // 0 means that there is no process
  std::optional<int> status_;
  Descriptor input_, output_, errors_;
};

}  // namespace gs::net
