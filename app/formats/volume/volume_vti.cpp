#include "app/formats/common/text_cursor.h"
#include "app/formats/volume/volume_common.h"

#include <expat.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <utility>

// VTK XML ImageData: https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html

namespace gs::app {
namespace {

/// One array of a value a point or cell.
struct VtiArray {
  std::string name, type, format = "ascii", units;
  std::uint64_t components = 1, offset = 0;  // into the appended data
  std::size_t begin = 0, end = 0;            // of what stands inside the element
  bool of_points = false;
};

struct VtiHeader {
  std::string type, byte_order = "littleendian", header_type = "uint32", compressor;
  std::string whole_extent, piece_extent, origin, spacing, direction;
  std::string point_scalars, cell_scalars;
  std::vector<VtiArray> arrays;
  std::size_t pieces = 0;
  std::optional<std::size_t> appended;  // behind the start of the element
  bool appended_base64 = false;
};

/// What the parser's handlers know.
struct VtiParse {
  XML_Parser parser = nullptr;
  VtiHeader header;
  bool in_points = false, in_cells = false, in_array = false;
  bool in_information = false, in_units = false;
  bool has_data = false;   // of the array: what is no blank stood before the next element
  bool data_ends = false;  // of the array: something else stood behind it

  [[nodiscard]] std::size_t place() const { return static_cast<std::size_t>(XML_GetCurrentByteIndex(parser)); }
  [[nodiscard]] std::size_t place_behind() const {
    return place() + static_cast<std::size_t>(XML_GetCurrentByteCount(parser));
  }
};

std::string attribute(const XML_Char** attributes, std::string_view name, std::string otherwise = {}) {
  constexpr std::size_t kMost = 4096;
  for (; attributes[0]; attributes += 2)
    if (attributes[0] == name) return std::string(attributes[1], strnlen(attributes[1], kMost));
  return otherwise;
}

std::uint64_t count_of(const std::string& text, std::uint64_t otherwise) {
  const std::vector<double> numbers = numbers_of(text, 1);
  constexpr double kMost = 1e15;
  return numbers.empty() || !(numbers[0] >= 0 && numbers[0] < kMost) ? otherwise
                                                                     : static_cast<std::uint64_t>(numbers[0]);
}

void begin_array(VtiParse& parse, const XML_Char** attributes) {
  constexpr std::size_t kMostArrays = 1000;
  if (parse.header.arrays.size() >= kMostArrays) return;
  VtiArray array;
  array.name = attribute(attributes, "Name");
  array.type = lower_case(attribute(attributes, "type"));
  array.format = lower_case(attribute(attributes, "format", "ascii"));
  array.components = count_of(attribute(attributes, "NumberOfComponents", "1"), 0);
  array.offset = count_of(attribute(attributes, "offset", "0"), std::numeric_limits<std::uint64_t>::max() / 4);
  array.of_points = parse.in_points;
  array.begin = array.end = parse.place_behind();
  parse.header.arrays.push_back(std::move(array));
  parse.in_array = true;
  parse.has_data = parse.data_ends = false;
}

/// VTK writes what it knows of an array (vtkInformation) into its element, before the values.
void begin_information(VtiParse& parse, const XML_Char** attributes) {
  if (parse.has_data && !parse.data_ends) {
    parse.header.arrays.back().end = parse.place();
    parse.data_ends = true;
  }
  parse.in_information = true;
  parse.in_units = attribute(attributes, "name") == "UNITS_LABEL";
}

void take_text(void* user, const XML_Char* text, int length) {
  constexpr std::size_t kMostUnits = 64;
  auto& parse = *static_cast<VtiParse*>(user);
  if (!parse.in_array) return;
  const std::string_view given(text, static_cast<std::size_t>(length));
  if (parse.in_units) {
    std::string& units = parse.header.arrays.back().units;
    for (const char c : given.substr(0, kMostUnits))
      if (units.size() < kMostUnits && (c != '\n' && c != '\r' && c != '\t') && !(units.empty() && c == ' '))
        units += c;
  } else if (!parse.in_information && !parse.has_data) {
    parse.has_data = given.find_first_not_of(" \t\r\n") != std::string_view::npos;
  }
}

void begin_element(void* user, const XML_Char* element, const XML_Char** attributes) {
  auto& parse = *static_cast<VtiParse*>(user);
  VtiHeader& header = parse.header;
  const std::string_view name = element;
  if (name == "VTKFile") {
    header.type = attribute(attributes, "type");
    header.byte_order = lower_case(attribute(attributes, "byte_order", "littleendian"));
    header.header_type = lower_case(attribute(attributes, "header_type", "uint32"));
    header.compressor = lower_case(attribute(attributes, "compressor"));
  } else if (name == "ImageData") {
    header.whole_extent = attribute(attributes, "WholeExtent");
    header.origin = attribute(attributes, "Origin");
    header.spacing = attribute(attributes, "Spacing");
    header.direction = attribute(attributes, "Direction");
  } else if (name == "Piece") {
    ++header.pieces;
    header.piece_extent = attribute(attributes, "Extent");
  } else if (name == "PointData") {
    parse.in_points = true;
    header.point_scalars = attribute(attributes, "Scalars");
  } else if (name == "CellData") {
    parse.in_cells = true;
    header.cell_scalars = attribute(attributes, "Scalars");
  } else if (name == "DataArray" && (parse.in_points || parse.in_cells)) {
    begin_array(parse, attributes);
  } else if (name == "InformationKey" && parse.in_array) {
    begin_information(parse, attributes);
  } else if (name == "AppendedData") {
    // What follows may be raw bytes, which are no XML.
    header.appended = parse.place_behind();
    header.appended_base64 = lower_case(attribute(attributes, "encoding", "base64")) != "raw";
    XML_StopParser(parse.parser, XML_FALSE);
  }
}

void end_element(void* user, const XML_Char* element) {
  auto& parse = *static_cast<VtiParse*>(user);
  const std::string_view name = element;
  if (name == "PointData") parse.in_points = false;
  if (name == "CellData") parse.in_cells = false;
  if (name == "InformationKey" && parse.in_array) {
    if (!parse.has_data) parse.header.arrays.back().begin = parse.place_behind();
    parse.in_information = parse.in_units = false;
  }
  if (name == "DataArray" && parse.in_array) {
    VtiArray& array = parse.header.arrays.back();
    array.end = std::max(array.begin, parse.data_ends ? array.end : parse.place());
    parse.in_array = false;
  }
}

std::variant<VtiHeader, std::string> read_header(std::span<const std::byte> bytes) {
  const std::unique_ptr<std::remove_pointer_t<XML_Parser>, decltype(&XML_ParserFree)> parser(XML_ParserCreate(nullptr),
                                                                                             XML_ParserFree);
  if (!parser) return std::string("the XML parser could not be set up");
  VtiParse parse;
  parse.parser = parser.get();
  XML_SetUserData(parser.get(), &parse);
  XML_SetElementHandler(parser.get(), begin_element, end_element);
  XML_SetCharacterDataHandler(parser.get(), take_text);
  constexpr std::size_t kPiece = std::size_t{1} << 20;
  for (std::size_t next = 0; next < bytes.size() && !parse.header.appended; next += kPiece) {
    const std::span<const std::byte> piece = bytes.subspan(next, std::min(kPiece, bytes.size() - next));
    const bool last = next + piece.size() == bytes.size();
    const XML_Status status = XML_Parse(parser.get(), reinterpret_cast<const char*>(piece.data()),
                                        static_cast<int>(piece.size()), last ? 1 : 0);
    if (status == XML_STATUS_ERROR && !parse.header.appended)
      return "line " + std::to_string(XML_GetCurrentLineNumber(parser.get())) +
             " is no XML: " + XML_ErrorString(XML_GetErrorCode(parser.get()));
  }
  if (parse.header.type != "ImageData")
    return "the VTKFile is of the type '" + parse.header.type.substr(0, 80) + "'; expected ImageData";
  return std::move(parse.header);
}

int base64_value(std::byte byte) {
  const char c = static_cast<char>(byte);
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+') return 62;
  return c == '/' ? 63 : -1;
}

/// The first `most` bytes of base64; padding may come in between, where one run ends and the next begins.
std::vector<std::byte> base64_bytes(std::span<const std::byte> text, std::uint64_t most) {
  std::vector<std::byte> out;
  out.reserve(std::min<std::uint64_t>(most, text.size() / 4 * 3 + 3));
  std::uint32_t bits = 0;
  unsigned digits = 0;
  for (const std::byte byte : text) {
    if (out.size() >= most) break;
    if (byte == std::byte{'='}) {
      digits = 0;
      continue;
    }
    const int digit = base64_value(byte);
    if (digit < 0 && !TextCursor::is_space(static_cast<char>(byte))) break;
    if (digit < 0) continue;
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    ++digits;
    // A byte is complete after the 2nd, 3rd and 4th digit of each four.
    if (digits >= 2) out.push_back(static_cast<std::byte>(bits >> (8 - 2 * digits) & 0xff));
    if (digits == 4) digits = 0;
  }
  return out;
}

/// Binary data of an array: lengths in front, then the values, packed or not.
class VtiData {
 public:
  VtiData(const VtiHeader& header, SharedBytes bytes, bool base64, WorldBudget budget)
      : wide_(header.header_type == "uint64"),
        big_endian_(header.byte_order == "bigendian"),
        packed_(!header.compressor.empty()),
        base64_(base64),
        bytes_(std::move(bytes)),
        budget_(std::move(budget)) {}

