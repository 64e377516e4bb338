#include "net/http/http_headers.h"

#include <algorithm>
#include <charconv>
#include <ctime>

#include "net/http/curl_library.h"

namespace gs::net {
namespace {

constexpr std::int64_t kLongestAge = std::int64_t{1} << 31;  // maximum seconds (RFC 9111 1.2.2)

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t' || text.back() == '\r' || text.back() == '\n'))
    text.remove_suffix(1);
  return text;
}

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return result;
}

/// Calls `use` for each element of a comma-separated list.
template <class Use>
void each_in_list(std::string_view list, Use use) {
  while (!list.empty()) {
    const std::size_t comma = std::min(list.find(','), list.size());
    use(trimmed(list.substr(0, comma)));
    list.remove_prefix(std::min(comma + 1, list.size()));
  }
}

std::optional<std::int64_t> parse_seconds(std::string_view text) {
  const auto number = parse_decimal(text);
  if (!number) return std::nullopt;
  return static_cast<std::int64_t>(std::min<std::uint64_t>(*number, kLongestAge));
}

bool is_weak(const std::string& etag) { return etag.starts_with("W/"); }

}  // namespace

bool is_field_value(std::string_view text) {
  return std::none_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; });
}

const std::string& Validator::strong() const {
  static const std::string kNone;
  if (!etag.empty()) return is_weak(etag) ? kNone : etag;
  return date_is_strong ? last_modified : kNone;
}

bool Validator::agrees(const Validator& other) const {
  if (!etag.empty() && !other.etag.empty()) return etag == other.etag;
  // A server with entity tags sends one with each response. So a missing tag means another version.
  if (etag.empty() != other.etag.empty() && !empty() && !other.empty()) return false;
  return last_modified.empty() || other.last_modified.empty() || last_modified == other.last_modified;
}

std::optional<std::uint64_t> parse_decimal(std::string_view text) {
  text = trimmed(text);
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::optional<ContentRange> parse_content_range(std::string_view text) {
  text = trimmed(text);
  if (lower(text.substr(0, 6)) != "bytes ") return std::nullopt;
  text = trimmed(text.substr(6));
  const std::size_t slash = text.find('/');
  if (slash == std::string_view::npos) return std::nullopt;
  ContentRange result;
  const std::string_view total = trimmed(text.substr(slash + 1)), range = trimmed(text.substr(0, slash));
  if (total != "*") {
    result.total = parse_decimal(total);
    if (!result.total) return std::nullopt;
  }
  if (range == "*") return result.total ? std::optional(result) : std::nullopt;
  const std::size_t dash = range.find('-');
  if (dash == std::string_view::npos) return std::nullopt;
  result.begin = parse_decimal(range.substr(0, dash));
  const auto last = parse_decimal(range.substr(dash + 1));
  if (!result.begin || !last || *last < *result.begin || *last == UINT64_MAX) return std::nullopt;
  result.end = *last + 1;
  if (result.total && *result.end > *result.total) return std::nullopt;
  return result;
}

CacheControl parse_cache_control(std::string_view text) {
  CacheControl result;
  each_in_list(text, [&result](std::string_view part) {
    const std::size_t equals = std::min(part.find('='), part.size());
    const std::string name = lower(trimmed(part.substr(0, equals)));
    std::string_view value = trimmed(part.substr(std::min(equals + 1, part.size())));
    if (value.size() >= 2 && value.front() == '"' && value.back() == '"') value = value.substr(1, value.size() - 2);
    if (name == "no-store") result.no_store = true;
    // Treat no-cache="field", which applies to one field only, like plain no-cache; this is safe.
    if (name == "no-cache") result.no_cache = true;
    if (name == "max-age") result.max_age = parse_seconds(value).value_or(0);
  });
  return result;
}

std::optional<std::int64_t> parse_http_date(std::string_view text) {
  if (text.size() > 64 || !curl().problem.empty()) return std::nullopt;
  const std::time_t time = curl().curl_getdate(std::string(trimmed(text)).c_str(), nullptr);
  if (time < 0) return std::nullopt;
  return static_cast<std::int64_t>(time);
}

void add_header(ResponseHead& head, std::string_view raw_name, std::string_view value, std::int64_t now) {
  const std::string name = lower(trimmed(raw_name));
  value = trimmed(value);
  if (name == "location") head.location = value;
  if (name == "content-type") head.content_type = value;
  if (name == "etag") head.validator.etag = value;
  if (name == "last-modified") head.validator.last_modified = value;
  if (name == "content-length") head.content_length = parse_decimal(value);
  if (name == "content-range") head.content_range = parse_content_range(value);
  if (name == "accept-ranges") head.accepts_ranges = lower(value) == "bytes";
  if (name == "content-encoding") head.encoded = !value.empty() && lower(value) != "identity";
  if (name == "date") head.date = parse_http_date(value);
  // Invalid dates, especially 0, mean that the response has expired (RFC 9111 5.3).
  if (name == "expires") head.expires = parse_http_date(value).value_or(0);
  if (name == "age") head.age = parse_seconds(value).value_or(0);
  if (name == "retry-after") {
    head.retry_after = parse_seconds(value);
    if (const auto date = parse_http_date(value); !head.retry_after && date)
      head.retry_after = std::max<std::int64_t>(0, *date - now);
  }
  if (name == "cache-control") {
    const CacheControl more = parse_cache_control(value);
    head.cache_control.no_store |= more.no_store;
    head.cache_control.no_cache |= more.no_cache;
    if (more.max_age) head.cache_control.max_age = more.max_age;
  }
  if (name == "vary")
    each_in_list(value, [&head](std::string_view part) {
      const std::string field = lower(part);
      // Ignore these names: curl decodes the content, Accept is part of the cache key, and Origin and cookies are never
      // sent.
      if (field != "accept-encoding" && field != "accept" && field != "origin" && field != "cookie")
        head.other_answers = true;
    });
}

void finish_head(ResponseHead& head) {
  if (head.encoded) head.content_length.reset();
  const auto modified = parse_http_date(head.validator.last_modified);
  head.validator.date_is_strong = modified && head.date && *modified < *head.date;
  if (head.status == 206) head.accepts_ranges = true;
}

std::int64_t freshness(const ResponseHead& head) {
  if (head.cache_control.no_cache || head.cache_control.no_store) return 0;
  std::int64_t lifetime = 0;
  if (head.cache_control.max_age)
    lifetime = *head.cache_control.max_age;
  else if (head.expires && head.date)
    lifetime = std::min(kLongestAge, *head.expires - *head.date);
  return std::max<std::int64_t>(0, lifetime - head.age);
}

}  // namespace gs::net
