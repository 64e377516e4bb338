#include "app/formats/volume/vtk_xml.h"

#include "app/formats/common/text_cursor.h"
#include "base/text.h"

#include <expat.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <utility>

// Parser of VTK XML files for all readers: https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html

namespace gs::app {
namespace {

/// State of the XML parser.
struct VtkParse {
  XML_Parser parser = nullptr;
  VtkXmlHeader header;
  std::optional<VtkSection> section;
  bool in_array = false;
  bool in_information = false, in_units = false;
  bool has_data = false;  // the current array has text before its first child element
  bool data_ends = false;  // that text has ended, because a child element follows

  [[nodiscard]] std::size_t place() const { return static_cast<std::size_t>(XML_GetCurrentByteIndex(parser)); }
  [[nodiscard]] std::size_t place_behind() const {
    return place() + static_cast<std::size_t>(XML_GetCurrentByteCount(parser));
  }
};

std::string attribute(const XML_Char** attributes, std::string_view name, std::string otherwise = {}) {
  constexpr std::size_t kMax = 4096;
  for (; attributes[0]; attributes += 2)
    if (attributes[0] == name) return std::string(attributes[1], strnlen(attributes[1], kMax));
  return otherwise;
}

std::uint64_t count_of(const std::string& text, std::uint64_t otherwise) {
  const std::vector<double> numbers = numbers_of(text, 1);
  constexpr double kMax = 1e15;
  return numbers.empty() || !(numbers[0] >= 0 && numbers[0] < kMax) ? otherwise
                                                                    : static_cast<std::uint64_t>(numbers[0]);
}

void begin_array(VtkParse& parse, const XML_Char** attributes) {
  constexpr std::size_t kMaxArrays = 1000;
  if (parse.header.arrays.size() >= kMaxArrays) return;
  VtkArray array;
  array.name = attribute(attributes, "Name");
  array.type = lower_case(attribute(attributes, "type"));
  array.format = lower_case(attribute(attributes, "format", "ascii"));
  array.components = count_of(attribute(attributes, "NumberOfComponents", "1"), 0);
  array.offset = count_of(attribute(attributes, "offset", "0"), std::numeric_limits<std::uint64_t>::max() / 4);
  array.section = *parse.section;
  array.piece = parse.header.pieces.empty() ? 0 : parse.header.pieces.size() - 1;
  array.begin = array.end = parse.place_behind();
  parse.header.arrays.push_back(std::move(array));
  parse.in_array = true;
  parse.has_data = parse.data_ends = false;
}

/// Begins an InformationKey element. VTK writes such elements inside an array, before or after the values.
void begin_information(VtkParse& parse, const XML_Char** attributes) {
  if (parse.has_data && !parse.data_ends) {
    parse.header.arrays.back().end = parse.place();
    parse.data_ends = true;
  }
  parse.in_information = true;
  parse.in_units = attribute(attributes, "name") == "UNITS_LABEL";
}

void take_text(void* user, const XML_Char* text, int length) {
  constexpr std::size_t kMaxUnits = 64;
  auto& parse = *static_cast<VtkParse*>(user);
  if (!parse.in_array) return;
  const std::string_view given(text, static_cast<std::size_t>(length));
  if (parse.in_units) {
    std::string& units = parse.header.arrays.back().units;
    for (const char c : given.substr(0, kMaxUnits))
      if (units.size() < kMaxUnits && (c != '\n' && c != '\r' && c != '\t') && !(units.empty() && c == ' ')) units += c;
  } else if (!parse.in_information && !parse.has_data) {
    parse.has_data = given.find_first_not_of(" \t\r\n") != std::string_view::npos;
  }
}

std::optional<VtkSection> section_of(std::string_view element) {
  static constexpr std::pair<std::string_view, VtkSection> kSections[] = {{"PointData", VtkSection::point_data},
                                                                          {"CellData", VtkSection::cell_data},
                                                                          {"Points", VtkSection::points},
                                                                          {"Verts", VtkSection::vertices},
                                                                          {"Lines", VtkSection::lines},
                                                                          {"Strips", VtkSection::strips},
                                                                          {"Polys", VtkSection::polygons},
                                                                          {"Cells", VtkSection::cells},
                                                                          {"Coordinates", VtkSection::coordinates}};
  for (const auto& [name, section] : kSections)
    if (name == element) return section;
  return std::nullopt;
}

void begin_piece(VtkParse& parse, const XML_Char** attributes) {
  constexpr std::size_t kMaxPieces = 10'000;
  VtkXmlHeader& header = parse.header;
  ++header.piece_count;
  if (header.pieces.size() >= kMaxPieces) return;
  VtkPiece piece;
  piece.extent = attribute(attributes, "Extent");
  piece.points = count_of(attribute(attributes, "NumberOfPoints", "0"), 0);
  piece.vertices = count_of(attribute(attributes, "NumberOfVerts", "0"), 0);
  piece.lines = count_of(attribute(attributes, "NumberOfLines", "0"), 0);
  piece.strips = count_of(attribute(attributes, "NumberOfStrips", "0"), 0);
  piece.polygons = count_of(attribute(attributes, "NumberOfPolys", "0"), 0);
  piece.cells = count_of(attribute(attributes, "NumberOfCells", "0"), 0);
  header.pieces.push_back(std::move(piece));
}

void begin_element(void* user, const XML_Char* element, const XML_Char** attributes) {
  auto& parse = *static_cast<VtkParse*>(user);
  VtkXmlHeader& header = parse.header;
  const std::string_view name = element;
  const auto section = section_of(name);
  if (section) {
    parse.section = section;
    if (*section == VtkSection::point_data) {
      header.point_scalars = attribute(attributes, "Scalars");
      header.point_normals = attribute(attributes, "Normals");
    } else if (*section == VtkSection::cell_data) {
      header.cell_scalars = attribute(attributes, "Scalars");
    }
  } else if (name == "VTKFile") {
    header.type = attribute(attributes, "type");
    header.byte_order = lower_case(attribute(attributes, "byte_order", "littleendian"));
    header.header_type = lower_case(attribute(attributes, "header_type", "uint32"));
    header.compressor = lower_case(attribute(attributes, "compressor"));
  } else if (name == "ImageData" || name == "RectilinearGrid" || name == "StructuredGrid") {
    header.whole_extent = attribute(attributes, "WholeExtent");
    header.origin = attribute(attributes, "Origin");
    header.spacing = attribute(attributes, "Spacing");
    header.direction = attribute(attributes, "Direction");
  } else if (name == "Piece") {
    begin_piece(parse, attributes);
  } else if (name == "DataArray" && parse.section) {
    begin_array(parse, attributes);
  } else if (name == "InformationKey" && parse.in_array) {
    begin_information(parse, attributes);
  } else if (name == "AppendedData") {
    // The appended data may be raw bytes, not XML. Stop parsing here.
    header.appended = parse.place_behind();
    header.appended_base64 = lower_case(attribute(attributes, "encoding", "base64")) != "raw";
    XML_StopParser(parse.parser, XML_FALSE);
  }
}

void end_element(void* user, const XML_Char* element) {
  auto& parse = *static_cast<VtkParse*>(user);
  const std::string_view name = element;
  if (section_of(name)) parse.section.reset();
  if (name == "InformationKey" && parse.in_array) {
    if (!parse.has_data) parse.header.arrays.back().begin = parse.place_behind();
    parse.in_information = parse.in_units = false;
  }
  if (name == "DataArray" && parse.in_array) {
    VtkArray& array = parse.header.arrays.back();
    array.end = std::max(array.begin, parse.data_ends ? array.end : parse.place());
    parse.in_array = false;
  }
}

/// Decodes base64 to at most `most` bytes. The text may be two runs in sequence, so padding may occur in the middle.
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
    // Of four digits, the 2nd, 3rd and 4th each complete a byte.
    if (digits >= 2) out.push_back(static_cast<std::byte>(bits >> (8 - 2 * digits) & 0xff));
    if (digits == 4) digits = 0;
  }
  return out;
}

