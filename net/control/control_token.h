#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace gs::net {

/// Makes a token that clients must know: 128 random bits as 32 hexadecimal digits.
[[nodiscard]] std::string make_control_token();
/// Compares two texts. The time does not depend on the position of the first difference.
[[nodiscard]] bool same_secret(std::string_view a, std::string_view b);
/// Writes the token and a line end into a file that only the user may read (mode 0600). Replaces only such a file.
/// Returns the error, or nullopt.
[[nodiscard]] std::optional<std::string> write_control_token(const std::string& path, const std::string& token);

}  // namespace gs::net
