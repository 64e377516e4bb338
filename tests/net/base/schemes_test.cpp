#include "net/base/schemes.h"

#include <catch2/catch.hpp>

#include <set>

#include "net/load/transport.h"

namespace {

using namespace gs::net;

TEST_CASE("has one row per scheme") {
  std::set<std::string_view> names;
  for (const Scheme& scheme : schemes()) CHECK(names.insert(scheme.name).second);
  CHECK(names == std::set<std::string_view>{"file", "http", "https", "ftp", "data", "cells", "memory"});
  CHECK_FALSE(find_scheme("gopher"));
  CHECK_FALSE(find_scheme("HTTP"));
}

TEST_CASE("shows no passwords in messages") {
  CHECK(url_for_messages("http://user:secret@host/a?b#c") == "http://host/a?b#c");
  CHECK(url_for_messages("http://user@x:secret@host/a@b") == "http://host/a@b");
  CHECK(url_for_messages("http://host/a@b") == "http://host/a@b");
  CHECK(url_for_messages("http:///user:secret@host/a") == "http:///host/a");
  CHECK(url_for_messages("http:/user:secret@host/a") == "http:/host/a");
  CHECK(url_for_messages("file:///a@b/c") == "file:///a@b/c");
  CHECK(url_for_messages("a\nb") == "a?b");
  CHECK(url_for_messages("data:," + std::string(1000, 'x')).size() == 203);
}

TEST_CASE("gives a URL one canonical spelling, or none without a host (RFC 3986 6.2)") {
  const auto canonical = [](std::string_view url) {
    const auto found = canonical_url(parse_url(url));
    return found ? found->text() : "none";
  };
  CHECK(canonical("HTTP://Example.ORG:80/A?B#C") == "http://example.org/A?B#C");
  CHECK(canonical("https://user:Secret@Example.org:443") == "https://user:Secret@example.org");
  CHECK(canonical("http://example.org:8080/") == "http://example.org:8080/");
  CHECK(canonical("http://example.org:/") == "http://example.org/");
  CHECK(canonical("ftp://example.org:21/a") == "ftp://example.org/a");
  CHECK(canonical("cells://example.org:21/a") == "cells://example.org:21/a");
  CHECK(canonical("http://[2001:DB8::1]:80/") == "http://[2001:db8::1]/");
  for (const char* url :
       {"http:///user:pw@127.0.0.1:1/x", "http:/127.0.0.1/x", "http:127.0.0.1/x", "http:", "http://", "https://:443/",
        "ftp:///127.0.0.1:1021/x", "cells:/a", "http://user@/x", "http://a:99999/", "http://a:b/", "http://[::1/"})
    CHECK(canonical(url) == "none");
  CHECK(canonical("file:///A") == "file:///A");
  CHECK(canonical("file:/A") == "file:/A");
  CHECK(canonical("data:,A") == "data:,A");
  CHECK(canonical("memory:A") == "memory:A");
  CHECK(canonical("a/B") == "a/B");
}

std::string text_of(std::string_view url) {
  const auto decoded = decode_data_url(url);
  if (!decoded) return "none";
  return decoded->media_type + "|" +
         std::string(reinterpret_cast<const char*>(decoded->bytes.data()), decoded->bytes.size());
}

TEST_CASE("decodes data URLs (RFC 2397)") {
  CHECK(text_of("data:,A%20brief%20note") == "text/plain;charset=US-ASCII|A brief note");
  CHECK(text_of("data:;charset=utf-8,x") == "text/plain;charset=utf-8|x");
  CHECK(text_of("data:text/plain;base64,SGVsbG8h") == "text/plain|Hello!");
  CHECK(text_of("DATA:text/plain;BASE64,SGVs\nbG8") == "text/plain|Hello");
  CHECK(text_of("data:a/b;base64,SGVsbG8%3D") == "a/b|Hello");
  CHECK(text_of("data:a/b;base64,") == "a/b|");
  CHECK(text_of("data:a/b;base64,A") == "none");
  CHECK(text_of("data:a/b;base64,AA=A") == "none");
  CHECK(text_of("data:a/b;base64,A!AA") == "none");
  CHECK(text_of("data:a/b") == "none");
  CHECK(text_of("data") == "none");
  CHECK(text_of("a,data:") == "none");
  CHECK(text_of("data:,x#fragment") == "text/plain;charset=US-ASCII|x");
  CHECK(text_of("data:model/vrml,#VRML V2.0 utf8") == "model/vrml|#VRML V2.0 utf8");
  CHECK(text_of("data:,%4") == "text/plain;charset=US-ASCII|%4");
  CHECK(text_of("data:,100%") == "text/plain;charset=US-ASCII|100%");
}

}  // namespace
