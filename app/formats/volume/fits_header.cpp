#include "app/formats/volume/fits_header.h"

#include "app/formats/common/text_cursor.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <utility>

// Reader of FITS 4.0 headers (https://fits.gsfc.nasa.gov/fits_standard.html). Clauses refer to that standard.

namespace gs::app {
namespace {

constexpr std::size_t kFitsKeyword = 8;
constexpr std::uint64_t kMaxFitsBytes = std::numeric_limits<std::int64_t>::max();

std::string_view without_blanks(std::string_view text) {
  while (text.starts_with(' ')) text.remove_prefix(1);
  while (text.ends_with(' ')) text.remove_suffix(1);
  return text;
}

/// Returns the text after "=" if the card has this keyword and a value (4.1.2.2), else nullopt.
std::optional<std::string_view> behind_equals(std::string_view card, std::string_view keyword) {
  if (card[kFitsKeyword] != '=' || !card.starts_with(keyword)) return std::nullopt;
  if (card.substr(keyword.size(), kFitsKeyword - keyword.size()).find_first_not_of(' ') != std::string_view::npos)
    return std::nullopt;
  return card.substr(kFitsKeyword + 1);
}

/// Returns a value without the comment after it. In a string, two quotes stand for one quote and do not end the string.
std::string_view without_comment(std::string_view text) {
  text = without_blanks(text);
  if (!text.starts_with('\'')) return without_blanks(text.substr(0, text.find('/')));
  for (std::size_t i = 1; i < text.size(); ++i) {
    if (text[i] != '\'') continue;
    if (i + 1 == text.size() || text[i + 1] != '\'') return text.substr(0, i + 1);
    ++i;
  }
  return text;
}

std::string unquoted(std::string_view value) {
  if (!value.starts_with('\'')) return std::string(value);
  std::string text;
  for (std::size_t i = 1; i < value.size(); ++i) {
    if (value[i] == '\'' && ++i == value.size()) break;  // a single quote ends the string, a doubled one is a quote
    text += value[i];
  }
  text.resize(text.find_last_not_of(' ') + 1);  // for only blanks, npos + 1 is 0
  return text;
}

std::optional<std::int64_t> fits_integer(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// Returns a * b, or nullopt if it exceeds the maximum file size.
std::optional<std::uint64_t> fits_product(std::uint64_t a, std::uint64_t b) {
  if (a != 0 && b > kMaxFitsBytes / a) return std::nullopt;
  return a * b;
}

std::uint64_t whole_blocks(std::uint64_t bytes) { return (bytes + kFitsBlock - 1) / kFitsBlock * kFitsBlock; }

std::string card_found(const FitsHeader& header, const std::string& keyword) {
  const auto value = header.value(keyword);
  return value ? keyword + " is " + std::string(*value) : keyword + " is missing";
}

/// Reads the mandatory keywords (4.4.1). Returns a message if they are missing or invalid.
std::optional<std::string> read_fits_shape(FitsUnit& unit) {
  constexpr std::int64_t kMaxAxes = 999;
  const FitsHeader& header = unit.header;
  const auto bits = header.integer("BITPIX");
  static constexpr int kBits[] = {8, 16, 32, 64, -32, -64};
  if (!bits || std::find(std::begin(kBits), std::end(kBits), *bits) == std::end(kBits))
    return card_found(header, "BITPIX") + "; expected 8, 16, 32, 64, -32 or -64";
  unit.bits = static_cast<int>(*bits);
  const auto count = header.integer("NAXIS");
  if (!count || *count < 0 || *count > kMaxAxes)
    return card_found(header, "NAXIS") + "; expected an integer from 0 to " + std::to_string(kMaxAxes);
  for (const auto& length : header.axis_lengths(static_cast<std::size_t>(*count))) {
    if (!length || *length < 0)
      return card_found(header, "NAXIS" + std::to_string(unit.axes.size() + 1)) + "; expected an integer of at least 0";
    unit.axes.push_back(static_cast<std::uint64_t>(*length));
  }
  return std::nullopt;
}

/// Returns the size of the data in bytes, by equations (1), (2) and (4) of the standard, or a message.
std::variant<std::uint64_t, std::string> fits_data_size(FitsUnit& unit, bool counts_groups, bool random_groups) {
  const FitsHeader& header = unit.header;
  std::uint64_t parameters = 0;
  if (counts_groups) {
    for (const auto& [keyword, to] : {std::pair("PCOUNT", &parameters), std::pair("GCOUNT", &unit.groups)}) {
      const auto value = header.integer(keyword);
      if (header.value(keyword) && (!value || *value < 0))
        return card_found(header, keyword) + "; expected an integer of at least 0";
      if (value) *to = static_cast<std::uint64_t>(*value);
    }
  }
  std::optional<std::uint64_t> elements = unit.axes.empty() ? 0 : 1;
  for (std::size_t i = random_groups ? 1 : 0; i < unit.axes.size() && elements; ++i)
    elements = fits_product(*elements, unit.axes[i]);
  if (elements) *elements += parameters;  // both are below 2^63
  if (elements) elements = fits_product(*elements, unit.groups);
  if (elements) elements = fits_product(*elements, static_cast<std::uint64_t>(std::abs(unit.bits) / 8));
  if (!elements) return std::string("the axes are too long for a file");
  return *elements;
}

}  // namespace

std::variant<FitsHeader, std::string> FitsHeader::read(std::span<const std::byte> file, std::size_t begin,
                                                       std::size_t most) {
  const std::string_view all(reinterpret_cast<const char*>(file.data()), file.size());
  for (std::size_t i = 0; i < most; ++i) {
    const std::size_t at = begin + i * kFitsCard;
    if (all.size() - at < kFitsCard) return std::string("the header ends without END");
    if (without_blanks(all.substr(at, kFitsCard)) == "END")
      return FitsHeader(all.substr(begin, i * kFitsCard), begin + whole_blocks((i + 1) * kFitsCard));
  }
  return "no END among its first " + std::to_string(most) + " cards";
}

std::optional<std::string_view> FitsHeader::value(std::string_view keyword) const {
  for (std::size_t at = 0; at < cards_.size(); at += kFitsCard) {
    const auto behind = behind_equals(cards_.substr(at, kFitsCard), keyword);
    if (!behind) continue;
    const std::string_view value = without_comment(*behind);
    return value.empty() ? std::nullopt : std::optional(value);
  }
  return std::nullopt;
}

std::string FitsHeader::text(std::string_view keyword) const {
  const auto value_there = value(keyword);
  if (!value_there) return "";
  std::string text = unquoted(*value_there);
  // The string continues in the next card (4.2.1.2), so remove the "&" at its end.
  const auto next = static_cast<std::size_t>(value_there->data() - cards_.data()) / kFitsCard + 1;
  if (text.ends_with('&') && cards_.substr(next * kFitsCard).starts_with("CONTINUE")) text.pop_back();
  return text;
}

std::optional<double> FitsHeader::number(std::string_view keyword) const {
  std::string digits = text(keyword);
  std::replace_if(
      digits.begin(), digits.end(), [](char c) { return c == 'D' || c == 'd'; }, 'E');
  TextCursor cursor(digits.data(), digits.data() + digits.size());
  double value = 0;
  if (!cursor.skip_space() || !cursor.number(value)) return std::nullopt;
  if (!cursor.at_end() && !TextCursor::is_space(*cursor.next)) return std::nullopt;
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

std::optional<std::int64_t> FitsHeader::integer(std::string_view keyword) const {
  const auto there = value(keyword);
  return there ? fits_integer(*there) : std::nullopt;
}

std::vector<std::optional<std::int64_t>> FitsHeader::axis_lengths(std::size_t n) const {
  std::vector<std::optional<std::int64_t>> lengths(n);
  std::vector<bool> seen(n);
  for (std::size_t at = 0; at < cards_.size(); at += kFitsCard) {
    constexpr std::string_view kAxis = "NAXIS";
    const std::string_view card = cards_.substr(at, kFitsCard);
    if (!card.starts_with(kAxis)) continue;
    const std::string_view keyword = without_blanks(card.substr(0, kFitsKeyword));
    const auto axis = fits_integer(keyword.substr(kAxis.size()));
    if (!axis || *axis < 1 || static_cast<std::uint64_t>(*axis) > n) continue;
    const auto i = static_cast<std::size_t>(*axis - 1);
    const auto behind = behind_equals(card, keyword);
    if (!behind || seen[i]) continue;
    seen[i] = true;
    lengths[i] = fits_integer(without_comment(*behind));
  }
  return lengths;
}

std::variant<FitsUnit, std::string> read_fits_unit(std::span<const std::byte> file, std::size_t begin,
                                                   std::size_t most_cards) {
  auto read = FitsHeader::read(file, begin, most_cards);
  if (auto* problem = std::get_if<std::string>(&read)) return std::move(*problem);
  FitsUnit unit{std::get<FitsHeader>(read), 0, {}, 1, false, 0};
  if (auto problem = read_fits_shape(unit)) return std::move(*problem);
  const bool extension = begin > 0;
  const bool random_groups = !extension && !unit.axes.empty() && unit.axes[0] == 0 && unit.header.is_true("GROUPS");
  const auto size = fits_data_size(unit, extension || random_groups, random_groups);
  if (const auto* problem = std::get_if<std::string>(&size)) return *problem;
  const std::uint64_t bytes = std::get<std::uint64_t>(size);
  if (bytes > kMaxFitsBytes - unit.header.data_begin() - kFitsBlock)
    return std::string("the axes are too long for a file");
  unit.end = unit.header.data_begin() + whole_blocks(bytes);
  const bool array = !extension || unit.header.text("XTENSION") == "IMAGE";
  unit.is_image = array && !unit.axes.empty() && std::find(unit.axes.begin(), unit.axes.end(), 0u) == unit.axes.end();
  return unit;
}

}  // namespace gs::app
