#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "net/base/address_space.h"

namespace gs::net {

/// What tells versions of a resource apart (RFC 9110 8.8). All strings as the server wrote them.
struct Validator {
  std::string etag;
  std::string last_modified;
  bool date_is_strong = false;  // last_modified is at least a second older than the answer (RFC 9110 8.8.2.2)

  [[nodiscard]] bool empty() const { return etag.empty() && last_modified.empty(); }
  /// What to send in If-Range: equal means equal to the last byte. Empty where nothing promises that.
  [[nodiscard]] const std::string& strong() const;
  /// Nothing that both name is different. Two validators without anything in common agree.
  [[nodiscard]] bool agrees(const Validator& other) const;
};

/// The value of a Content-Range header (RFC 9110 14.4).
struct ContentRange {
  std::optional<std::uint64_t> begin, end;  // end is not among them; both or none
  std::optional<std::uint64_t> total;
};

/// What of Cache-Control is understood (RFC 9111 5.2.2).
struct CacheControl {
  bool no_store = false;
  bool no_cache = false;
  std::optional<std::int64_t> max_age;  // seconds
};

/// The start of an answer: what transports tell the loader, in the words of HTTP. Other transports use status 200 for
/// the whole and 206 for a range.
struct ResponseHead {
  int status = 200;
  std::string location;
  std::string content_type;
  Validator validator;
  std::optional<std::uint64_t> content_length;  // bytes of the body; none when it is not known or the body is encoded
  std::optional<ContentRange> content_range;
  bool accepts_ranges = false;
  bool encoded = false;        // the body is compressed on the way; what the loader gets is decompressed
  bool other_answers = false;  // Vary names more than the encoding: not to be cached
  CacheControl cache_control;
  std::optional<std::int64_t> date, expires;  // Unix seconds
  std::int64_t age = 0;                       // seconds
  std::optional<std::int64_t> retry_after;    // seconds from now
  AddressSpace space = AddressSpace::global;  // of the host that answers
};

[[nodiscard]] std::optional<std::uint64_t> parse_decimal(std::string_view text);
/// Nothing for what is no byte range or contradicts itself.
[[nodiscard]] std::optional<ContentRange> parse_content_range(std::string_view text);
[[nodiscard]] CacheControl parse_cache_control(std::string_view text);
/// Unix seconds; nothing for what is no date.
[[nodiscard]] std::optional<std::int64_t> parse_http_date(std::string_view text);

/// Takes one header into account. `name` in any case; unknown ones are passed over. `now` in Unix seconds.
void add_header(ResponseHead& head, std::string_view name, std::string_view value, std::int64_t now);
/// To be called behind the last header.
void finish_head(ResponseHead& head);

/// How long an answer that has just come stays fresh, in seconds (RFC 9111 4.2); 0 when it must be validated each time.
/// Nothing is guessed from Last-Modified: authors reload worlds that they are writing.
[[nodiscard]] std::int64_t freshness(const ResponseHead& head);

}  // namespace gs::net
