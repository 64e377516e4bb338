#pragma once

#include "net/base/url.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace gs::net {

/// Account on a machine, as in ssh://USER@HOST:PORT/. An empty user and a missing port mean those of the user's
/// configuration of ssh.
struct SshTarget {
  std::string user, host;
  std::optional<std::uint16_t> port;

  /// Returns the text between "ssh://" and the path.
  [[nodiscard]] std::string text() const;
};

/// Returns the account of an ssh: URL, or an error. Refuses names that ssh or a shell could take for options or
/// commands.
[[nodiscard]] std::variant<SshTarget, std::string> ssh_target_of(const Url& url);

/// Returns the command that serves files over standard input and output. The remote shell splits `program`, which may
/// begin with other programs, such as "srun -N1 ghostspace". Any login shell may run the command.
[[nodiscard]] std::string remote_serve_command(std::string_view program);
/// Returns the error if a text cannot be part of a remote command; nullopt if it can.
[[nodiscard]] std::optional<std::string> refuse_remote_program(std::string_view program);

/// Returns the arguments of ssh after its name, for a command or, if it is empty, for SFTP. In `batch` mode, ssh asks
/// no questions.
[[nodiscard]] std::vector<std::string> ssh_arguments(const SshTarget& target, const std::string& command, bool batch);

/// Reports whether ssh could not ask the user anything: there is no terminal and no display.
[[nodiscard]] bool ssh_cannot_ask();

}  // namespace gs::net