/// Binary data of an array: first lengths, then values, which may be compressed.
class VtkData {
 public:
  VtkData(const VtkXmlHeader& header, SharedBytes bytes, bool base64, WorldBudget budget)
      : wide_(header.header_type == "uint64"),
        big_endian_(header.byte_order == "bigendian"),
        packed_(!header.compressor.empty()),
        packing_(packing_of(header.compressor)),
        base64_(base64),
        bytes_(std::move(bytes)),
        budget_(std::move(budget)) {}

  /// Returns the first `size` bytes of the values, or more.
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
      memory.share = Share(budget_, Resource::volumes);
      const std::uint64_t size = std::min<std::uint64_t>(count, bytes_.bytes.size() / 4 * 3 + 3);
      if (!memory.share.grow(size)) {
        refused_ = "base64 data take " + budget_->refusal(Resource::volumes);
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
    return std::bit_cast<std::uint64_t>(raw);  // `raw` is little-endian now, like the machine
  }
  static_assert(std::endian::native == std::endian::little);

  [[nodiscard]] static std::optional<VtkPacking> packing_of(std::string_view compressor) {
    if (compressor == "vtklz4datacompressor") return VtkPacking::lz4;
    if (compressor == "vtklzmadatacompressor") return VtkPacking::lzma;
    return std::nullopt;
  }
  [[nodiscard]] std::optional<std::string> unpack(std::span<const std::byte> from, std::span<std::byte> to) const {
    return packing_ ? unpack_vtk_block(*packing_, from, to) : unpack_into(from, to, budget_);
  }

