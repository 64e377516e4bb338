#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace gs::net {

/// Reason why a machine cannot be used by ssh.
struct SshFailure {
  enum class Kind : std::uint8_t {
    refused,      // the host key or the user was not accepted
    unreachable,  // no connection
    broken,       // the connection ended; another attempt may succeed
    unusable,     // the machine or this one lacks a program
    idle          // the connection was ended, because it was not used
  };
  Kind kind = Kind::broken;
  std::string message;  // one line
};

/// Explains the messages of ssh after it has ended with `status` (nullopt: by a signal). `target` is as in
/// SshTarget::text().
[[nodiscard]] SshFailure explain_ssh(std::string_view errors, std::optional<int> status, const std::string& target);

/// Returns the last line of a text, shortened, without control characters.
[[nodiscard]] std::string last_line_of(std::string_view text);
/// Returns a shortened line without control characters.
[[nodiscard]] std::string clean_line(std::string_view line);

/// Exit status of ssh itself; other values are those of the remote command.
inline constexpr int kSshStatus = 255;

}  // namespace gs::net
