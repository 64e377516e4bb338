#pragma once

#include "qnv/container/container.h"
#include "qnv/sampling/volume/volume_values.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <variant>

namespace gs::qnv {

/// Bytes of a stream at any offset, for example of a file.
struct StreamBytes {
  std::uint64_t size = 0;
  /// Function that copies bytes from an offset on. It returns false on failure. Several threads call it.
  std::function<bool(std::uint64_t offset, std::span<std::byte> to)> read;
};

/// Opens a stream of values of a volume that may be larger than memory. Decodes its slices when they are read, fastest
/// in order. Needs memory for about 60 slices of 4 bytes per voxel, and 24 bytes per chunk. `bytes` must stay valid as
/// long as the result. Returns the problem for other streams, and for volumes of an unsupported size. `header` gets the
/// header if it is not null. Safe for untrusted bytes.
[[nodiscard]] std::variant<std::shared_ptr<const VolumeValues>, StreamProblem> open_values_slices(
    StreamBytes bytes, StreamHeader* header = nullptr);

}  // namespace gs::qnv