  /// At least `size` bytes of values.
  [[nodiscard]] BytesResult values(std::uint64_t size) {
    BytesResult result = packed_ ? unpacked(size) : plain(size);
    if (refused_) return *refused_;
    return result;
  }

 private:
  [[nodiscard]] BytesResult plain(std::uint64_t size) {
    const std::uint64_t word = wide_ ? 8 : 4;
    const SharedBytes all = first(word + size);
    if (all.bytes.size() < word || all.bytes.size() - word < size)
      return "the array ends after " + std::to_string(all.bytes.size()) + " bytes; expected " +
             std::to_string(word + size);
    const std::uint64_t length = number_at(all.bytes, 0);
    if (length < size) return "the array has " + std::to_string(length) + " bytes; expected " + std::to_string(size);
    return SharedBytes{all.owner, all.bytes.subspan(word)};
  }

  [[nodiscard]] SharedBytes first(std::uint64_t count) {
    if (base64_) {
      VoxelMemory memory;
      memory.share = vrml::Share(budget_, vrml::Resource::volumes);
      const std::uint64_t size = std::min<std::uint64_t>(count, bytes_.bytes.size() / 4 * 3 + 3);
      if (!memory.share.grow(size)) {
        refused_ = "base64 data take " + budget_->refusal(vrml::Resource::volumes);
        return {};
      }
      memory.bytes = base64_bytes(bytes_.bytes, count);
      return shared_bytes(std::move(memory));
    }
    return {bytes_.owner, bytes_.bytes.first(std::min<std::uint64_t>(count, bytes_.bytes.size()))};
  }
  [[nodiscard]] std::uint64_t number_at(std::span<const std::byte> bytes, std::uint64_t index) const {
    const std::size_t word = wide_ ? 8 : 4;
    std::array<std::byte, 8> raw{};
    std::memcpy(raw.data(), bytes.data() + index * word, word);
    if (big_endian_) std::reverse(raw.begin(), raw.begin() + static_cast<std::ptrdiff_t>(word));
    return std::bit_cast<std::uint64_t>(raw);  // the bytes are now the least first; this machine's too
  }
  static_assert(std::endian::native == std::endian::little);

