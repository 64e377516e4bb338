#include "app/formats/datasets/module/hdf5_types.h"

#include <algorithm>
#include <array>

namespace gs::app {
namespace {

constexpr std::size_t kMostParts = 64, kMostAttributes = 256, kMostNumbers = 4096, kMostTextBytes = 1 << 16;

hid_t native_type(NumberType type) {
  switch (type) {
    case NumberType::u8:
      return H5T_NATIVE_UINT8;
    case NumberType::i8:
      return H5T_NATIVE_INT8;
    case NumberType::u16:
      return H5T_NATIVE_UINT16;
    case NumberType::i16:
      return H5T_NATIVE_INT16;
    case NumberType::u32:
      return H5T_NATIVE_UINT32;
    case NumberType::i32:
      return H5T_NATIVE_INT32;
    case NumberType::f32:
      return H5T_NATIVE_FLOAT;
    case NumberType::u64:
      return H5T_NATIVE_UINT64;
    case NumberType::i64:
      return H5T_NATIVE_INT64;
    default:
      return H5T_NATIVE_DOUBLE;
  }
}

struct ScalarType {
  NumberType type = NumberType::none;
  std::string name;
};

ScalarType integer_type(hid_t type) {
  const std::size_t bytes = H5Tget_size(type);
  if (bytes == 0 || bytes > 8) return {};
  const bool has_sign = H5Tget_sign(type) == H5T_SGN_2;
  constexpr NumberType kSigned[] = {NumberType::i8, NumberType::i16, NumberType::i32, NumberType::i64};
  constexpr NumberType kUnsigned[] = {NumberType::u8, NumberType::u16, NumberType::u32, NumberType::u64};
  const std::size_t row = bytes == 1 ? 0 : bytes == 2 ? 1 : bytes <= 4 ? 2 : 3;
  std::string name = (has_sign ? "i" : "u") + std::to_string(bytes * 8);
  if (bytes > 1 && H5Tget_order(type) == H5T_ORDER_BE) name += "be";
  return {has_sign ? kSigned[row] : kUnsigned[row], std::move(name)};
}

/// Returns the type of one number, or none.
ScalarType scalar_type(hid_t type) {
  switch (H5Tget_class(type)) {
    case H5T_INTEGER:
      return integer_type(type);
    case H5T_BITFIELD: {
      ScalarType bits = integer_type(type);
      if (bits.type != NumberType::none && (static_cast<int>(bits.type) & 1) != 0 && bits.type < NumberType::f32)
        bits.type = static_cast<NumberType>(static_cast<int>(bits.type) - 1);
      return bits;
    }
    case H5T_FLOAT: {
      const std::size_t bytes = H5Tget_size(type);
      std::string name = "f" + std::to_string(bytes * 8);
      if (H5Tget_order(type) == H5T_ORDER_BE) name += "be";
      return {bytes <= 4 ? NumberType::f32 : NumberType::f64, std::move(name)};
    }
    case H5T_ENUM: {
      const Hdf5Handle base(H5Tget_super(type), H5Tclose);
      ScalarType number = base ? integer_type(base.get()) : ScalarType{};
      number.name = "enum " + number.name;
      return number;
    }
    default:
      return {};
  }
}

std::string member_name(hid_t type, unsigned member) {
  char* const name = H5Tget_member_name(type, member);
  std::string text = name ? name : "";
  if (name) (void)H5free_memory(name);
  return text;
}

void describe_compound(hid_t type, ArrayInfo& array) {
  const int members = H5Tget_nmembers(type);
  if (members <= 0 || static_cast<std::size_t>(members) > kMostParts) return;
  NumberType common = NumberType::none;
  std::string names, first;
  for (unsigned i = 0; i < static_cast<unsigned>(members); ++i) {
    const Hdf5Handle member(H5Tget_member_type(type, i), H5Tclose);
    const ScalarType number = member ? scalar_type(member.get()) : ScalarType{};
    if (number.type == NumberType::none) {
      array.part_names.clear();
      return;
    }
    if (i == 0) first = number.name;
    if (number.name != first) first = "numbers";
    common = i == 0 || common == number.type ? number.type : NumberType::f64;
    array.part_names.push_back(member_name(type, i));
    names += (i == 0 ? "" : ", ") + array.part_names.back();
  }
  array.type = common;
  array.parts = static_cast<std::uint32_t>(members);
  array.type_name = std::to_string(members) + " x " + first + " (" + names + ")";
}

/// Reads an attribute of texts, of fixed or variable length.
std::vector<std::string> read_texts(hid_t attribute, hid_t type, std::size_t count) {
  std::vector<std::string> texts;
  if (H5Tis_variable_str(type) > 0) {
    const Hdf5Handle memory(H5Tcopy(H5T_C_S1), H5Tclose), space(H5Aget_space(attribute), H5Sclose);
    (void)H5Tset_size(memory.get(), H5T_VARIABLE);
    (void)H5Tset_cset(memory.get(), H5Tget_cset(type));
    std::vector<char*> found(count, nullptr);
    if (H5Aread(attribute, memory.get(), found.data()) < 0) return {};
    for (const char* const text : found)
      texts.emplace_back(text ? std::string_view(text).substr(0, kMostTextBytes) : "");
    (void)H5Dvlen_reclaim(memory.get(), space.get(), H5P_DEFAULT, found.data());
    return texts;
  }
  const std::size_t bytes = H5Tget_size(type);
  if (bytes == 0 || bytes > kMostTextBytes || count > kMostTextBytes / bytes) return {};
  std::string all(bytes * count, '\0');
  if (H5Aread(attribute, type, all.data()) < 0) return {};
  for (std::size_t i = 0; i < count; ++i) {
    const std::string_view one = std::string_view(all).substr(i * bytes, bytes);
    texts.emplace_back(one.substr(0, one.find('\0')));
  }
  return texts;
}

}  // namespace

void describe_hdf5_type(hid_t type, ArrayInfo& array) {
  const H5T_class_t kind = H5Tget_class(type);
  if (ScalarType number = scalar_type(type); number.type != NumberType::none) {
    array.type = number.type;
    array.type_name = std::move(number.name);
    return;
  }
  if (kind == H5T_COMPOUND) describe_compound(type, array);
  if (kind == H5T_ARRAY) {
    const Hdf5Handle base(H5Tget_super(type), H5Tclose);
    const ScalarType number = base ? scalar_type(base.get()) : ScalarType{};
    const std::size_t size = base ? H5Tget_size(base.get()) : 0;
    const std::size_t parts = size > 0 ? H5Tget_size(type) / size : 0;
    if (number.type != NumberType::none && parts > 0 && parts <= kMostParts) {
      array.type = number.type;
      array.parts = static_cast<std::uint32_t>(parts);
      array.type_name = std::to_string(parts) + " x " + number.name;
    }
  }
  if (array.type != NumberType::none) return;
  array.type_name = kind == H5T_STRING      ? "text"
                    : kind == H5T_COMPOUND  ? "record"
                    : kind == H5T_VLEN      ? "lists"
                    : kind == H5T_REFERENCE ? "references"
                                            : "other";
}

Hdf5Handle hdf5_memory_type(hid_t type, const ArrayInfo& array) {
  const hid_t number = native_type(array.type);
  if (array.parts == 1 && H5Tget_class(type) != H5T_COMPOUND && H5Tget_class(type) != H5T_ARRAY) {
    // Enumerations convert only to enumerations; their numbers are read as they are.
    if (H5Tget_class(type) == H5T_ENUM) {
      return {H5Tget_native_type(type, H5T_DIR_DEFAULT), H5Tclose};
    }
    return {H5Tcopy(number), H5Tclose};
  }
  if (H5Tget_class(type) == H5T_ARRAY) {
    std::array<hsize_t, H5S_MAX_RANK> dimensions{};
    const int rank = H5Tget_array_dims2(type, dimensions.data());
    if (rank <= 0) return {};
    return {H5Tarray_create2(number, static_cast<unsigned>(rank), dimensions.data()), H5Tclose};
  }
  const std::size_t size = size_of(array.type);
  Hdf5Handle made(H5Tcreate(H5T_COMPOUND, size * array.parts), H5Tclose);
  for (std::size_t i = 0; made && i < array.part_names.size(); ++i)
    if (H5Tinsert(made.get(), array.part_names[i].c_str(), i * size, number) < 0) return {};
  return made;
}

std::vector<ArrayAttribute> hdf5_attributes(hid_t object) {
  std::vector<ArrayAttribute> all;
  const int count = H5Aget_num_attrs(object);
  for (int i = 0; i < count && all.size() < kMostAttributes; ++i) {
    const Hdf5Handle attribute(
        H5Aopen_by_idx(object, ".", H5_INDEX_NAME, H5_ITER_INC, static_cast<hsize_t>(i), H5P_DEFAULT, H5P_DEFAULT),
        H5Aclose);
    if (!attribute) continue;
    const Hdf5Handle type(H5Aget_type(attribute.get()), H5Tclose), space(H5Aget_space(attribute.get()), H5Sclose);
    const hssize_t elements = space ? H5Sget_simple_extent_npoints(space.get()) : -1;
    if (!type || elements < 0 || static_cast<std::size_t>(elements) > kMostNumbers) continue;
    std::array<char, 256> name{};
    if (H5Aget_name(attribute.get(), name.size(), name.data()) <= 0) continue;
    ArrayAttribute one;
    one.name = name.data();
    const H5T_class_t kind = H5Tget_class(type.get());
    if (kind == H5T_STRING) {
      if (elements > 0) one.texts = read_texts(attribute.get(), type.get(), static_cast<std::size_t>(elements));
    } else if (kind == H5T_INTEGER || kind == H5T_FLOAT) {
      one.numbers.resize(static_cast<std::size_t>(elements));
      if (elements > 0 && H5Aread(attribute.get(), H5T_NATIVE_DOUBLE, one.numbers.data()) < 0) continue;
    } else {
      continue;
    }
    all.push_back(std::move(one));
  }
  return all;
}

}  // namespace gs::app
