#include "app/formats/common/text_cursor.h"
#include "app/formats/volume/volume_common.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

// Reader of AVS fields (AVS Developer's Guide, release 4, "AVS Field"). A file has an ASCII header, two form feeds,
// interleaved voxel values, then coordinates. If the header has no form feeds, it names separate files.

namespace gs::app {
namespace {

struct FieldHeader {
  double dimensions = 0, components = 1;
  std::array<double, 3> sizes{1, 1, 1};
  std::string data, field = "uniform";
  std::vector<double> lower, upper;  // values of min_ext and max_ext
  std::string file;                  // file of variable 1, if the data are in separate files
  double skip = 0, stride = 1;
  std::string file_type = "binary";
  std::optional<std::size_t> end;  // offset of the data, if they are in this file
};

struct AvsFieldType {
  StoredType type = StoredType::u8;
  bool big_endian = false;
};

std::optional<AvsFieldType> avs_field_type_of(std::string_view name) {
  const bool xdr = name.starts_with("xdr_");
  if (xdr) name.remove_prefix(4);
  if (name == "byte") return AvsFieldType{StoredType::u8, false};
  if (name == "short") return AvsFieldType{StoredType::i16, xdr};
  if (name == "integer" || name == "int") return AvsFieldType{StoredType::i32, xdr};
  if (name == "float") return AvsFieldType{StoredType::f32, xdr};
  if (name == "double") return AvsFieldType{StoredType::f64, xdr};
  return std::nullopt;
}

// Parses the rest of a line "variable 1 file=name filetype=binary skip=512".
void read_variable(std::string_view text, FieldHeader& header) {
  TextCursor words(text.data(), text.data() + text.size());
  while (words.skip_space()) {
    const std::string_view word = words.word();
    const std::size_t equals = word.find('=');
    if (equals == std::string_view::npos) continue;
    const std::string key = lower_case(word.substr(0, equals));
    const std::string_view value = word.substr(equals + 1);
    const std::vector<double> numbers = numbers_of(value, 1);
    if (key == "file") header.file = value;
    if (key == "filetype") header.file_type = lower_case(value);
    if (key == "skip" && !numbers.empty()) header.skip = numbers[0];
    if (key == "stride" && !numbers.empty()) header.stride = numbers[0];
  }
}

void read_line(std::string_view line, FieldHeader& header, qnv::VolumeLayout& layout) {
  const std::string_view text = trimmed(line.substr(0, line.find('#')));
  if (lower_case(text.substr(0, 8)) == "variable") {
    if (numbers_of(text.substr(8), 1) == std::vector<double>{1}) read_variable(text.substr(8), header);
    return;
  }
  const std::size_t equals = text.find('=');
  if (equals == std::string_view::npos) return;
  const std::string key = lower_case(trimmed(text.substr(0, equals)));
  const std::string_view value = trimmed(text.substr(equals + 1));
  const std::vector<double> numbers = numbers_of(value, 16);
  const double number = numbers.empty() ? 0 : numbers[0];
  if (key == "ndim") header.dimensions = number;
  if (key == "dim1") header.sizes[0] = number;
  if (key == "dim2") header.sizes[1] = number;
  if (key == "dim3") header.sizes[2] = number;
  if (key == "veclen") header.components = number;
  if (key == "data") header.data = lower_case(value);
  if (key == "field") header.field = lower_case(value);
  if (key == "min_ext") header.lower = numbers;
  if (key == "max_ext") header.upper = numbers;
  if (key == "label" || key == "unit") add_metadata(layout, key == "unit" ? "units" : key, value);
}

FieldHeader read_avs_field_header(std::span<const std::byte> bytes, qnv::VolumeLayout& layout) {
  FieldHeader header;
  constexpr std::size_t kMaxHeader = std::size_t{1} << 20;
  std::string_view text = text_of(bytes.first(std::min(bytes.size(), kMaxHeader)));
  const std::size_t feeds = text.find("\f\f");
  if (feeds != std::string_view::npos) {
    header.end = feeds + 2;
    text = text.substr(0, feeds);
  }
  TextCursor cursor(text.data(), text.data() + text.size());
  while (!cursor.at_end()) read_line(cursor.line(), header, layout);
  return header;
}

/// Lowest and highest coordinate of each axis; empty if unknown.
struct Extent {
  std::vector<double> lower, upper;
};

// Reads the coordinates: floats after the voxels. A uniform field has the minimum and maximum of each axis. A
// rectilinear field has all x, then all y, then all z, of which only the first and last are used.
Extent read_coordinates(const FieldHeader& header, const StoredVoxels& voxels, std::uint64_t size, bool big_endian) {
  const std::span<const std::byte> bytes = voxels.content.bytes;
  std::uint64_t offset = voxels.offset + size;
  const auto value_at = [&](std::uint64_t at) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, bytes.data() + at, sizeof(bits));
    if (big_endian != (std::endian::native == std::endian::big)) bits = __builtin_bswap32(bits);
    return static_cast<double>(std::bit_cast<float>(bits));
  };
  Extent extent;
  for (std::size_t i = 0; i < static_cast<std::size_t>(header.dimensions); ++i) {
    const std::uint64_t count = header.field == "uniform" ? 2 : static_cast<std::uint64_t>(header.sizes[i]);
    if (offset > bytes.size() || (bytes.size() - offset) / 4 < count) return {};
    extent.lower.push_back(value_at(offset));
    extent.upper.push_back(value_at(offset + 4 * (count - 1)));
    offset += 4 * count;
  }
  return extent;
}