  // Blocks of zlib data: their count, their size unpacked, that of the last one (0: as the others), and
  // each one's packed size.
  [[nodiscard]] BytesResult unpacked(std::uint64_t size) {
    const std::uint64_t word = wide_ ? 8 : 4, most_blocks = bytes_.bytes.size() / word;
    const SharedBytes start = first(3 * word);
    if (start.bytes.size() < 3 * word) return std::string("the array ends in its table of blocks");
    const std::uint64_t blocks = number_at(start.bytes, 0), block = number_at(start.bytes, 1),
                        last = number_at(start.bytes, 2);
    if (blocks > most_blocks || last > block) return std::string("the array's table of blocks is wrong");
    const SharedBytes table = first((3 + blocks) * word);
    if (table.bytes.size() < (3 + blocks) * word) return std::string("the array ends in its table of blocks");
    std::uint64_t packed = 0;
    for (std::uint64_t i = 0; i < blocks; ++i) {
      const std::uint64_t length = number_at(table.bytes, 3 + i);
      if (length > bytes_.bytes.size() || packed > bytes_.bytes.size())
        return std::string("the array's table of blocks is wrong");
      packed += length;
    }
    const std::uint64_t begin = (3 + blocks) * word;
    const SharedBytes all = first(begin + packed);
    if (all.bytes.size() < begin + packed) return std::string("the array's blocks are cut off");
    auto memory = voxel_memory(packed, size, budget_);
    if (auto* problem = std::get_if<std::string>(&memory)) return std::move(*problem);
    auto& out = std::get<VoxelMemory>(memory);
    std::uint64_t made = 0, from = begin;
    for (std::uint64_t i = 0; i < blocks && made < size; ++i) {
      const std::uint64_t length = number_at(table.bytes, 3 + i);
      const std::uint64_t whole = i + 1 == blocks && last != 0 ? last : block, part = std::min(whole, size - made);
      if (const auto problem =
              unpack_into(all.bytes.subspan(from, length), std::span(out.bytes).subspan(made, part), budget_))
        return *problem;
      from += length;
      made += part;
    }
    if (made < size)
      return "the array's blocks hold " + std::to_string(made) + " bytes; expected " + std::to_string(size);
    return shared_bytes(std::move(out));
  }