  // Decompresses blocks. The header has the number of blocks, the uncompressed size of a block, that of the last
  // block (0 means a full block), and the compressed size of each block.
  [[nodiscard]] BytesResult unpacked(std::uint64_t size) {
    const std::uint64_t word = wide_ ? 8 : 4, most_blocks = bytes_.bytes.size() / word;
    const SharedBytes start = first(3 * word);
    if (start.bytes.size() < 3 * word) return std::string("the array ends within its table of blocks");
    const std::uint64_t blocks = number_at(start.bytes, 0), block = number_at(start.bytes, 1),
                        last = number_at(start.bytes, 2);
    if (blocks > most_blocks || last > block) return std::string("the table of blocks of the array is invalid");
    const SharedBytes table = first((3 + blocks) * word);
    if (table.bytes.size() < (3 + blocks) * word) return std::string("the array ends within its table of blocks");
    std::uint64_t packed = 0;
    for (std::uint64_t i = 0; i < blocks; ++i) {
      const std::uint64_t length = number_at(table.bytes, 3 + i);
      if (length > bytes_.bytes.size() || packed > bytes_.bytes.size())
        return std::string("the table of blocks of the array is invalid");
      packed += length;
    }
    const std::uint64_t begin = (3 + blocks) * word;
    const SharedBytes all = first(begin + packed);
    if (all.bytes.size() < begin + packed) return std::string("the blocks of the array are truncated");
    // Blocks of LZMA may expand more than those of zlib.
    auto memory = voxel_memory(packing_ == VtkPacking::lzma ? std::max(packed, size) : packed, size, budget_);
    if (auto* problem = std::get_if<std::string>(&memory)) return std::move(*problem);
    auto& out = std::get<VoxelMemory>(memory);
    std::uint64_t made = 0, from = begin;
    for (std::uint64_t i = 0; i < blocks && made < size; ++i) {
      const std::uint64_t length = number_at(table.bytes, 3 + i);
      const std::uint64_t whole = i + 1 == blocks && last != 0 ? last : block, part = std::min(whole, size - made);
      const std::span<const std::byte> stored = all.bytes.subspan(from, length);
      if (packing_ && part < whole) {
        // These blocks are unpacked as a whole.
        if (whole > std::max<std::uint64_t>(size, kMostBlock)) return std::string("a block of the array is too large");
        std::vector<std::byte> block_bytes(static_cast<std::size_t>(whole));
        if (const auto problem = unpack(stored, block_bytes)) return *problem;
        std::copy_n(block_bytes.begin(), part, out.bytes.begin() + static_cast<std::ptrdiff_t>(made));
      } else if (const auto problem = unpack(stored, std::span(out.bytes).subspan(made, part))) {
        return *problem;
      }
      from += length;
      made += part;
    }
    if (made < size)
      return "the blocks of the array have " + std::to_string(made) + " bytes; expected " + std::to_string(size);
    return shared_bytes(std::move(out));
  }

