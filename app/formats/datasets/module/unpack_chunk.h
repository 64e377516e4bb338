#pragma once

#include "app/formats/datasets/arrays/array_file.h"

#include <cstddef>
#include <span>

namespace gs::app {

/// See DatasetModule::unpack.
[[nodiscard]] bool unpack_chunk(ChunkCodec codec, std::span<const std::byte> from, std::span<std::byte> to);

}  // namespace gs::app