  bool wide_, big_endian_, packed_, base64_;
  SharedBytes bytes_;
  WorldBudget budget_;
  std::optional<std::string> refused_;  // memory, and why
};

std::optional<StoredType> vti_type_of(std::string_view name) {
  static constexpr std::pair<std::string_view, StoredType> kNames[] = {
      {"uint8", StoredType::u8},   {"int8", StoredType::i8},    {"uint16", StoredType::u16},
      {"int16", StoredType::i16},  {"uint32", StoredType::u32}, {"int32", StoredType::i32},
      {"uint64", StoredType::u64}, {"int64", StoredType::i64},  {"float32", StoredType::f32},
      {"float64", StoredType::f64}};
  for (const auto& [type_name, type] : kNames)
    if (type_name == name) return type;
  return std::nullopt;
}

/// The active scalars of the points, or their first array of one component, or their first; else those of
/// the cells.
const VtiArray* choose(const VtiHeader& header) {
  for (const bool of_points : {true, false}) {
    const std::string& scalars = of_points ? header.point_scalars : header.cell_scalars;
    const VtiArray *named = nullptr, *single = nullptr, *first = nullptr;
    for (const VtiArray& array : header.arrays) {
      if (array.of_points != of_points || !vti_type_of(array.type)) continue;
      if (!first) first = &array;
      if (!single && array.components == 1) single = &array;
      if (!named && !scalars.empty() && array.name == scalars) named = &array;
    }
    if (first) return named ? named : single ? single : first;
  }
  return nullptr;
}

/// Dimensions and place of the points, or of the cells' centres.
std::optional<std::string> place(const VtiHeader& header, bool of_points, qnv::VolumeLayout& layout) {
  const std::vector<double> extent =
      numbers_of(header.piece_extent.empty() ? header.whole_extent : header.piece_extent, 6);
  std::vector<double> origin = numbers_of(header.origin, 3), spacing = numbers_of(header.spacing, 3);
  std::vector<double> direction = numbers_of(header.direction, 9);
  if (extent.size() != 6)
    return "the extent is '" + header.whole_extent.substr(0, 80) + "'; expected six whole numbers";
  if (origin.size() != 3) origin = {0, 0, 0};
  if (spacing.size() != 3) spacing = {1, 1, 1};
  if (direction.size() != 9) direction = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  std::array<double, 3> sizes{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double points = extent[2 * i + 1] - extent[2 * i] + 1;
    sizes[i] = of_points ? points : std::max(1.0, points - 1);
    const double first = extent[2 * i] + (of_points || points < 2 ? 0 : 0.5);
    for (std::size_t k = 0; k < 3; ++k) {
      const double step = direction[3 * k + i] * spacing[i];
      layout.axes[i][static_cast<int>(k)] = static_cast<float>(step);
      origin[k] += step * first;
    }
  }
  for (std::size_t i = 0; i < 3; ++i) layout.origin[static_cast<int>(i)] = origin[i];
  const auto dimensions = dimensions_of(sizes);
  if (!dimensions)
    return "the extent is '" + header.whole_extent.substr(0, 80) + "'; expected at least one point an axis";
  layout.dimensions = *dimensions;
  return std::nullopt;
}

std::variant<StoredVoxels, std::string> voxels_of(const VolumeFile& file, const VtiHeader& header,
                                                  const VtiArray& array, StoredType type, std::uint64_t size) {
  const std::span<const std::byte> bytes = file.content.bytes;
  const std::span<const std::byte> inside = bytes.subspan(array.begin, array.end - array.begin);
  if (array.format == "ascii") return voxels_of_text(inside, size / size_of(type), file.budget);
  if (!header.compressor.empty() && header.compressor != "vtkzlibdatacompressor")
    return "the compressor is '" + header.compressor.substr(0, 80) + "'; expected vtkZLibDataCompressor or none";
  SharedBytes data{file.content.owner, inside};
  bool base64 = true;
  if (array.format == "appended") {
    if (!header.appended) return std::string("an array is said to be appended, but there is no AppendedData");
    TextCursor cursor(bytes.subspan(*header.appended));
    if (!cursor.skip_space() || *cursor.next != '_') return std::string("AppendedData does not begin with '_'");
    data.bytes = bytes.last(static_cast<std::size_t>(cursor.end - cursor.next) - 1);
    data.bytes = data.bytes.subspan(std::min<std::uint64_t>(array.offset, data.bytes.size()));
    base64 = header.appended_base64;
  } else if (array.format != "binary") {
    return "the format is '" + array.format.substr(0, 80) + "'; expected ascii, binary or appended";
  }
  BytesResult values = VtiData(header, std::move(data), base64, file.budget).values(size);
  if (auto* problem = std::get_if<std::string>(&values)) return std::move(*problem);
  StoredVoxels voxels;
  voxels.content = std::get<SharedBytes>(std::move(values));
  voxels.type = type;
  voxels.big_endian = header.byte_order == "bigendian";
  return voxels;
}

}  // namespace

bool is_vti(std::span<const std::byte> bytes) {
  const std::string_view text = text_of(bytes).substr(0, 4096);
  const std::size_t root = text.find("<VTKFile");
  if (root == std::string_view::npos) return false;
  const std::string_view tag = text.substr(root, text.find('>', root) - root);
  return tag.find("\"ImageData\"") != std::string_view::npos || tag.find("'ImageData'") != std::string_view::npos;
}

VolumeResult open_vti(const VolumeFile& file) {
  auto read = read_header(file.content.bytes);
  if (auto* problem = std::get_if<std::string>(&read)) return std::move(*problem);
  const VtiHeader& header = std::get<VtiHeader>(read);
  if (header.pieces > 1) return std::to_string(header.pieces) + " pieces; expected one";
  const VtiArray* array = choose(header);
  if (!array) return std::string("there is no DataArray of numbers in PointData or CellData");
  qnv::VolumeLayout layout;
  if (auto problem = place(header, array->of_points, layout)) return std::move(*problem);
  add_metadata(layout, "array", array->name);
  if (!array->units.empty()) add_metadata(layout, "units", array->units);
  const StoredType type = *vti_type_of(array->type);
  const auto size = stored_size(layout, type, array->components);
  if (const auto* problem = std::get_if<std::string>(&size)) return *problem;
  auto voxels = voxels_of(file, header, *array, type, std::get<std::uint64_t>(size));
  if (auto* problem = std::get_if<std::string>(&voxels)) return std::move(*problem);
  std::get<StoredVoxels>(voxels).components = array->components;
  return make_source(std::move(layout), std::get<StoredVoxels>(std::move(voxels)));
}

}  // namespace gs::app
