#include "net/serve/http_range.h"

#include "net/base/header_text.h"
#include "net/http/http_headers.h"

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <optional>

namespace gs::net {
namespace {

constexpr std::uint64_t kPartCost = 120;  // approximate bytes of a part's boundary and headers

bool equal_word(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) {
    const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; };
    return lower(x) == lower(y);
  });
}

template <typename Each>
void for_each_item(std::string_view list, const Each& each) {
  for (;;) {
    const std::size_t comma = list.find(',');
    each(without_blanks(list.substr(0, comma)));
    if (comma == std::string_view::npos) return;
    list.remove_prefix(comma + 1);
  }
}

// Parses a number. Returns the maximum if the number overflows; this exceeds every body.
std::optional<std::uint64_t> number(std::string_view digits) {
  if (digits.empty() || digits.find_first_not_of("0123456789") != std::string_view::npos) return std::nullopt;
  return parse_decimal(digits).value_or(UINT64_MAX);
}

// Adds one range to `out`. Returns false if the text is not a range. Adds nothing if the range contains no bytes.
bool add_range(std::string_view item, std::uint64_t size, std::vector<ServedRange>& out) {
  const std::size_t dash = item.find('-');
  if (dash == std::string_view::npos) return false;
  const std::string_view first = without_blanks(item.substr(0, dash)), last = without_blanks(item.substr(dash + 1));
  if (first.empty()) {
    const auto length = number(last);
    if (!length) return false;
    if (*length > 0 && size > 0) out.push_back({size - std::min(size, *length), size});
    return true;
  }
  const auto begin = number(first);
  const auto end = last.empty() ? std::optional(UINT64_MAX) : number(last);
  if (!begin || !end || *end < *begin) return false;
  if (*begin < size) out.push_back({*begin, std::min(*end, size - 1) + 1});
  return true;
}

bool near(const ServedRange& a, const ServedRange& b) {
  const std::uint64_t begin = std::max(a.begin, b.begin), end = std::min(a.end, b.end);
  return begin <= end || begin - end < kPartCost;
}

std::vector<ServedRange> joined(const std::vector<ServedRange>& ranges) {
  std::vector<ServedRange> out;
  for (ServedRange range : ranges) {
    // Join further ranges that now touch the joined range.
    for (std::size_t i = 0; i < out.size();) {
      if (!near(out[i], range)) {
        ++i;
        continue;
      }
      range = {std::min(out[i].begin, range.begin), std::max(out[i].end, range.end)};
      out.erase(out.begin() + static_cast<std::ptrdiff_t>(i));
      i = 0;
    }
    out.push_back(range);
  }
  return out;
}

std::string_view opaque(std::string_view etag) { return etag.starts_with("W/") ? etag.substr(2) : etag; }

// Reports whether a list of entity tags contains `etag`. If `strong`, weak tags never match.
bool lists(std::string_view value, std::string_view etag, bool strong) {
  if (without_blanks(value) == "*") return true;
  if (strong && etag.starts_with("W/")) return false;
  bool found = false;
  for_each_item(value, [&](std::string_view item) {
    if (strong ? item == etag : opaque(item) == opaque(etag)) found = true;
  });
  return found;
}

}  // namespace

std::variant<WholeBody, NoSuchRange, std::vector<ServedRange>> parse_ranges(std::string_view value,
                                                                            std::uint64_t size) {
  const std::size_t equals = value.find('=');
  if (equals == std::string_view::npos || !equal_word(without_blanks(value.substr(0, equals)), "bytes"))
    return WholeBody{};
  std::vector<ServedRange> ranges;
  std::size_t items = 0;
  bool sound = true;
  for_each_item(value.substr(equals + 1), [&](std::string_view item) {
    if (item.empty() || ++items > kMaxServedRanges) {  // ignore empty elements (RFC 9110 5.6.1)
      sound = sound && items <= kMaxServedRanges;
    } else if (!add_range(item, size, ranges)) {
      sound = false;
    }
  });
  if (!sound || items == 0) return WholeBody{};
  if (ranges.empty()) return NoSuchRange{};
  return joined(ranges);
}

Verdict evaluate(const Conditions& conditions, const std::string& etag, std::int64_t modified) {
  if (!conditions.if_match.empty()) {
    if (!lists(conditions.if_match, etag, true)) return Verdict::failed;
  } else if (const auto date = parse_http_date(conditions.if_unmodified_since); date && modified > *date) {
    return Verdict::failed;
  }
  if (!conditions.if_none_match.empty())
    return lists(conditions.if_none_match, etag, false) ? Verdict::not_modified : Verdict::proceed;
  const auto date = parse_http_date(conditions.if_modified_since);
  return date && modified <= *date ? Verdict::not_modified : Verdict::proceed;
}

bool range_counts(const Conditions& conditions, const std::string& etag, std::int64_t modified) {
  const std::string_view value = without_blanks(conditions.if_range);
  if (value.empty()) return true;
  if (value.front() == '"') return value == etag;
  if (value.starts_with("W/")) return false;
  const auto date = parse_http_date(value);
  return date && *date == modified;
}

bool accepts_gzip(std::string_view accept_encoding) {
  std::optional<bool> gzip, any;
  for_each_item(accept_encoding, [&](std::string_view item) {
    const std::size_t semicolon = item.find(';');
    const std::string_view name = without_blanks(item.substr(0, semicolon));
    bool wanted = true;
    if (semicolon != std::string_view::npos) {
      std::string_view weight = without_blanks(item.substr(semicolon + 1));
      if (weight.starts_with("q=") || weight.starts_with("Q="))
        wanted = weight.substr(2).find_first_not_of("0.") != std::string_view::npos;
    }
    if (equal_word(name, "gzip") || equal_word(name, "x-gzip")) gzip = wanted;
    if (name == "*") any = wanted;
  });
  return gzip.value_or(any.value_or(false));
}

std::string http_date(std::int64_t unix_seconds) {
  static constexpr const char* kDays[] = {"Sun", "Mon", "Tue", "Wed", "Thu", "Fri", "Sat"};
  static constexpr const char* kMonths[] = {"Jan", "Feb", "Mar", "Apr", "May", "Jun",
                                            "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"};
  const auto time = static_cast<std::time_t>(unix_seconds);
  std::tm parts{};
  if (!gmtime_r(&time, &parts)) return {};
  char text[64];
  std::snprintf(text, sizeof text, "%s, %02d %s %04d %02d:%02d:%02d GMT", kDays[parts.tm_wday % 7], parts.tm_mday,
                kMonths[parts.tm_mon % 12], parts.tm_year + 1900, parts.tm_hour, parts.tm_min, parts.tm_sec);
  return text;
}

}  // namespace gs::net
