#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace gs::net {

/// Bytes of a representation, from `begin` to `end`, without `end`.
struct ServedRange {
  std::uint64_t begin = 0, end = 0;
  friend bool operator==(const ServedRange&, const ServedRange&) = default;
};

/// Result for a missing or ignored Range header: the whole is sent.
struct WholeBody {};
/// Result for ranges without any byte of the representation: status 416.
struct NoSuchRange {};

/// Maximum number of ranges in one request. If there are more, the whole is sent (RFC 9110 14.2 allows it).
constexpr std::size_t kMaxServedRanges = 32;

/// Parses a Range header (RFC 9110 14.1.2) for a body of `size` bytes. Joins overlapping ranges, and ranges with a gap
/// smaller than the overhead of a part of multipart/byteranges. The others keep the order of the request.
[[nodiscard]] std::variant<WholeBody, NoSuchRange, std::vector<ServedRange>> parse_ranges(std::string_view value,
                                                                                          std::uint64_t size);

/// Conditional headers of a request (RFC 9110 13.1). Empty if missing.
struct Conditions {
  std::string if_match, if_none_match, if_modified_since, if_unmodified_since, if_range;
};
enum class Verdict : std::uint8_t { proceed, not_modified, failed };  // 200, 304, 412
/// Evaluates the conditions of GET and HEAD for an existing resource. `modified` is in Unix seconds.
[[nodiscard]] Verdict evaluate(const Conditions& conditions, const std::string& etag, std::int64_t modified);
/// Reports whether the Range header applies: If-Range is missing or names exactly this version (RFC 9110 13.1.5).
[[nodiscard]] bool range_counts(const Conditions& conditions, const std::string& etag, std::int64_t modified);

/// Reports whether an Accept-Encoding header allows gzip (RFC 9110 12.5.3).
[[nodiscard]] bool accepts_gzip(std::string_view accept_encoding);

/// Formats a date such as "Sun, 06 Nov 1994 08:49:37 GMT".
[[nodiscard]] std::string http_date(std::int64_t unix_seconds);

}  // namespace gs::net
