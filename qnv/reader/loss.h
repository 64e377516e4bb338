#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::qnv {

/// Simulates packet loss on a stream: returns it without a random `share` (0..1) of its packets. A chunk of clusters is
/// one packet; records travel 1,200 bytes at a time. Chunks that start in the first 16,000 bytes are kept, since all
/// others depend on them and the transport protects them. Drops the directory, because its offsets would be wrong.
/// Equal seeds drop the same packets. Returns bytes that are not a QNV stream unchanged. Safe for untrusted bytes.
[[nodiscard]] std::vector<std::byte> drop_packets(std::span<const std::byte> stream, double share, std::uint64_t seed);

}  // namespace gs::qnv
