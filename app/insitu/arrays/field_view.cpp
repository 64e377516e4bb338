#include "app/insitu/arrays/field_view.h"

#include "app/insitu/bricks/quantise.h"

#include <cstring>

namespace gs::app::insitu {
namespace {

template <class From, class To>
void convert_values(const std::byte* from, std::int64_t stride, std::size_t count, std::byte* to) {
  if constexpr (sizeof(From) == sizeof(To)) {
    if (stride == static_cast<std::int64_t>(sizeof(From))) {
      std::memcpy(to, from, count * sizeof(From));
      return;
    }
  }
  for (std::size_t i = 0; i < count; ++i, from += stride, to += sizeof(To)) {
    From value;
    std::memcpy(&value, from, sizeof value);
    const To converted = static_cast<To>(value);
    std::memcpy(to, &converted, sizeof converted);
  }
}

// Converts doubles to floats, several at a time if they are contiguous.
void narrow_doubles(const std::byte* from, std::int64_t stride, std::size_t count, std::byte* to) {
  const bool aligned = reinterpret_cast<std::uintptr_t>(from) % alignof(double) == 0 &&
                       reinterpret_cast<std::uintptr_t>(to) % alignof(float) == 0;
  if (stride != sizeof(double) || !aligned) return convert_values<double, float>(from, stride, count, to);
  floats_of_doubles(reinterpret_cast<const double*>(from), count, reinterpret_cast<float*>(to));
}

template <class From>
void convert_to_floats(const std::byte* from, std::int64_t stride, std::size_t count, float* to) {
  convert_values<From, float>(from, stride, count, reinterpret_cast<std::byte*>(to));
}

template <class From>
void convert_to_doubles(const std::byte* from, std::int64_t stride, std::size_t count, double* to) {
  convert_values<From, double>(from, stride, count, reinterpret_cast<std::byte*>(to));
}

struct TypeRow {
  std::int32_t type;
  std::size_t bytes;
  qnv::VoxelType stored;
  void (*copy)(const std::byte*, std::int64_t, std::size_t, std::byte*);
  void (*floats)(const std::byte*, std::int64_t, std::size_t, float*);
  void (*doubles)(const std::byte*, std::int64_t, std::size_t, double*);
};
using qnv::VoxelType;
template <class From, class Stored>
constexpr TypeRow row_of_type(std::int32_t type, VoxelType stored) {
  return {type, sizeof(From), stored, convert_values<From, Stored>, convert_to_floats<From>, convert_to_doubles<From>};
}
constexpr TypeRow kDoubleRow{GS_INSITU_FLOAT64,
                             sizeof(double),
                             VoxelType::f32,
                             narrow_doubles,
                             [](const std::byte* from, std::int64_t stride, std::size_t count, float* to) {
                               narrow_doubles(from, stride, count, reinterpret_cast<std::byte*>(to));
                             },
                             convert_to_doubles<double>};
constexpr std::array<TypeRow, 10> kInsituTypes{{
    row_of_type<float, float>(GS_INSITU_FLOAT32, VoxelType::f32),
    kDoubleRow,
    row_of_type<std::int8_t, std::int8_t>(GS_INSITU_INT8, VoxelType::i8),
    row_of_type<std::uint8_t, std::uint8_t>(GS_INSITU_UINT8, VoxelType::u8),
    row_of_type<std::int16_t, std::int16_t>(GS_INSITU_INT16, VoxelType::i16),
    row_of_type<std::uint16_t, std::uint16_t>(GS_INSITU_UINT16, VoxelType::u16),
    row_of_type<std::int32_t, std::int32_t>(GS_INSITU_INT32, VoxelType::i32),
    row_of_type<std::uint32_t, std::uint32_t>(GS_INSITU_UINT32, VoxelType::u32),
    row_of_type<std::int64_t, float>(GS_INSITU_INT64, VoxelType::f32),
    row_of_type<std::uint64_t, float>(GS_INSITU_UINT64, VoxelType::f32),
}};

const TypeRow* type_row(std::int32_t type) {
  for (const TypeRow& row : kInsituTypes)
    if (row.type == type) return &row;
  return nullptr;
}

}  // namespace

std::size_t bytes_of(std::int32_t type) {
  const TypeRow* const row = type_row(type);
  return row ? row->bytes : 0;
}

qnv::VoxelType stored_type(std::int32_t type) {
  const TypeRow* const row = type_row(type);
  return row ? row->stored : VoxelType::f32;
}

void copy_values(std::int32_t type, const std::byte* from, std::int64_t stride, std::size_t count, std::byte* to) {
  if (const TypeRow* const row = type_row(type)) row->copy(from, stride, count, to);
}

void copy_floats(std::int32_t type, const std::byte* from, std::int64_t stride, std::size_t count, float* to) {
  if (const TypeRow* const row = type_row(type)) row->floats(from, stride, count, to);
}

void copy_doubles(std::int32_t type, const std::byte* from, std::int64_t stride, std::size_t count, double* to) {
  if (const TypeRow* const row = type_row(type)) row->doubles(from, stride, count, to);
}

std::variant<FieldView, std::string> field_view(const gs_insitu_field& field,
                                                const std::array<std::int64_t, 3>& sizes) {
  if (!field.name || !*field.name) return "a field has no name; expected a text";
  FieldView view;
  view.name = field.name;
  if (field.unit) view.unit = field.unit;
  const std::string named = "field '" + view.name + "': ";
  if (view.name.size() > kMaxNameBytes || view.unit.size() > kMaxNameBytes)
    return named + "the name or unit is too long; expected at most 63 bytes";
  view.type = field.type;
  view.of_cells = field.association == GS_INSITU_CELLS;
  view.data = static_cast<const std::byte*>(field.data);
  const auto bytes = static_cast<std::int64_t>(bytes_of(field.type));
  if (bytes == 0) return named + "unknown type " + std::to_string(field.type) + "; expected a gs_insitu_type";
  if (field.association != GS_INSITU_POINTS && field.association != GS_INSITU_CELLS)
    return named + "unknown association; expected GS_INSITU_POINTS or GS_INSITU_CELLS";
  if (field.components < 0 || field.components > static_cast<std::int32_t>(kMaxComponents))
    return named + std::to_string(field.components) + " components; expected 1 to 9";
  view.components = field.components == 0 ? 1 : static_cast<std::uint32_t>(field.components);
  if (!view.data && sizes[0] * sizes[1] * sizes[2] > 0) return named + "the array is missing; expected its address";
  for (std::size_t i = 0; i < view.strides.size(); ++i) view.strides[i] = field.strides[i];
  if (view.strides == std::array<std::int64_t, 4>{}) {
    const std::int64_t element = bytes * view.components;
    view.strides = {element, element * sizes[0], element * sizes[0] * sizes[1], bytes};
  }
  return view;
}

}  // namespace gs::app::insitu
