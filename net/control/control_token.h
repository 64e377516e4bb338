#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace gs::net {

/// Makes a random token of 128 bits, as 32 hexadecimal digits. Clients send it to be admitted.
[[nodiscard]] std::string make_control_token();
/// Compares two texts in a time that does not depend on their first difference. Protects secrets against timing
/// attacks.
[[nodiscard]] bool same_secret(std::string_view a, std::string_view b);
/// Writes the token and a line end to a file that only the user may read (mode 0600). Overwrites an existing file only
/// if it is a token file. Returns the error, or nullopt.
[[nodiscard]] std::optional<std::string> write_control_token(const std::string& path, const std::string& token);

/// Writes a text to a file that only the user may read (mode 0600). Replaces an existing file. Returns the error, or
/// nullopt.
[[nodiscard]] std::optional<std::string> write_private_file(const std::string& path, std::string_view text);

/// Returns the usual token file of a simulation on this machine, for the port of its server. The token permits changes
/// of parameters. Returns "" if the user has no folder for the file.
[[nodiscard]] std::string usual_token_file(std::uint16_t port);

}  // namespace gs::net
