#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace gs::net {

using SipKey = std::array<std::uint64_t, 2>;

/// SipHash-2-4 (Aumasson and Bernstein, 2012): 64 bits that no one can foretell
/// without the key. The key's words are little-endian as in the reference.
[[nodiscard]] std::uint64_t siphash(const SipKey& key, std::span<const std::byte> bytes);

}  // namespace gs::net
