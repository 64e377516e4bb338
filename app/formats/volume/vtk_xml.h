#pragma once

#include "app/base/world_budget.h"
#include "app/formats/volume/volume_common.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

/// What the readers of VTK's XML files share: https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html
namespace gs::app {

enum class VtkSection : std::uint8_t { point_data, cell_data, points, vertices, lines, strips, polygons, cells };

/// A DataArray, and where its values are.
struct VtkArray {
  std::string name, type, format = "ascii", units;
  std::uint64_t components = 1, offset = 0;  // into the appended data
  std::size_t begin = 0, end = 0;            // of what stands inside the element
  VtkSection section = VtkSection::point_data;
  std::size_t piece = 0;
};

struct VtkPiece {
  std::string extent;
  std::uint64_t points = 0, vertices = 0, lines = 0, strips = 0, polygons = 0, cells = 0;  // as the file says
};

struct VtkXmlHeader {
  std::string type, byte_order = "littleendian", header_type = "uint32", compressor;
  std::string whole_extent, origin, spacing, direction;
  std::string point_scalars, point_normals, cell_scalars;  // names of the active arrays
  std::vector<VtkArray> arrays;                            // of the sections above, the first thousand
  std::vector<VtkPiece> pieces;
  std::size_t piece_count = 0;          // of the file
  std::optional<std::size_t> appended;  // behind the start of the element
  bool appended_base64 = false;
};

/// Whether a file of these first bytes is VTK XML of the type ("ImageData").
[[nodiscard]] bool is_vtk_xml(std::span<const std::byte> bytes, std::string_view type);
/// What the elements of such a file say, or what is wrong. Safe for untrusted bytes.
[[nodiscard]] std::variant<VtkXmlHeader, std::string> read_vtk_xml(std::span<const std::byte> bytes,
                                                                   std::string_view type);
/// By its name in lower case; nothing: it is none of numbers.
[[nodiscard]] std::optional<StoredType> vtk_type_of(std::string_view name);

/// The first `count` numbers (at most 2^48) of an array, unpacked, or why there are none; one component a value.
[[nodiscard]] std::variant<StoredVoxels, std::string> vtk_values(const SharedBytes& file, const VtkXmlHeader& header,
                                                                 const VtkArray& array, std::uint64_t count,
                                                                 const WorldBudget& budget);

template <class T, class Take>
void each_stored(const StoredVoxels& values, std::uint64_t count, Take take) {
  const std::byte* from = values.content.bytes.data() + values.offset;
  for (std::uint64_t i = 0; i < count; ++i, from += sizeof(T)) {
    std::byte raw[sizeof(T)];
    for (std::size_t k = 0; k < sizeof(T); ++k) raw[k] = from[values.big_endian ? sizeof(T) - 1 - k : k];
    T value{};
    std::memcpy(&value, raw, sizeof value);
    take(static_cast<double>(value));
  }
}

/// Hands the first numbers over as doubles, `count` of them or as many as are there.
template <class Take>
void each_number(const StoredVoxels& values, std::uint64_t count, Take take) {
  static_assert(std::endian::native == std::endian::little);
  const std::uint64_t all = values.content.bytes.size();
  if (values.offset > all) return;
  count = std::min<std::uint64_t>(count, (all - values.offset) / size_of(values.type));
  switch (values.type) {
    case StoredType::u8:
      return each_stored<std::uint8_t>(values, count, take);
    case StoredType::i8:
      return each_stored<std::int8_t>(values, count, take);
    case StoredType::u16:
      return each_stored<std::uint16_t>(values, count, take);
    case StoredType::i16:
      return each_stored<std::int16_t>(values, count, take);
    case StoredType::u32:
      return each_stored<std::uint32_t>(values, count, take);
    case StoredType::i32:
      return each_stored<std::int32_t>(values, count, take);
    case StoredType::f32:
      return each_stored<float>(values, count, take);
    case StoredType::f64:
      return each_stored<double>(values, count, take);
    case StoredType::u64:
      return each_stored<std::uint64_t>(values, count, take);
    case StoredType::i64:
      return each_stored<std::int64_t>(values, count, take);
  }
}

}  // namespace gs::app