  static constexpr std::uint64_t kMostBlock = std::uint64_t{64} << 20;

  bool wide_, big_endian_, packed_;
  std::optional<VtkPacking> packing_;  // nullopt: zlib
  bool base64_;
  SharedBytes bytes_;
  WorldBudget budget_;
  std::optional<std::string> refused_;  // message if the budget was exceeded
};

}  // namespace

int base64_value(std::byte byte) {
  const char c = static_cast<char>(byte);
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+') return 62;
  return c == '/' ? 63 : -1;
}

std::variant<VtkXmlHeader, std::string> read_vtk_xml(std::span<const std::byte> bytes, std::string_view type) {
  const std::unique_ptr<std::remove_pointer_t<XML_Parser>, decltype(&XML_ParserFree)> parser(XML_ParserCreate(nullptr),
                                                                                             XML_ParserFree);
  if (!parser) return std::string("the XML parser cannot be initialised");
  VtkParse parse;
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
             " is not XML: " + XML_ErrorString(XML_GetErrorCode(parser.get()));
  }
  if (!type.empty() && parse.header.type != type)
    return "the VTKFile is of the type '" + parse.header.type.substr(0, 80) + "'; expected " + std::string(type);
  return std::move(parse.header);
}

std::optional<VtkExtent> vtk_extent(std::string_view text) {
  constexpr double kMost = 1e9;
  const std::vector<double> numbers = numbers_of(text, 6);
  VtkExtent extent{};
  if (numbers.size() != extent.size()) return std::nullopt;
  for (std::size_t i = 0; i < extent.size(); ++i) {
    if (!(std::abs(numbers[i]) <= kMost) || numbers[i] != std::trunc(numbers[i])) return std::nullopt;
    extent[i] = static_cast<std::int64_t>(numbers[i]);
    if (i % 2 == 1 && extent[i] < extent[i - 1]) return std::nullopt;
  }
  return extent;
}

VtkGridAxes vtk_grid_axes(const SharedBytes& file, const VtkXmlHeader& header, std::size_t piece,
                          const VtkExtent& extent, const WorldBudget& budget) {
  constexpr std::int64_t kLongest = std::int64_t{1} << 24;
  VtkGridAxes axes;
  std::vector<const VtkArray*> stored;
  for (const VtkArray& array : header.arrays)
    if (array.section == VtkSection::coordinates && array.piece == piece) stored.push_back(&array);
  const bool image = header.type == "ImageData";
  std::vector<double> origin = numbers_of(header.origin, 3), spacing = numbers_of(header.spacing, 3);
  const std::vector<double> direction = numbers_of(header.direction, 9);
  if (origin.size() != 3) origin = {0, 0, 0};
  if (spacing.size() != 3) spacing = {1, 1, 1};
  if (image && direction.size() == 9)
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column)
        axes.directions[column][row] = direction[static_cast<std::size_t>(row * 3 + column)];
  if (image) axes.origin = glm::dvec3(origin[0], origin[1], origin[2]);
  for (std::size_t i = 0; i < 3; ++i) {
    const std::int64_t count = extent[2 * i + 1] - extent[2 * i] + 1;
    if (count > kLongest) {
      axes.problem = "an axis has " + std::to_string(count) + " points; expected at most " + std::to_string(kLongest);
      return axes;
    }
    if (!image && stored.size() != 3) {
      axes.problem = std::to_string(stored.size()) + " Coordinates; expected those of x, y and z";
      return axes;
    }
    if (image) {
      for (std::int64_t k = 0; k < count; ++k)
        axes.positions[i].push_back(spacing[i] * static_cast<double>(extent[2 * i] + k));
      continue;
    }
    const auto values = vtk_values(file, header, *stored[i], static_cast<std::uint64_t>(count), budget);
    if (const auto* const problem = std::get_if<std::string>(&values)) {
      axes.problem = "the coordinates '" + stored[i]->name.substr(0, 80) + "': " + *problem;
      return axes;
    }
    each_number(std::get<StoredVoxels>(values), static_cast<std::uint64_t>(count),
                [&](double value) { axes.positions[i].push_back(value); });
  }
  return axes;
}

