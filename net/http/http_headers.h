#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "net/base/address_space.h"

namespace gs::net {

/// Field of a request of our own with the path of a folder that links in the target must not leave. Servers that serve
/// an account to its owner obey it.
inline constexpr const char* kWithinField = "GhostSpace-Within";

/// Reports whether a text can be the value of a field. Control characters could end the field or the head.
[[nodiscard]] bool is_field_value(std::string_view text);

/// Validators of a resource: entity tag and date of modification (RFC 9110 8.8), as received.
struct Validator {
  std::string etag;
  std::string last_modified;
  bool date_is_strong = false;  // last_modified is at least one second earlier than the response (RFC 9110 8.8.2.2)

  [[nodiscard]] bool empty() const { return etag.empty() && last_modified.empty(); }
  /// Returns the validator for If-Range, which must guarantee that all bytes are equal. Returns an empty string if none
  /// does.
  [[nodiscard]] const std::string& strong() const;
  /// Compares the parts that both validators have. Returns true if these parts are equal, or if there are none.
  [[nodiscard]] bool agrees(const Validator& other) const;
};

/// Value of a Content-Range header (RFC 9110 14.4).
struct ContentRange {
  std::optional<std::uint64_t> begin, end;  // bytes from `begin` to before `end`; either both are set or neither
  std::optional<std::uint64_t> total;
};

/// Supported directives of Cache-Control (RFC 9111 5.2.2).
struct CacheControl {
  bool no_store = false;
  bool no_cache = false;
  std::optional<std::int64_t> max_age;  // max-age, seconds
};

/// Head of a response, from a transport to the loader, in the terms of HTTP. Other transports use status 200 for the
/// whole resource and 206 for a range.
struct ResponseHead {
  int status = 200;
  std::string location;
  std::string content_type;
  Validator validator;
  std::optional<std::uint64_t> content_length;  // bytes of the body; nullopt if unknown or if the body is compressed
  std::optional<ContentRange> content_range;
  bool accepts_ranges = false;
  bool encoded = false;  // the body was compressed in transit; the loader gets decompressed bytes
  bool other_answers = false;  // Vary names more fields than Accept-Encoding, so the response must not be cached
  CacheControl cache_control;
  std::optional<std::int64_t> date, expires;  // Unix seconds
  std::int64_t age = 0;                       // seconds
  std::optional<std::int64_t> retry_after;    // seconds from now
  AddressSpace space = AddressSpace::global;  // space of the responding host
};

[[nodiscard]] std::optional<std::uint64_t> parse_decimal(std::string_view text);
/// Parses a Content-Range header. Returns nullopt if the text is invalid or contradictory.
[[nodiscard]] std::optional<ContentRange> parse_content_range(std::string_view text);
[[nodiscard]] CacheControl parse_cache_control(std::string_view text);
/// Parses an HTTP date. Returns Unix seconds, or nullopt if the text is invalid.
[[nodiscard]] std::optional<std::int64_t> parse_http_date(std::string_view text);

/// Adds one header to the head. Ignores the case of `name`, and unknown names. `now` is in Unix seconds.
void add_header(ResponseHead& head, std::string_view name, std::string_view value, std::int64_t now);
/// Completes the head after the last header.
void finish_head(ResponseHead& head);

/// Returns the seconds for which a new response is fresh (RFC 9111 4.2). 0 means that each use must be validated. Does
/// not use Last-Modified: authors reload worlds that they are editing.
[[nodiscard]] std::int64_t freshness(const ResponseHead& head);

}  // namespace gs::net
