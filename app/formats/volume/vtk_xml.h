#pragma once

#include "app/formats/volume/volume_common.h"
#include "base/budget.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
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

/// Common parts of VTK XML readers: https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html
namespace gs::app {

enum class VtkSection : std::uint8_t {
  point_data,
  cell_data,
  points,
  vertices,
  lines,
  strips,
  polygons,
  cells,
  coordinates  // of the axes of a RectilinearGrid
};

/// DataArray element with the location of its values.
struct VtkArray {
  std::string name, type, format = "ascii", units;
  std::uint64_t components = 1, offset = 0;  // byte offset in the appended data
  std::size_t begin = 0, end = 0;  // byte range of the element's content in the file
  VtkSection section = VtkSection::point_data;
  std::size_t piece = 0;
};

struct VtkPiece {
  std::string extent;
  std::uint64_t points = 0, vertices = 0, lines = 0, strips = 0, polygons = 0, cells = 0;  // counts stated in the file
};

struct VtkXmlHeader {
  std::string type, byte_order = "littleendian", header_type = "uint32", compressor;
  std::string whole_extent, origin, spacing, direction;
  std::string point_scalars, point_normals, cell_scalars;  // names of the active arrays
  std::vector<VtkArray> arrays;  // arrays of all VtkSections, at most 1000
  std::vector<VtkPiece> pieces;
  std::size_t piece_count = 0;  // number of pieces in the file; `pieces` may have fewer
  std::optional<std::size_t> appended;  // offset of the appended data in the file
  bool appended_base64 = false;
};

/// Returns true if a file with these first bytes is VTK XML of the type, such as "ImageData".
[[nodiscard]] bool is_vtk_xml(std::span<const std::byte> bytes, std::string_view type);
/// Parses the elements of a VTK XML file of this type; an empty type allows any. Returns a message on failure. Safe for
/// untrusted bytes.
[[nodiscard]] std::variant<VtkXmlHeader, std::string> read_vtk_xml(std::span<const std::byte> bytes,
                                                                   std::string_view type);
/// Returns the number type for a lower-case type name, or nullopt if the name is not that of a numeric type.
[[nodiscard]] std::optional<StoredType> vtk_type_of(std::string_view name);

/// Returns the first `count` numbers of an array (at most 2^48), decompressed, one component per voxel. Returns a
/// message on failure.
[[nodiscard]] std::variant<StoredVoxels, std::string> vtk_values(const SharedBytes& file, const VtkXmlHeader& header,
                                                                 const VtkArray& array, std::uint64_t count,
                                                                 const WorldBudget& budget);

/// Numbers of the first and the last point along x, y and z: first x, last x, first y, ...
using VtkExtent = std::array<std::int64_t, 6>;
/// Returns the extent in a text of six whole numbers; nullopt if it is damaged or has no points.
[[nodiscard]] std::optional<VtkExtent> vtk_extent(std::string_view text);

/// Positions of the points of an ImageData or RectilinearGrid along its axes. A point is directions * position +
/// origin.
struct VtkGridAxes {
  std::array<std::vector<double>, 3> positions;
  glm::dmat3 directions{1};
  glm::dvec3 origin{0};
  std::string problem;  // message if they cannot be read, or none
};
/// Returns the positions of the points of a piece within an extent.
[[nodiscard]] VtkGridAxes vtk_grid_axes(const SharedBytes& file, const VtkXmlHeader& header, std::size_t piece,
                                        const VtkExtent& extent, const WorldBudget& budget);

/// Returns the number from 0 to 63 of a base64 digit, or -1 for other bytes.
[[nodiscard]] int base64_value(std::byte byte);

/// Compression of the blocks of an array, apart from zlib.
enum class VtkPacking : std::uint8_t { lz4, lzma };
/// Unpacks a block that must fill `to`, with the module for scientific formats. Returns a message on failure.
[[nodiscard]] std::optional<std::string> unpack_vtk_block(VtkPacking packing, std::span<const std::byte> from,
                                                          std::span<std::byte> to);

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

/// Calls `take` with the first `count` numbers, converted to double. If there are fewer numbers, passes all of them.
template <class Take>
void each_number(const StoredVoxels& values, std::uint64_t count, Take take) {
  static_assert(std::endian::native == std::endian::little);
  const std::uint64_t all = values.content.bytes.size();
  if (values.offset > all) return;
  count = std::min<std::uint64_t>(count, (all - values.offset) / size_of(values.type));
  with_stored_type(values.type, [&](auto kind) { each_stored<decltype(kind)>(values, count, take); });
}

}  // namespace gs::app
