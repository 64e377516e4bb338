#include "app/formats/ply/ply_header.h"

#include "base/text.h"

#include <algorithm>
#include <charconv>

namespace gs::app {
namespace {

constexpr std::pair<std::string_view, PlyType> kTypeNames[] = {
    {"char", PlyType::int8},      {"int8", PlyType::int8},       {"uchar", PlyType::uint8},
    {"uint8", PlyType::uint8},    {"short", PlyType::int16},     {"int16", PlyType::int16},
    {"ushort", PlyType::uint16},  {"uint16", PlyType::uint16},   {"int", PlyType::int32},
    {"int32", PlyType::int32},    {"uint", PlyType::uint32},     {"uint32", PlyType::uint32},
    {"float", PlyType::float32},  {"float32", PlyType::float32}, {"double", PlyType::float64},
    {"float64", PlyType::float64}};
constexpr std::pair<std::string_view, PlyFormat> kFormatNames[] = {{"ascii", PlyFormat::ascii},
                                                                   {"binary_little_endian", PlyFormat::little_endian},
                                                                   {"binary_big_endian", PlyFormat::big_endian}};

/// Lines of a header. The first line decides whether a lone CR ends a line. If it does, a data byte of 10 after the
/// last line is not part of the line end.
class HeaderLines {
 public:
  explicit HeaderLines(TextCursor& cursor) : cursor_(cursor) {}

  [[nodiscard]] bool next(std::string_view& line) {
    if (cursor_.at_end()) return false;
    ++number_;
    const char* first = cursor_.next;
    const char* stop = first;
    const char* const last = first + std::min<std::ptrdiff_t>(kLongestLine, cursor_.end - first);
    while (stop < last && *stop != '\n' && *stop != '\r') ++stop;
    too_long_ = stop - first == kLongestLine;
    if (too_long_) return false;
    line = {first, static_cast<std::size_t>(stop - first)};
    cursor_.next = stop;
    if (stop == cursor_.end) return true;
    const bool pair = *stop == '\r' && stop + 1 < cursor_.end && stop[1] == '\n';
    if (number_ == 1) lone_return_ = *stop == '\r' && !pair;
    cursor_.next += pair && !lone_return_ ? 2 : 1;
    return true;
  }
  [[nodiscard]] SourceLocation location() const { return {number_, 1}; }
  /// Returns true if next() stopped in a line of over 64 KiB. Without this limit, next() would search a large file to
  /// its end.
  [[nodiscard]] bool too_long() const { return too_long_; }

 private:
  static constexpr std::ptrdiff_t kLongestLine = 64 << 10;

  TextCursor& cursor_;
  std::uint32_t number_ = 0;
  bool lone_return_ = false, too_long_ = false;
};

/// Error message, or nullopt.
using Problem = std::optional<std::string>;

Problem read_format(TextCursor words, PlyHeader& header) {
  const std::string_view name = words.word();
  const auto format = value_named(kFormatNames, name);
  if (format) header.format = *format;
  if (format) return std::nullopt;
  return "unknown format '" + std::string(name) + "'; expected ascii, binary_little_endian or binary_big_endian";
}

Problem read_element(TextCursor words, PlyHeader& header) {
  PlyElement element;
  element.name = words.word();
  const std::string_view count = words.word();
  const auto result = std::from_chars(count.data(), count.data() + count.size(), element.count);
  if (element.name.empty() || result.ec != std::errc() || result.ptr != count.data() + count.size())
    return "expected: element NAME COUNT";
  header.elements.push_back(std::move(element));
  return std::nullopt;
}

Problem read_property(TextCursor words, PlyHeader& header) {
  if (header.elements.empty()) return "property precedes the first element";
  PlyProperty property;
  std::string_view type = words.word();
  if (type == "list") {
    property.is_list = true;
    const auto count_type = value_named(kTypeNames, words.word());
    if (!count_type || is_float(*count_type))
      return "expected: property list COUNT_TYPE TYPE NAME, with a whole number for COUNT_TYPE";
    property.count_type = *count_type;
    type = words.word();
  }
  const auto found = value_named(kTypeNames, type);
  property.name = words.word();
  if (!found || property.name.empty())
    return "unknown property type '" + std::string(type) + "'; expected char, uchar, short, ushort, int, uint, " +
           "float, double or list";
  property.type = *found;
  header.elements.back().properties.push_back(std::move(property));
  return std::nullopt;
}

void read_comment(TextCursor words, PlyHeader& header) {
  const std::string_view key = words.word();
  if (lower_case(key) == "splatrendermode:") header.antialiased = lower_case(words.word()) == "mip";
  if (lower_case(key) == "antialiased") header.antialiased = words.word() == "1";
  if (key != "TextureFile") return;
  header.texture_file = trimmed({words.next, static_cast<std::size_t>(words.end - words.next)});
}

}  // namespace

std::size_t size_of(PlyType type) {
  constexpr std::array<std::size_t, 8> kSizes = {1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

bool PlyElement::has_lists() const {
  return std::any_of(properties.begin(), properties.end(), [](const PlyProperty& p) { return p.is_list; });
}

std::size_t PlyElement::least_row_bytes() const {
  std::size_t bytes = 0;
  for (const PlyProperty& p : properties) bytes += size_of(p.is_list ? p.count_type : p.type);
  return bytes;
}

std::optional<PlyHeader> read_ply_header(TextCursor& cursor, ImportContext& context) {
  HeaderLines lines(cursor);
  std::string_view line;
  if (!lines.next(line) || trimmed(line) != "ply") {
    context.fail("not a PLY file: expected 'ply' as the first line", {1, 1});
    return std::nullopt;
  }
  PlyHeader header;
  bool has_format = false;
  while (lines.next(line)) {
    TextCursor words(line.data(), line.data() + line.size());
    const std::string_view keyword = words.word();
    Problem problem;
    if (keyword == "format") {
      problem = read_format(words, header);
      has_format = !problem;
    } else if (keyword == "element") {
      problem = read_element(words, header);
    } else if (keyword == "property") {
      problem = read_property(words, header);
    } else if (keyword == "comment") {
      read_comment(words, header);
    } else if (keyword == "end_header") {
      if (has_format) return header;
      problem = "no format line in the header; expected one of ascii, binary_little_endian and binary_big_endian";
    } else if (!keyword.empty() && keyword != "obj_info") {
      problem = "unknown header line '" + std::string(keyword.substr(0, 40)) +
                "'; expected format, element, property, comment, obj_info or end_header";
    }
    if (problem) {
      context.fail(*problem, lines.location());
      return std::nullopt;
    }
  }
  context.fail(lines.too_long() ? "a header line of more than 64 KiB; expected end_header"
                                : "the file ends within its header; expected end_header",
               lines.location());
  return std::nullopt;
}

}  // namespace gs::app
