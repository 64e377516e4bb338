#pragma once

#include "app/insitu/include/ghostspace/insitu.h"
#include "qnv/sampling/volume/voxel_type.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>

namespace gs::app::insitu {

/// Maximum length of names and units of fields, in bytes.
inline constexpr std::size_t kMaxNameBytes = 63;
inline constexpr std::uint32_t kMaxComponents = 9;

/// View of an array of the caller, with strides in bytes.
struct FieldView {
  std::string name, unit;
  const std::byte* data = nullptr;
  std::int32_t type = GS_INSITU_FLOAT32;
  bool of_cells = false;
  std::uint32_t components = 1;
  std::array<std::int64_t, 4> strides{};  // along x, y, z, and of components

  /// Returns the address of component `c` of the element at the indices x, y, z of the array.
  [[nodiscard]] const std::byte* at(std::int64_t x, std::int64_t y, std::int64_t z, std::uint32_t c) const {
    return data + x * strides[0] + y * strides[1] + z * strides[2] + std::int64_t{c} * strides[3];
  }
};

/// Checks a field, and completes its strides for an array of `sizes` elements. Returns the problem if it is invalid.
[[nodiscard]] std::variant<FieldView, std::string> field_view(const gs_insitu_field& field,
                                                              const std::array<std::int64_t, 3>& sizes);

/// Returns the number of bytes of a value; 0 for an unknown type.
[[nodiscard]] std::size_t bytes_of(std::int32_t type);
/// Returns the type of the values in streams. Values of 64 bits become 32-bit floats.
[[nodiscard]] qnv::VoxelType stored_type(std::int32_t type);

/// Copies `count` values that are `stride` bytes apart, and converts them to stored_type(type).
void copy_values(std::int32_t type, const std::byte* from, std::int64_t stride, std::size_t count, std::byte* to);
/// Copies `count` values that are `stride` bytes apart, and converts them to float.
void copy_floats(std::int32_t type, const std::byte* from, std::int64_t stride, std::size_t count, float* to);
/// Copies `count` values that are `stride` bytes apart, and converts them to double.
void copy_doubles(std::int32_t type, const std::byte* from, std::int64_t stride, std::size_t count, double* to);

}  // namespace gs::app::insitu
