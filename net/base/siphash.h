#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace gs::net {

using SipKey = std::array<std::uint64_t, 2>;

/// Computes SipHash-2-4 (Aumasson and Bernstein, 2012): 64 bits that are unpredictable without the key. The words of
/// the key are little-endian, as in the reference implementation.
[[nodiscard]] std::uint64_t siphash(const SipKey& key, std::span<const std::byte> bytes);

}  // namespace gs::net
