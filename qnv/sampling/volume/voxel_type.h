#pragma once

#include <cstddef>
#include <cstdint>

namespace gs::qnv {

/// Storage type of a voxel.
enum class VoxelType : std::uint8_t { u8, i8, u16, i16, u32, i32, f32, f64 };
[[nodiscard]] std::size_t size_of(VoxelType type);

}  // namespace gs::qnv
