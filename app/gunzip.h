#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace gs::app {

/// True for the first bytes of a gzip member (RFC 1952).
[[nodiscard]] bool is_gzip(std::span<const std::byte> bytes);

/// Unpacks gzip members, piece by piece, into `sink`, which may stop it by returning false. All that could
/// be unpacked has been delivered when an error comes back: what is wrong with the data (truncated, bad
/// checksum, more than `limit` bytes). Safe for untrusted input; memory is constant.
[[nodiscard]] std::optional<std::string> gunzip(std::span<const std::byte> bytes, std::size_t limit,
                                                const std::function<bool(std::string_view)>& sink);

}  // namespace gs::app
