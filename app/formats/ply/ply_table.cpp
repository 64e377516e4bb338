#include "app/formats/ply/ply_table.h"

#include "app/formats/ply/ply_source.h"

#include <algorithm>

namespace gs::app {
namespace {

/// Header with its diagnostics, read on its own.
struct HeaderReading {
  Diagnostics diagnostics{1};
  std::optional<PlyHeader> header;

  explicit HeaderReading(TextCursor& cursor) {
    ImportContext context({}, own_budget(), diagnostics);
    header = read_ply_header(cursor, context);
  }
  [[nodiscard]] std::string problem() const {
    return diagnostics.entries().empty() ? "broken PLY header" : diagnostics.entries().front().message;
  }
};

/// Reads `rows` rows of an ASCII file. Returns the number of complete rows.
std::size_t read_text(PlyTextSource& source, const PlyElement& element, std::size_t rows, std::vector<double>* values) {
  const std::size_t width = element.properties.size();
  for (std::size_t row = 0; row < rows; ++row)
    for (std::size_t i = 0; i < width; ++i) {
      double value = 0;
      if (!source.read(element.properties[i].type, value)) {
        if (values) values->resize(row * width);
        return row;
      }
      if (values) values->push_back(value);
    }
  return rows;
}

template <bool big, class Number>
void read_binary(const PlyTable& table, PlyType type, std::size_t offset, std::vector<Number>& values) {
  if (table.rows == 0) return;  // `data` may be empty and have no address
  const std::size_t stride = table.element.least_row_bytes();
  const std::byte* from = table.data.data() + offset;
  with_type(type, [&](auto kind) {
    using T = decltype(kind);
    for (std::size_t row = 0; row < table.rows; ++row)
      values[row] = static_cast<Number>(load<T, big>(from + row * stride));
  });
}

template <class Number>
std::vector<Number> column_of(const PlyTable& table, std::string_view property) {
  std::size_t offset = 0, index = 0;
  for (const PlyProperty& p : table.element.properties) {
    if (p.name != property) {
      offset += size_of(p.type);
      ++index;
      continue;
    }
    std::vector<Number> result(table.rows);
    if (table.header.format == PlyFormat::little_endian)
      read_binary<false>(table, p.type, offset, result);
    else if (table.header.format == PlyFormat::big_endian)
      read_binary<true>(table, p.type, offset, result);
    else
      for (std::size_t row = 0; row < table.rows; ++row)
        result[row] = static_cast<Number>(table.values[row * table.element.properties.size() + index]);
    return result;
  }
  return {};
}

/// Returns the element `name`, or null. Appends the elements before it to `before`.
const PlyElement* find(const PlyHeader& header, std::string_view name, std::vector<const PlyElement*>& before) {
  for (const PlyElement& element : header.elements) {
    if (element.name == name) return &element;
    before.push_back(&element);
  }
  return nullptr;
}

}  // namespace

bool PlyTable::has(std::string_view property) const {
  return std::any_of(element.properties.begin(), element.properties.end(),
                     [&](const PlyProperty& p) { return !p.is_list && p.name == property; });
}

std::vector<float> PlyTable::column(std::string_view property) const { return column_of<float>(*this, property); }

std::vector<double> PlyTable::wide_column(std::string_view property) const {
  return column_of<double>(*this, property);
}

PlyTable part_of(const PlyTable& table, std::size_t first, std::size_t count) {
  PlyTable part;
  part.header = table.header;
  part.element = table.element;
  part.element.count = part.rows = count;
  const std::size_t row = table.element.least_row_bytes();
  part.data = table.data.subspan(first * row, count * row);
  return part;
}

std::optional<PlyHeader> ply_header_of(std::span<const std::byte> bytes) {
  TextCursor cursor(bytes);
  return HeaderReading(cursor).header;
}

std::variant<PlyTable, std::string> open_ply_table(std::span<const std::byte> bytes, std::string_view name,
                                                   const WorldBudget& budget) {
  TextCursor cursor(bytes);
  HeaderReading reading(cursor);
  if (!reading.header) return reading.problem();
  PlyTable table;
  table.header = std::move(*reading.header);
  std::vector<const PlyElement*> before;
  const PlyElement* found = find(table.header, name, before);
  if (!found || found->properties.empty()) return "no element '" + std::string(name) + "' in the PLY file";
  table.element = *found;
  before.push_back(found);
  for (const PlyElement* element : before)
    if (element->has_lists()) return "element '" + element->name + "' has lists; expected numbers only";
  before.pop_back();

  if (table.header.format == PlyFormat::ascii) {
    // Each value takes two bytes of text, a digit and a blank, and becomes a double. While the list doubles, it needs
    // twice that memory.
    table.share = Share(budget, Resource::files);
    if (!table.share.grow(8 * bytes.size())) return "the numbers take " + budget->refusal(Resource::files);
    PlyTextSource source(cursor, reinterpret_cast<const char*>(bytes.data()));
    for (const PlyElement* element : before) {
      if (element->properties.empty()) continue;
      const auto most = std::min(element->count, source.most_rows(*element) + 1);
      if (read_text(source, *element, static_cast<std::size_t>(most), nullptr) < element->count) return table;
    }
    const auto most = std::min(table.element.count, source.most_rows(table.element));
    table.rows = read_text(source, table.element, static_cast<std::size_t>(most), &table.values);
    return table;
  }
  table.data = bytes.subspan(static_cast<std::size_t>(cursor.next - reinterpret_cast<const char*>(bytes.data())));
  for (const PlyElement* element : before) {
    const std::size_t row = element->least_row_bytes();
    if (row == 0) continue;
    if (element->count > table.data.size() / row) {
      table.data = {};
      return table;
    }
    table.data = table.data.subspan(static_cast<std::size_t>(element->count) * row);
  }
  table.rows = static_cast<std::size_t>(
      std::min<std::uint64_t>(table.element.count, table.data.size() / table.element.least_row_bytes()));
  return table;
}

}  // namespace gs::app
