#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace gs::net {

/// What a client has to know: 128 random bits as 32 hexadecimal digits.
[[nodiscard]] std::string make_control_token();
/// Takes as long wherever texts of one length differ first.
[[nodiscard]] bool same_secret(std::string_view a, std::string_view b);
/// Writes the token and a line end into a file that nobody else may read (mode 0600). Replaces nothing but such a file.
/// What went wrong, if it did.
[[nodiscard]] std::optional<std::string> write_control_token(const std::string& path, const std::string& token);

}  // namespace gs::net
