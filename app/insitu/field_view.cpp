#include "app/insitu/field_view.h"

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

template <class From>
void convert_to_doubles(const std::byte* from, std::int64_t stride, std::size_t count, double* to) {
  convert_values<From, double>(from, stride, count, reinterpret_cast<std::byte*>(to));
}

struct TypeRow {
  std::int32_t type;
  std::size_t bytes;
  qnv::VoxelType stored;
  void (*copy)(const std::byte*, std::int64_t, std::size_t, std::byte*);
  void (*doubles)(const std::byte*, std::int64_t, std::size_t, double*);
};
using qnv::VoxelType;
constexpr std::array<TypeRow, 10> kInsituTypes{{
    {GS_INSITU_FLOAT32, 4, VoxelType::f32, convert_values<float, float>, convert_to_doubles<float>},
    {GS_INSITU_FLOAT64, 8, VoxelType::f32, convert_values<double, float>, convert_to_doubles<double>},
    {GS_INSITU_INT8, 1, VoxelType::i8, convert_values<std::int8_t, std::int8_t>, convert_to_doubles<std::int8_t>},
    {GS_INSITU_UINT8, 1, VoxelType::u8, convert_values<std::uint8_t, std::uint8_t>, convert_to_doubles<std::uint8_t>},
    {GS_INSITU_INT16, 2, VoxelType::i16, convert_values<std::int16_t, std::int16_t>, convert_to_doubles<std::int16_t>},
    {GS_INSITU_UINT16, 2, VoxelType::u16, convert_values<std::uint16_t, std::uint16_t>,
     convert_to_doubles<std::uint16_t>},
    {GS_INSITU_INT32, 4, VoxelType::i32, convert_values<std::int32_t, std::int32_t>, convert_to_doubles<std::int32_t>},
    {GS_INSITU_UINT32, 4, VoxelType::u32, convert_values<std::uint32_t, std::uint32_t>,
     convert_to_doubles<std::uint32_t>},
    {GS_INSITU_INT64, 8, VoxelType::f32, convert_values<std::int64_t, float>, convert_to_doubles<std::int64_t>},
    {GS_INSITU_UINT64, 8, VoxelType::f32, convert_values<std::uint64_t, float>, convert_to_doubles<std::uint64_t>},
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
