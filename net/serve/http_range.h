#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace gs::net {

/// Bytes of a representation; `end` is not among them.
struct ServedRange {
  std::uint64_t begin = 0, end = 0;
  friend bool operator==(const ServedRange&, const ServedRange&) = default;
};

/// The whole is to be sent: there is no Range header, or it is to be ignored.
struct WholeBody {};
/// None of the ranges has a byte of it: 416.
struct NoSuchRange {};

/// More ranges than these in one request are ignored (RFC 9110 14.2 allows it):
/// the whole is sent.
constexpr std::size_t kMostServedRanges = 32;

/// Reads the value of a Range header (RFC 9110 14.1.2) for a body of `size`
/// bytes. Ranges that overlap, or between which there is less than a part of
/// multipart/byteranges costs, become one; the others stay in the order of the
/// request.
[[nodiscard]] std::variant<WholeBody, NoSuchRange, std::vector<ServedRange>> parse_ranges(std::string_view value,
                                                                                          std::uint64_t size);

/// What a request says of the version that it wants (RFC 9110 13.1). Empty
/// texts: not said.
struct Conditions {
  std::string if_match, if_none_match, if_modified_since, if_unmodified_since, if_range;
};
enum class Verdict : std::uint8_t { proceed, not_modified, failed };  // 200, 304, 412
/// For GET and HEAD of what exists; `modified` in Unix seconds.
[[nodiscard]] Verdict evaluate(const Conditions& conditions, const std::string& etag, std::int64_t modified);
/// Whether a Range header counts: If-Range, when it is there, must name this
/// very version (RFC 9110 13.1.5).
[[nodiscard]] bool range_counts(const Conditions& conditions, const std::string& etag, std::int64_t modified);

/// Whether an Accept-Encoding header allows gzip (RFC 9110 12.5.3).
[[nodiscard]] bool accepts_gzip(std::string_view accept_encoding);

/// "Sun, 06 Nov 1994 08:49:37 GMT".
[[nodiscard]] std::string http_date(std::int64_t unix_seconds);

}  // namespace gs::net
