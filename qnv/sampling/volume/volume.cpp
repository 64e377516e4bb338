#include "base/nth_type.h"
#include "qnv/sampling/volume/volume_slices.h"

#include "base/finite.h"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <type_traits>

namespace gs::qnv {
namespace {

constexpr std::uint64_t kMaxVolumeVoxels = std::uint64_t{1} << 48;
constexpr std::uint64_t kMaxSliceVoxels = std::uint64_t{1} << 34;

template <class T>
T swapped(T value) {
  if constexpr (sizeof(T) == 1) {
    return value;
  } else if constexpr (sizeof(T) == 2) {
    return std::bit_cast<T>(__builtin_bswap16(std::bit_cast<std::uint16_t>(value)));
  } else if constexpr (sizeof(T) == 4) {
    return std::bit_cast<T>(__builtin_bswap32(std::bit_cast<std::uint32_t>(value)));
  } else {
    return std::bit_cast<T>(__builtin_bswap64(std::bit_cast<std::uint64_t>(value)));
  }
}

// One loop per combination of parameters, without `if` inside, so that the compiler vectorises it.
template <class T, bool swap, bool scaled, bool gaps>
void convert(const std::byte* from, float* to, std::size_t count, const VolumeLayout& layout) {
  constexpr double most = std::numeric_limits<float>::max();
  const double slope = layout.slope, intercept = layout.intercept;
  const double missing = layout.missing.value_or(std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < count; ++i) {
    T stored;
    std::memcpy(&stored, from + i * sizeof(T), sizeof(T));
    if constexpr (swap) stored = swapped(stored);
    if constexpr (!scaled && !gaps) {
      to[i] = static_cast<float>(stored);
    } else {
      const auto exact = static_cast<double>(stored);
      const double value = scaled ? exact * slope + intercept : exact;
      const bool there = exact != missing && value >= -most && value <= most;
      to[i] = there ? static_cast<float>(there ? value : 0.0) : kMissing;
    }
  }
}

template <class T>
void convert(const std::byte* from, float* to, std::size_t count, const VolumeLayout& layout) {
  const bool swap = layout.big_endian != (std::endian::native == std::endian::big);
  const bool scaled = layout.slope != 1 || layout.intercept != 0;
  const bool gaps = scaled || may_miss(layout);
  if (swap) {
    if (scaled) return convert<T, true, true, true>(from, to, count, layout);
    return gaps ? convert<T, true, false, true>(from, to, count, layout)
                : convert<T, true, false, false>(from, to, count, layout);
  }
  if (scaled) return convert<T, false, true, true>(from, to, count, layout);
  return gaps ? convert<T, false, false, true>(from, to, count, layout)
              : convert<T, false, false, false>(from, to, count, layout);
}

}  // namespace

std::size_t size_of(VoxelType type) {
  switch (type) {
    case VoxelType::u8:
    case VoxelType::i8:
      return 1;
    case VoxelType::u16:
    case VoxelType::i16:
      return 2;
    case VoxelType::u32:
    case VoxelType::i32:
    case VoxelType::f32:
      return 4;
    case VoxelType::f64:
      break;
  }
  return 8;
}

std::optional<VolumeError> check(const VolumeLayout& layout) {
  const auto [x, y, z] = layout.dimensions;
  const std::string size = std::to_string(x) + " x " + std::to_string(y) + " x " + std::to_string(z);
  if (x == 0 || y == 0 || z == 0) return VolumeError{"the volume has " + size + " voxels; expected at least one"};
  const std::uint64_t slice = std::uint64_t{x} * y;
  if (slice > kMaxSliceVoxels || slice > kMaxVolumeVoxels / z)
    return VolumeError{"the volume has " + size + " voxels; expected at most 2^34 a slice and 2^48 in all"};
  if (layout.type > VoxelType::f64) return VolumeError{"the volume has an unknown type"};
  if (!std::isfinite(layout.slope) || !std::isfinite(layout.intercept))
    return VolumeError{"the slope or intercept of the volume's values is not finite"};
  if (!finite(layout.origin) || !finite(layout.base)) return VolumeError{"the origin of the volume is not finite"};
  constexpr double kMinStep = 1e-15, kMaxStep = 1e15, kFarthest = 1e18;  // beyond these limits, areas overflow float
  if (glm::length(layout.origin + layout.base) > kFarthest)
    return VolumeError{"the origin of the volume is more than 1e18 from the origin of the world"};
  for (const glm::vec3& axis : layout.axes) {
    if (!finite(axis)) return VolumeError{"an axis of the volume is not finite"};
    const double step = glm::length(glm::dvec3(axis));
    if (step < kMinStep || step > kMaxStep)
      return VolumeError{"a voxel of the volume is not between 1e-15 and 1e15 long"};
  }
  const glm::dmat3 axes(layout.axes[0], layout.axes[1], layout.axes[2]);
  const double lengths = glm::length(axes[0]) * glm::length(axes[1]) * glm::length(axes[2]);
  constexpr double least = 1e-6;  // minimum volume relative to a cuboid; flatter voxels have no useful gradients
  if (!(std::abs(glm::determinant(axes)) > least * lengths))
    return VolumeError{"the axes of the volume do not span space; expected three independent directions"};
  return std::nullopt;
}

bool may_miss(const VolumeLayout& layout) {
  return layout.missing.has_value() || layout.type == VoxelType::f32 || layout.type == VoxelType::f64 ||
         layout.slope != 1 || layout.intercept != 0;
}

void stored_numbers(const VolumeLayout& layout, std::span<const std::byte> stored, std::span<double> numbers) {
  const std::size_t count = std::min(numbers.size(), stored.size() / size_of(layout.type));
  std::fill(numbers.begin() + static_cast<std::ptrdiff_t>(count), numbers.end(),
            std::numeric_limits<double>::quiet_NaN());
  const bool swap = layout.big_endian != (std::endian::native == std::endian::big);
  constexpr double most = std::numeric_limits<float>::max();
  const double missing = layout.missing.value_or(std::numeric_limits<double>::quiet_NaN());
  with_nth_type<std::uint8_t, std::int8_t, std::uint16_t, std::int16_t, std::uint32_t, std::int32_t, float, double>(
      static_cast<std::size_t>(layout.type), [&]<class T>(T) {
        for (std::size_t i = 0; i < count; ++i) {
          T number;
          std::memcpy(&number, stored.data() + i * sizeof(T), sizeof(T));
          const auto exact = static_cast<double>(swap ? swapped(number) : number);
          const double value = exact * layout.slope + layout.intercept;
          const bool there = exact != missing && value >= -most && value <= most;
          numbers[i] = there ? exact : std::numeric_limits<double>::quiet_NaN();
        }
      });
}

void values_of(const VolumeLayout& layout, std::span<const std::byte> stored, std::span<float> values) {
  const std::size_t count = std::min(values.size(), stored.size() / size_of(layout.type));
  std::fill(values.begin() + static_cast<std::ptrdiff_t>(count), values.end(), kMissing);
  const std::byte* from = stored.data();
  float* to = values.data();
  with_nth_type<std::uint8_t, std::int8_t, std::uint16_t, std::int16_t, std::uint32_t, std::int32_t, float, double>(
      static_cast<std::size_t>(layout.type), [&](auto kind) { convert<decltype(kind)>(from, to, count, layout); });
}

bool read_slice(const VolumeSource& source, std::uint32_t z, std::vector<std::byte>& scratch, std::span<float> values) {
  if (z >= source.layout.dimensions[2] || values.size() != slice_voxels(source.layout) || !source.read) return false;
  scratch.resize(values.size() * size_of(source.layout.type));
  if (!source.read(z, scratch)) return false;
  values_of(source.layout, scratch, values);
  return true;
}

bool lies_in(const VoxelBox& box, const std::array<std::uint32_t, 3>& dimensions) {
  for (std::size_t a = 0; a < 3; ++a) {
    if (box.size[a] == 0 || box.step[a] == 0 || box.first[a] >= dimensions[a]) return false;
    const std::uint64_t last = box.first[a] + (box.size[a] - std::uint64_t{1}) * box.step[a];
    if (last >= dimensions[a]) return false;
  }
  return true;
}

bool read_voxels(const VolumeSource& source, const VoxelBox& box, std::span<std::byte> to) {
  const std::size_t voxel = size_of(source.layout.type);
  if (!lies_in(box, source.layout.dimensions) || to.size() != voxel_count(box) * voxel) return false;
  if (source.read_box) return source.read_box(box, to);
  if (!source.read) return false;
  std::vector<std::byte> slice(slice_voxels(source.layout) * voxel);
  const std::size_t row = source.layout.dimensions[0] * voxel;
  std::byte* next = to.data();
  for (std::uint32_t z = 0; z < box.size[2]; ++z) {
    if (!source.read(box.first[2] + z * box.step[2], slice)) return false;
    for (std::uint32_t y = 0; y < box.size[1]; ++y) {
      const std::byte* from = slice.data() + (box.first[1] + std::size_t{y} * box.step[1]) * row + box.first[0] * voxel;
      for (std::uint32_t x = 0; x < box.size[0]; ++x, from += box.step[0] * voxel, next += voxel)
        std::memcpy(next, from, voxel);
    }
  }
  return true;
}

}  // namespace gs::qnv