// Places the first and last voxel of each axis at the ends of the extent. Returns false if the extent is unknown or
// implausible.
bool place(const FieldHeader& header, const Extent& extent, qnv::VolumeLayout& layout) {
  const auto axes = static_cast<std::size_t>(header.dimensions);
  if (extent.lower.size() < axes || extent.upper.size() < axes) return false;
  qnv::VolumeLayout placed;
  for (std::size_t i = 0; i < axes; ++i) {
    constexpr double kMin = 1e-15, kMax = 1e15;
    const double lower = extent.lower[i], upper = extent.upper[i];
    if (!(std::abs(lower) < kMax && std::abs(upper) < kMax)) return false;
    placed.origin[static_cast<int>(i)] = lower;
    if (header.sizes[i] < 2) continue;
    const double step = (upper - lower) / (header.sizes[i] - 1);
    if (!(std::abs(step) > kMin)) return false;
    placed.axes[i] *= static_cast<float>(step);
  }
  layout.origin = placed.origin;
  layout.axes = placed.axes;
  return true;
}

std::variant<StoredVoxels, std::string> voxels_of(const VolumeFile& file, const FieldHeader& header,
                                                  AvsFieldType type) {
  StoredVoxels voxels;
  voxels.type = type.type;
  voxels.big_endian = type.big_endian;
  voxels.content = file.content;
  if (header.end) {
    voxels.offset = *header.end;
    return voxels;
  }
  if (header.file.empty())
    return std::string("the header has no end; expected two form feeds or a line `variable 1 file=...`");
  const bool unformatted = header.file_type == "unformatted";
  if (header.file_type != "binary" && !unformatted)
    return "variable 1 is of the file type '" + header.file_type.substr(0, 80) + "'; expected binary or unformatted";
  BytesResult loaded = load_beside(file, header.file);
  if (auto* problem = std::get_if<std::string>(&loaded)) return std::move(*problem);
  voxels.content = std::get<SharedBytes>(std::move(loaded));
  if (!(header.skip >= 0 && header.skip < 1e15)) return std::string("the skip of variable 1 is not a number of bytes");
  constexpr std::uint64_t kRecordMark = 4;  // size in bytes of the record mark that Fortran writes
  voxels.offset = static_cast<std::uint64_t>(header.skip) + (unformatted ? kRecordMark : 0);
  return voxels;
}

}  // namespace

bool is_avs_field(std::span<const std::byte> bytes) { return text_of(bytes).starts_with("# AVS"); }

VolumeResult open_avs_field(const VolumeFile& file) {
  if (!is_avs_field(file.content.bytes)) return std::string("the file does not begin with '# AVS field file'");
  qnv::VolumeLayout layout;
  const FieldHeader header = read_avs_field_header(file.content.bytes, layout);
  if (header.field != "uniform" && header.field != "rectilinear")
    return "the field is '" + header.field.substr(0, 80) + "'; expected uniform or rectilinear";
  const std::optional<AvsFieldType> type = avs_field_type_of(header.data);
  if (!type)
    return "data is '" + header.data.substr(0, 80) +
           "'; expected byte, short, integer, float or double, or xdr_ and these";
  if (!(header.dimensions >= 1 && header.dimensions <= 3) || header.dimensions != std::floor(header.dimensions))
    return std::string("ndim is not 1, 2 or 3");
  const auto dimensions = dimensions_of(std::span(header.sizes).first(static_cast<std::size_t>(header.dimensions)));
  if (!dimensions) return std::string("dim1, dim2 or dim3 is missing; expected whole numbers above 0");
  layout.dimensions = *dimensions;
  auto found = voxels_of(file, header, *type);
  if (auto* problem = std::get_if<std::string>(&found)) return std::move(*problem);
  StoredVoxels& voxels = std::get<StoredVoxels>(found);
  const double components = header.end ? header.components : header.stride;
  if (!(components >= 1 && components <= 4096)) return std::string("the veclen or stride is not 1 to 4096");
  voxels.components = static_cast<std::uint64_t>(components);
  voxels.component = file.component;
  const auto size = stored_size(layout, voxels.type, voxels.components);
  if (const auto* problem = std::get_if<std::string>(&size)) return *problem;
  bool placed = false;
  if (header.end) {
    // A native type does not define the byte order of the coordinates. The wrong order gives implausible floats.
    const auto try_order = [&](bool big_endian) {
      return place(header, read_coordinates(header, voxels, std::get<std::uint64_t>(size), big_endian), layout);
    };
    placed = try_order(type->big_endian) || (!type->big_endian && try_order(true));
  }
  if (!placed) (void)place(header, {header.lower, header.upper}, layout);
  return make_source(std::move(layout), std::move(voxels));
}

}  // namespace gs::app
