#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace gs::net {

/// Bytes from `begin` to before `end` of a representation.
struct ServedRange {
  std::uint64_t begin = 0, end = 0;
  friend bool operator==(const ServedRange&, const ServedRange&) = default;
};

/// Result if the Range header is missing or ignored: the response has the whole representation.
struct WholeBody {};
/// Result if no range contains a byte of the representation: status 416.
struct NoSuchRange {};

/// Maximum number of ranges in one request. With more, the response has the whole representation, as RFC 9110 14.2
/// allows.
constexpr std::size_t kMaxServedRanges = 32;

/// Parses a Range header (RFC 9110 14.1.2) for a body of `size` bytes. Joins ranges that overlap, or that have a gap
/// smaller than the overhead of multipart/byteranges. Other ranges stay in the order of the request.
[[nodiscard]] std::variant<WholeBody, NoSuchRange, std::vector<ServedRange>> parse_ranges(std::string_view value,
                                                                                          std::uint64_t size);

/// Conditional headers of a request (RFC 9110 13.1). Missing headers are empty.
struct Conditions {
  std::string if_match, if_none_match, if_modified_since, if_unmodified_since, if_range;
};
enum class Verdict : std::uint8_t { proceed, not_modified, failed };  // status 200, 304 or 412
/// Evaluates the conditions of GET and HEAD for an existing resource. `modified` is in Unix seconds.
[[nodiscard]] Verdict evaluate(const Conditions& conditions, const std::string& etag, std::int64_t modified);
/// Reports whether the Range header applies: If-Range is missing or names exactly this version (RFC 9110 13.1.5).
[[nodiscard]] bool range_counts(const Conditions& conditions, const std::string& etag, std::int64_t modified);

/// Reports whether an Accept-Encoding header allows gzip (RFC 9110 12.5.3).
[[nodiscard]] bool accepts_gzip(std::string_view accept_encoding);

/// Formats a time as an HTTP date, such as "Sun, 06 Nov 1994 08:49:37 GMT".
[[nodiscard]] std::string http_date(std::int64_t unix_seconds);

}  // namespace gs::net
