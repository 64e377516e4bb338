#include "net/http/http_headers.h"

#include <catch2/catch.hpp>

namespace {

using namespace gs::net;

TEST_CASE("parses Content-Range strictly (RFC 9110 14.4)") {
  const auto range = parse_content_range("bytes 42-1233/1234");
  REQUIRE(range);
  CHECK(range->begin == 42u);
  CHECK(range->end == 1234u);
  CHECK(range->total == 1234u);
  CHECK_FALSE(parse_content_range("bytes 42-1233/*")->total);
  const auto none = parse_content_range("bytes */1234");
  REQUIRE(none);
  CHECK_FALSE(none->begin);
  CHECK(none->total == 1234u);
  for (const char* text : {"", "bytes", "bytes ", "bytes 5-4/10", "bytes 5-10/10", "bytes -5/10", "bytes 5-/10",
                           "bytes 5/10", "bytes */*", "items 1-2/3", "bytes 1-2", "bytes 0-18446744073709551615/*",
                           "bytes 0-99999999999999999999/*", "bytes 1 -2/3x", "bytes +1-2/3"})
    CHECK_FALSE(parse_content_range(text));
}

TEST_CASE("computes freshness from Cache-Control (RFC 9111)") {
  CHECK(parse_cache_control("public, Max-Age=60").max_age == 60);
  CHECK(parse_cache_control("max-age=\"60\"").max_age == 60);
  CHECK(parse_cache_control("max-age=99999999999999999999999").max_age == 0);
  CHECK(parse_cache_control("max-age=x").max_age == 0);
  CHECK(parse_cache_control("no-store").no_store);
  CHECK(parse_cache_control("private,no-cache=\"Set-Cookie\"").no_cache);
  ResponseHead head;
  CHECK(freshness(head) == 0);
  head.cache_control.max_age = 100;
  head.age = 30;
  CHECK(freshness(head) == 70);
  head.age = 200;
  CHECK(freshness(head) == 0);
  head = {};
  add_header(head, "Date", "Sun, 06 Nov 1994 08:49:37 GMT", 0);
  add_header(head, "EXPIRES", "Sunday, 06-Nov-94 08:50:37 GMT", 0);
  CHECK(freshness(head) == 60);
  add_header(head, "Cache-Control", "no-cache", 0);
  CHECK(freshness(head) == 0);
  head = {};
  add_header(head, "Date", "Sun, 06 Nov 1994 08:49:37 GMT", 0);
  add_header(head, "Expires", "0", 0);
  CHECK(freshness(head) == 0);
}

TEST_CASE("control characters are not part of field values") {
  CHECK(is_field_value("bytes=0-99"));
  CHECK(is_field_value(""));
  CHECK(is_field_value("\xc3\xa4"));
  for (const char* const text : {"a\r\nHost: b", "a\nb", "a\tb", "\x01"}) CHECK_FALSE(is_field_value(text));
}

TEST_CASE("parses dates in all three forms") {
  for (const char* text :
       {"Sun, 06 Nov 1994 08:49:37 GMT", "Sunday, 06-Nov-94 08:49:37 GMT", "Sun Nov  6 08:49:37 1994"})
    CHECK(parse_http_date(text) == 784111777);
  CHECK_FALSE(parse_http_date("yesterday"));
  CHECK_FALSE(parse_http_date(std::string(1000, '1')));
}

TEST_CASE("builds a head from its headers") {
  ResponseHead head;
  add_header(head, "content-LENGTH", " 12 ", 0);
  add_header(head, "Accept-Ranges", "bytes", 0);
  add_header(head, "ETag", "\"a\"", 0);
  add_header(head, "Last-Modified", "Sun, 06 Nov 1994 08:49:37 GMT", 0);
  add_header(head, "Date", "Sun, 06 Nov 1994 08:49:37 GMT", 0);
  add_header(head, "Retry-After", "Sun, 06 Nov 1994 08:49:37 GMT", 784111700);
  add_header(head, "Vary", "Accept-Encoding, Accept", 0);
  finish_head(head);
  CHECK(head.content_length == 12u);
  CHECK(head.accepts_ranges);
  CHECK(head.retry_after == 77);
  CHECK_FALSE(head.other_answers);
  CHECK_FALSE(head.validator.date_is_strong);
  add_header(head, "Vary", "User-Agent", 0);
  add_header(head, "Content-Encoding", "gzip", 0);
  add_header(head, "Content-Length", "-1", 0);
  finish_head(head);
  CHECK(head.other_answers);
  CHECK(head.encoded);
  CHECK_FALSE(head.content_length);
}

TEST_CASE("compares versions by strong and weak validators") {
  const Validator strong{"\"a\"", "Mon", false}, other{"\"b\"", "Mon", false}, weak{"W/\"a\"", "", false};
  CHECK(strong.strong() == "\"a\"");
  CHECK(weak.strong().empty());
  CHECK(Validator{"", "Mon", true}.strong() == "Mon");
  CHECK(Validator{"", "Mon", false}.strong().empty());
  CHECK(strong.agrees(strong));
  CHECK_FALSE(strong.agrees(other));
  CHECK_FALSE(strong.agrees(weak));
  CHECK_FALSE(strong.agrees({"", "Mon", true}));
  CHECK(strong.agrees({}));
  CHECK_FALSE(Validator{"", "Mon", true}.agrees({"", "Tue", true}));
}

}  // namespace
