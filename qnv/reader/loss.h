#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::qnv {

/// Simulates packet loss on a stream. Returns the stream without a random `share` (0..1) of its packets. A chunk with a
/// cluster or with parity is one packet; records are divided into packets of 1,200 bytes. Chunks that start in the
/// first 16,000 bytes are never dropped: all others depend on them, and transports protect them. The directory is
/// always dropped, because its offsets would be wrong. Equal seeds drop the same packets. Returns bytes unchanged if
/// they are not a QNV stream. Safe for untrusted bytes.
[[nodiscard]] std::vector<std::byte> drop_packets(std::span<const std::byte> stream, double share, std::uint64_t seed);

}  // namespace gs::qnv
