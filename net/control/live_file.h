#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>

namespace gs::net {

/// Content of a file with the address of a running simulation's server, for other programs of the user.
struct LiveFile {
  std::string host;  // name of the machine
  std::string bind;  // address at which the server listens, or "*"
  std::uint16_t port = 0;
  std::string token;  // permits changes of parameters
};

/// Writes the file (mode 0600). Replaces only a file of the same kind. Returns the error, or nullopt.
[[nodiscard]] std::optional<std::string> write_live_file(const std::string& path, const LiveFile& file);
/// Reads the file. Returns a message if it is missing or malformed, belongs to another user, or if other users may read
/// it. Safe for untrusted files.
[[nodiscard]] std::variant<LiveFile, std::string> read_live_file(const std::string& path);
/// Returns the host and port at which a program on the machine `here` reaches the server, such as "node17:8123".
/// Returns "" if the server is on another machine and accepts only local connections there.
[[nodiscard]] std::string address_of_live(const LiveFile& file, const std::string& here);
/// Returns the name of this machine.
[[nodiscard]] std::string name_of_machine();

}  // namespace gs::net
