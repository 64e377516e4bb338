#pragma once

#include <chrono>
#include <string>
#include <variant>

namespace gs::net {

/// Why a program that is controlled could not be told something.
struct ControlCallError {
  std::string message;
};

/// Says one message to a program that is controlled by a Unix socket (ControlProtocol::lines), and waits so long for
/// the one line that it answers. Only a program of the same user is told anything: the kernel says whose it is.
/// `message` has no line ends. Blocks; any thread.
[[nodiscard]] std::variant<std::string, ControlCallError> call_control(const std::string& path,
                                                                       const std::string& token,
                                                                       const std::string& message,
                                                                       std::chrono::milliseconds patience);

}  // namespace gs::net
