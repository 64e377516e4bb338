#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::qnv {

/// A stream as it would arrive if this share (0..1) of its packets were lost: every chunk of clusters is one packet,
/// records travel 1,200 bytes at a time. The chunks that begin in the first 16,000 bytes, on which all others build,
/// count as protected by the transport; the directory, whose offsets would be wrong, is left out. The same packets for
/// the same seed. Bytes that are no QNV stream come back as they are. Safe for untrusted bytes.
[[nodiscard]] std::vector<std::byte> drop_packets(std::span<const std::byte> stream, double share, std::uint64_t seed);

}  // namespace gs::qnv
