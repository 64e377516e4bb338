#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gs::net {

/// SHA-1 (RFC 3174). The handshake of WebSockets asks for it (RFC 6455 4.2.2), where nothing depends on its strength.
[[nodiscard]] std::array<std::byte, 20> sha1(std::string_view text);
/// Base64 (RFC 4648 4), with padding.
[[nodiscard]] std::string base64(std::span<const std::byte> bytes);
/// Nothing for what is no base64, or not as `base64` writes it.
[[nodiscard]] std::optional<std::vector<std::byte>> base64_bytes(std::string_view text);
/// Whether every byte belongs to a character of UTF-8 (RFC 3629).
[[nodiscard]] bool is_utf8(std::string_view text);

}  // namespace gs::net
