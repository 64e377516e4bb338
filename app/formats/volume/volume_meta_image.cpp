#include "app/formats/common/text_cursor.h"
#include "app/formats/volume/volume_common.h"
#include "base/text.h"

#include <algorithm>
#include <cmath>
#include <utility>

// Reader of MetaImage: https://itk.org/Wiki/ITK/MetaIO/Documentation

namespace gs::app {
namespace {

/// Header tags that this reader supports.
struct MetaHeader {
  std::string type, data_file;
  std::vector<double> sizes, spacing, size, origin, matrix;
  double dimensions = 0, channels = 1, header_size = 0;
  bool big_endian = false, binary = true, compressed = false;
  std::size_t end = 0;  // byte offset of the data if their file is LOCAL
};

std::optional<StoredType> meta_image_type_of(std::string_view name) {
  static constexpr std::pair<std::string_view, StoredType> kNames[] = {
      {"met_uchar", StoredType::u8},       {"met_char", StoredType::i8},         {"met_ushort", StoredType::u16},
      {"met_short", StoredType::i16},      {"met_uint", StoredType::u32},        {"met_int", StoredType::i32},
      {"met_ulong", StoredType::u32},      {"met_long", StoredType::i32},        {"met_ulong_long", StoredType::u64},
      {"met_long_long", StoredType::i64},  {"met_float", StoredType::f32},       {"met_double", StoredType::f64},
      {"met_uchar_array", StoredType::u8}, {"met_short_array", StoredType::i16}, {"met_ushort_array", StoredType::u16},
      {"met_float_array", StoredType::f32}};
  return value_named(kNames, name);
}

void read_tag(std::string_view name, std::string_view value, MetaHeader& header, qnv::VolumeLayout& layout) {
  const std::string key = lower_case(name);
  const auto number = [&](double otherwise) {
    const std::vector<double> numbers = numbers_of(value, 1);
    return numbers.empty() ? otherwise : numbers[0];
  };
  const auto yes = [&] { return lower_case(value) == "true" || value == "1"; };
  if (key == "ndims") header.dimensions = number(0);
  if (key == "dimsize") header.sizes = numbers_of(value, 10);
  if (key == "elementtype") header.type = lower_case(value);
  if (key == "elementspacing") header.spacing = numbers_of(value, 10);
  if (key == "elementsize") header.size = numbers_of(value, 10);
  if (key == "offset" || key == "position" || key == "origin") header.origin = numbers_of(value, 10);
  if (key == "transformmatrix" || key == "rotation" || key == "orientation") header.matrix = numbers_of(value, 100);
  if (key == "elementnumberofchannels") header.channels = number(1);
  if (key == "headersize") header.header_size = number(0);
  if (key == "elementbyteordermsb" || key == "binarydatabyteordermsb") header.big_endian = yes();
  if (key == "binarydata") header.binary = yes();
  if (key == "compresseddata") header.compressed = yes();
  if (key == "comment") add_metadata(layout, "comment", value);
  if (key == "name") add_metadata(layout, "title", value);
  if (key == "anatomicalorientation" || key == "modality" || key == "distanceunits") add_metadata(layout, key, value);
  if (key == "elementdatafile") header.data_file = value;
}

MetaHeader read_meta_image_header(std::span<const std::byte> bytes, qnv::VolumeLayout& layout) {
  MetaHeader header;
  constexpr std::size_t kMaxHeader = std::size_t{1} << 20;
  TextCursor cursor(bytes.first(std::min(bytes.size(), kMaxHeader)));
  const char* begin = cursor.next;
  while (!cursor.at_end() && header.data_file.empty()) {  // the last tag is ElementDataFile
    const std::string_view line = cursor.line();
    const std::size_t equals = line.find('=');
    if (equals != std::string_view::npos)
      read_tag(trimmed(line.substr(0, equals)), trimmed(line.substr(equals + 1)), header, layout);
  }
  header.end = static_cast<std::size_t>(cursor.next - begin);
  return header;
}

// Sets axes and origin of the volume. Row i of the matrix is the direction of axis i, as in ITK.
void place(const MetaHeader& header, qnv::VolumeLayout& layout) {
  const auto n = static_cast<std::size_t>(header.dimensions);
  const std::vector<double>& steps = header.spacing.empty() ? header.size : header.spacing;
  for (std::size_t i = 0; i < std::min<std::size_t>(n, 3); ++i) {
    double step = i < steps.size() ? steps[i] : 1;
    if (!std::isfinite(step) || step == 0) step = 1;
    if (header.matrix.size() == n * n)
      for (std::size_t k = 0; k < 3; ++k)
        layout.axes[i][static_cast<int>(k)] = k < n ? static_cast<float>(header.matrix[i * n + k]) : 0.0f;
    layout.axes[i] *= static_cast<float>(step);
    if (i < header.origin.size()) layout.origin[static_cast<int>(i)] = header.origin[i];
  }
}

std::variant<StoredVoxels, std::string> voxels_of(const VolumeFile& file, const MetaHeader& header, StoredType type,
                                                  std::uint64_t size) {
  StoredVoxels voxels;
  voxels.content = file.content;
  voxels.type = type;
  voxels.big_endian = header.big_endian;
  voxels.offset = header.end;
  if (lower_case(header.data_file) != "local") {
    if (lower_case(header.data_file).starts_with("list") || header.data_file.find('%') != std::string::npos)
      return std::string("the data is in a list of files; expected LOCAL or one data file");
    BytesResult loaded = load_beside(file, header.data_file);
    if (auto* problem = std::get_if<std::string>(&loaded)) return std::move(*problem);
    voxels.content = std::get<SharedBytes>(std::move(loaded));
    voxels.offset = 0;
    if (header.header_size > 0 && header.header_size < 1e15)
      voxels.offset = static_cast<std::uint64_t>(header.header_size);
  }
  const std::uint64_t all = voxels.content.bytes.size();
  voxels.offset = std::min(voxels.offset, all);
  if (header.header_size == -1 && !header.compressed) voxels.offset = all - std::min(size, all);
  const std::span<const std::byte> data = voxels.content.bytes.subspan(voxels.offset);
  if (!header.binary) return voxels_of_text(data, size / size_of(type), type, file.budget);
  if (!header.compressed) return voxels;
  BytesResult unpacked = unpacked_exactly(data, size, file.budget);
  if (auto* problem = std::get_if<std::string>(&unpacked)) return std::move(*problem);
  voxels.content = std::get<SharedBytes>(std::move(unpacked));
  voxels.offset = 0;
  return voxels;
}

}  // namespace

bool is_meta_image(std::span<const std::byte> bytes) {
  const std::string_view text = trimmed(text_of(bytes).substr(0, 64));
  for (const std::string_view first : {"ObjectType", "NDims", "Comment"}) {
    if (!text.starts_with(first)) continue;
    return trimmed(text.substr(first.size())).starts_with('=');
  }
  return false;
}

bool is_plain_meta_image(std::span<const std::byte> bytes) {
  if (!is_meta_image(bytes)) return false;
  qnv::VolumeLayout layout;
  const MetaHeader header = read_meta_image_header(bytes, layout);
  return lower_case(header.data_file) == "local" && header.binary && !header.compressed && header.end < bytes.size();
}

VolumeResult open_meta_image(const VolumeFile& file) {
  qnv::VolumeLayout layout;
  const MetaHeader header = read_meta_image_header(file.content.bytes, layout);
  if (header.data_file.empty()) return std::string("the header has no ElementDataFile; expected LOCAL or a file name");
  const std::optional<StoredType> type = meta_image_type_of(header.type);
  if (!type) return "ElementType is '" + header.type.substr(0, 80) + "'; expected an integer or float type";
  std::vector<double> sizes = header.sizes;
  if (header.dimensions != static_cast<double>(sizes.size()) || sizes.empty())
    return std::string("NDims and DimSize do not match");
  while (sizes.size() > 3 && sizes.back() == 1) sizes.pop_back();
  const auto dimensions = dimensions_of(sizes);
  if (!dimensions) return std::string("DimSize is not 1 to 3 whole numbers above 0");
  layout.dimensions = *dimensions;
  place(header, layout);
  if (!(header.channels >= 1 && header.channels <= 4096))
    return std::string("ElementNumberOfChannels is not a number of channels");
  const auto channels = static_cast<std::uint64_t>(header.channels);
  const auto size = stored_size(layout, *type, channels);
  if (const auto* problem = std::get_if<std::string>(&size)) return *problem;
  auto voxels = voxels_of(file, header, *type, std::get<std::uint64_t>(size));
  if (auto* problem = std::get_if<std::string>(&voxels)) return std::move(*problem);
  StoredVoxels& stored = std::get<StoredVoxels>(voxels);
  stored.components = channels;
  stored.component = file.component;
  return make_source(std::move(layout), std::move(stored));
}

}  // namespace gs::app
