#pragma once

#include <chrono>
#include <string>
#include <variant>

namespace gs::net {

/// Reason why the controlled program did not answer.
struct ControlCallError {
  std::string message;
};

/// Sends one message to a controlled program on a Unix socket (ControlProtocol::lines). Waits at most `patience` for an
/// answer of one line. Refuses programs of other users, by the user that the kernel reports for the peer. `message` has
/// no line ends. Blocks. Any thread.
[[nodiscard]] std::variant<std::string, ControlCallError> call_control(const std::string& path,
                                                                       const std::string& token,
                                                                       const std::string& message,
                                                                       std::chrono::milliseconds patience);

}  // namespace gs::net
