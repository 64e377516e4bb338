#pragma once

#include <chrono>
#include <string>
#include <variant>

namespace gs::net {

/// Reason why a controlled program could not be reached.
struct ControlCallError {
  std::string message;
};

/// Sends one message to a controlled program on a Unix socket (ControlProtocol::lines), and waits at most `patience`
/// for its answer of one line. Refuses programs of other users, as the kernel reports the peer's user. `message` has no
/// line ends. Blocks. Any thread.
[[nodiscard]] std::variant<std::string, ControlCallError> call_control(const std::string& path,
                                                                       const std::string& token,
                                                                       const std::string& message,
                                                                       std::chrono::milliseconds patience);

}  // namespace gs::net
