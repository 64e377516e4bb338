#include "app/formats/dicom/dicom_palette.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

namespace gs::app {
namespace {

constexpr std::size_t kMostEntries = 65'536;

/// Expands a table in segments: runs of values, lines to a value, and repetitions of earlier segments.
std::optional<std::vector<double>> expand(std::span<const double> words) {
  std::vector<double> values;
  std::vector<std::size_t> places;  // of segments
  const auto segment = [&](std::size_t& at, bool may_repeat, auto&& self) -> bool {
    if (at + 2 > words.size()) return false;
    const double kind = words[at];
    const auto length = static_cast<std::size_t>(words[at + 1]);
    at += 2;
    if (kind == 0) {
      if (at + length > words.size()) return false;
      values.insert(values.end(), words.begin() + static_cast<std::ptrdiff_t>(at),
                    words.begin() + static_cast<std::ptrdiff_t>(at + length));
      at += length;
    } else if (kind == 1) {
      if (at >= words.size() || values.empty()) return false;
      const double from = values.back(), to = words[at++];
      for (std::size_t i = 1; i <= length; ++i)
        values.push_back(std::round(from + (to - from) * static_cast<double>(i) / static_cast<double>(length)));
    } else if (kind == 2 && may_repeat) {
      if (at + 2 > words.size()) return false;
      auto from = static_cast<std::size_t>(words[at] + words[at + 1] * 65536) / 2;
      at += 2;
      for (std::size_t i = 0; i < length; ++i)
        if (!self(from, false, self)) return false;
    } else {
      return false;
    }
    return values.size() <= kMostEntries;
  };
  for (std::size_t at = 0; at + 1 < words.size();)
    if (!segment(at, true, segment)) return std::nullopt;
  return values;
}

}  // namespace

std::variant<std::vector<DicomTable>, std::string> read_dicom_palette(const DicomDataSet& data,
                                                                      std::uint32_t bits_stored) {
  struct Row {
    const char* name;
    DicomTag descriptor, table, segments;
  };
  static constexpr std::array<Row, 3> kRows{
      {{"red", DicomTag::red_descriptor, DicomTag::red_table, DicomTag::red_segments},
       {"green", DicomTag::green_descriptor, DicomTag::green_table, DicomTag::green_segments},
       {"blue", DicomTag::blue_descriptor, DicomTag::blue_table, DicomTag::blue_segments}}};
  std::vector<DicomTable> tables;
  for (const Row& row : kRows) {
    const std::vector<double> descriptor = data.numbers(row.descriptor, 3);
    const std::string missing = std::string("the colour table of ") + row.name + " is missing or damaged";
    if (descriptor.size() != 3) return missing;
    const std::size_t count = descriptor[0] == 0 ? kMostEntries : static_cast<std::size_t>(descriptor[0]);
    DicomTable table;
    table.first = static_cast<std::int32_t>(descriptor[1]);
    if (table.first >= 32768 && bits_stored <= 16 && table.first + count > kMostEntries) table.first -= 65536;
    const DicomElement* stored = data.find(row.table);
    std::vector<double> values;
    if (stored && descriptor[2] == 8 && stored->value.size() < count * 2) {
      // Entries of 8 bits, two in a word.
      for (std::size_t i = 0; i < std::min(count, stored->value.size()); ++i)
        values.push_back(std::to_integer<int>(stored->value[stored->big_endian ? (i ^ 1u) : i]));
    } else if (stored) {
      values = data.numbers(row.table, count);
    } else {
      auto expanded = expand(data.numbers(row.segments, kMostEntries));
      if (!expanded) return missing;
      values = std::move(*expanded);
    }
    if (values.empty()) return missing;
    // Some writers state 16 bits, but have entries of 8.
    const bool wide = descriptor[2] != 8 && *std::ranges::max_element(values) > 255;
    for (const double value : values)
      table.entries.push_back(static_cast<std::uint8_t>(static_cast<std::uint32_t>(value) >> (wide ? 8 : 0)));
    tables.push_back(std::move(table));
  }
  return tables;
}

}  // namespace gs::app