std::optional<StoredType> vtk_type_of(std::string_view name) {
  static constexpr std::pair<std::string_view, StoredType> kNames[] = {
      {"uint8", StoredType::u8},   {"int8", StoredType::i8},    {"uint16", StoredType::u16},
      {"int16", StoredType::i16},  {"uint32", StoredType::u32}, {"int32", StoredType::i32},
      {"uint64", StoredType::u64}, {"int64", StoredType::i64},  {"float32", StoredType::f32},
      {"float64", StoredType::f64}};
  return value_named(kNames, name);
}

std::variant<StoredVoxels, std::string> vtk_values(const SharedBytes& file, const VtkXmlHeader& header,
                                                   const VtkArray& array, std::uint64_t count,
                                                   const WorldBudget& budget) {
  const auto known = vtk_type_of(array.type);
  if (!known) return "the type is '" + array.type.substr(0, 80) + "'; expected Int8 to UInt64, Float32 or Float64";
  const StoredType type = *known;
  const std::uint64_t size = count * size_of(type);
  const std::span<const std::byte> bytes = file.bytes;
  const std::span<const std::byte> inside = bytes.subspan(array.begin, array.end - array.begin);
  if (array.format == "ascii") return voxels_of_text(inside, count, type, budget);
  if (!header.compressor.empty() && header.compressor != "vtkzlibdatacompressor" &&
      header.compressor != "vtklz4datacompressor" && header.compressor != "vtklzmadatacompressor")
    return "the compressor is '" + header.compressor.substr(0, 80) +
           "'; expected vtkZLibDataCompressor, vtkLZ4DataCompressor, vtkLZMADataCompressor or none";
  SharedBytes data{file.owner, inside};
  bool base64 = true;
  if (array.format == "appended") {
    if (!header.appended) return std::string("an array refers to AppendedData, but the file has none");
    TextCursor cursor(bytes.subspan(*header.appended));
    if (!cursor.skip_space() || *cursor.next != '_') return std::string("AppendedData does not begin with '_'");
    data.bytes = bytes.last(static_cast<std::size_t>(cursor.end - cursor.next) - 1);
    data.bytes = data.bytes.subspan(std::min<std::uint64_t>(array.offset, data.bytes.size()));
    base64 = header.appended_base64;
  } else if (array.format != "binary") {
    return "the format is '" + array.format.substr(0, 80) + "'; expected ascii, binary or appended";
  }
  BytesResult values = VtkData(header, std::move(data), base64, budget).values(size);
  if (auto* problem = std::get_if<std::string>(&values)) return std::move(*problem);
  StoredVoxels voxels;
  voxels.content = std::get<SharedBytes>(std::move(values));
  voxels.type = type;
  voxels.big_endian = header.byte_order == "bigendian";
  return voxels;
}

bool is_vtk_xml(std::span<const std::byte> bytes, std::string_view type) {
  const std::string_view text = text_of(bytes).substr(0, 4096);
  const std::size_t root = text.find("<VTKFile");
  if (root == std::string_view::npos) return false;
  const std::string_view tag = text.substr(root, text.find('>', root) - root);
  const std::size_t at = tag.find(type);
  const auto is_quote = [&](std::size_t place) {
    return place < tag.size() && (tag[place] == '"' || tag[place] == '\'');
  };
  return at != std::string_view::npos && at > 0 && is_quote(at - 1) && is_quote(at + type.size());
}

}  // namespace gs::app
