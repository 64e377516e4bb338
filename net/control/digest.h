#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gs::net {

/// Computes SHA-1 (RFC 3174). The WebSocket handshake requires it (RFC 6455 4.2.2); security does not depend on it.
[[nodiscard]] std::array<std::byte, 20> sha1(std::string_view text);
/// Encodes bytes as base64 (RFC 4648 4), with padding.
[[nodiscard]] std::string base64(std::span<const std::byte> bytes);
/// Decodes base64. Returns nullopt if `text` is not exactly the text that base64() returns.
[[nodiscard]] std::optional<std::vector<std::byte>> base64_bytes(std::string_view text);
/// Reports whether the text is valid UTF-8 (RFC 3629).
[[nodiscard]] bool is_utf8(std::string_view text);

}  // namespace gs::net
