#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "net/base/address_space.h"

namespace gs::net {

/// Entity tag and date that identify a version of a resource (RFC 9110 8.8). All strings as received.
struct Validator {
  std::string etag;
  std::string last_modified;
  bool date_is_strong = false;  // last_modified is at least a second older than the response (RFC 9110 8.8.2.2)

  [[nodiscard]] bool empty() const { return etag.empty() && last_modified.empty(); }
  /// Returns the validator for If-Range, which promises equality of all bytes. Empty if there is no such validator.
  [[nodiscard]] const std::string& strong() const;
  /// Reports whether the parts that both validators have are equal. Two validators without common parts agree.
  [[nodiscard]] bool agrees(const Validator& other) const;
};

/// Value of a Content-Range header (RFC 9110 14.4).
struct ContentRange {
  std::optional<std::uint64_t> begin, end;  // without `end`; both or neither
  std::optional<std::uint64_t> total;
};

/// Supported directives of Cache-Control (RFC 9111 5.2.2).
struct CacheControl {
  bool no_store = false;
  bool no_cache = false;
  std::optional<std::int64_t> max_age;  // seconds
};

/// Start of a response, from transports to the loader, in terms of HTTP. Other transports use status 200 for the whole
/// resource and 206 for a range.
struct ResponseHead {
  int status = 200;
  std::string location;
  std::string content_type;
  Validator validator;
  std::optional<std::uint64_t> content_length;  // bytes of the body; nullopt if unknown or if the body is encoded
  std::optional<ContentRange> content_range;
  bool accepts_ranges = false;
  bool encoded = false;        // the body is compressed in transit; the loader receives it decompressed
  bool other_answers = false;  // Vary names more than the encoding, so the response must not be cached
  CacheControl cache_control;
  std::optional<std::int64_t> date, expires;  // Unix seconds
  std::int64_t age = 0;                       // seconds
  std::optional<std::int64_t> retry_after;    // seconds from now
  AddressSpace space = AddressSpace::global;  // of the host that responds
};

[[nodiscard]] std::optional<std::uint64_t> parse_decimal(std::string_view text);
/// Parses a byte range. Returns nullopt if it is not one or contradicts itself.
[[nodiscard]] std::optional<ContentRange> parse_content_range(std::string_view text);
[[nodiscard]] CacheControl parse_cache_control(std::string_view text);
/// Parses a date to Unix seconds. Returns nullopt for other text.
[[nodiscard]] std::optional<std::int64_t> parse_http_date(std::string_view text);

/// Applies one header. `name` in any case; unknown names are ignored. `now` in Unix seconds.
void add_header(ResponseHead& head, std::string_view name, std::string_view value, std::int64_t now);
/// Completes the head after the last header.
void finish_head(ResponseHead& head);

/// Returns the seconds for which a new response stays fresh (RFC 9111 4.2), or 0 if each use must validate it. Derives
/// nothing from Last-Modified, because authors reload worlds that they are editing.
[[nodiscard]] std::int64_t freshness(const ResponseHead& head);

}  // namespace gs::net
