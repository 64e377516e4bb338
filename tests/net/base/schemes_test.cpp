#include "net/base/schemes.h"

#include <catch2/catch.hpp>

#include <set>
#include <utility>

#include "net/transfer/transport.h"

namespace {

using namespace gs::net;

TEST_CASE("has one row per scheme") {
  std::set<std::string_view> names;
  for (const Scheme& scheme : schemes()) CHECK(names.insert(scheme.name).second);
  CHECK(names == std::set<std::string_view>{"file", "http", "https", "ftp", "data", "cells", "ssh", "memory"});
  CHECK_FALSE(find_scheme("gopher"));
  CHECK_FALSE(find_scheme("HTTP"));
}

TEST_CASE("shows no passwords in messages") {
  const std::pair<const char*, const char*> messages[] = {
      {"http://user:secret@host/a?b#c", "http://host/a?b#c"},
      {"http://user@x:secret@host/a@b", "http://host/a@b"},
      {"http://host/a@b", "http://host/a@b"},
      {"http:///user:secret@host/a", "http:///host/a"},
      {"http:/user:secret@host/a", "http:/host/a"},
      {"file:///a@b/c", "file:///a@b/c"},
      {"a\nb", "a?b"},
      {"https://u:p@b.s3/a.qnv?X-Amz-Expires=9&part=1&X-Amz-Signature=secret", "https://b.s3/a.qnv?part=1"},
  };
  for (const auto& [url, shown] : messages) CHECK(url_for_messages(url) == shown);
  CHECK(url_for_messages("data:," + std::string(1000, 'x')).size() == 203);
}

TEST_CASE("gives a URL one canonical spelling, or none without a host (RFC 3986 6.2)") {
  const auto canonical = [](std::string_view url) {
    const auto found = canonical_url(parse_url(url));
    return found ? found->text() : "none";
  };
  const std::pair<const char*, const char*> spellings[] = {
      {"HTTP://Example.ORG:80/A?B#C", "http://example.org/A?B#C"},
      {"https://user:Secret@Example.org:443", "https://user:Secret@example.org"},
      {"http://example.org:8080/", "http://example.org:8080/"},
      {"http://example.org:/", "http://example.org/"},
      {"ftp://example.org:21/a", "ftp://example.org/a"},
      {"cells://example.org:21/a", "cells://example.org:21/a"},
      {"SSH://Ann@Login:22/~/A", "ssh://Ann@Login:22/~/A"},
      {"http://[2001:DB8::1]:80/", "http://[2001:db8::1]/"},
  };
  for (const auto& [url, text] : spellings) CHECK(canonical(url) == text);
  for (const char* url :
       {"http:///user:pw@127.0.0.1:1/x", "http:/127.0.0.1/x", "http:127.0.0.1/x", "http:", "http://", "https://:443/",
        "ftp:///127.0.0.1:1021/x", "cells:/a", "http://user@/x", "http://a:99999/", "http://a:b/", "http://[::1/"})
    CHECK(canonical(url) == "none");
  for (const char* url : {"file:///A", "file:/A", "data:,A", "memory:A", "a/B"}) CHECK(canonical(url) == url);
}

std::string text_of(std::string_view url) {
  const auto decoded = decode_data_url(url);
  if (!decoded) return "none";
  return decoded->media_type + "|" +
         std::string(reinterpret_cast<const char*>(decoded->bytes.data()), decoded->bytes.size());
}

TEST_CASE("decodes data URLs (RFC 2397)") {
  const std::pair<const char*, const char*> decoded[] = {
      {"data:,A%20brief%20note", "text/plain;charset=US-ASCII|A brief note"},
      {"data:;charset=utf-8,x", "text/plain;charset=utf-8|x"},
      {"data:text/plain;base64,SGVsbG8h", "text/plain|Hello!"},
      {"DATA:text/plain;BASE64,SGVs\nbG8", "text/plain|Hello"},
      {"data:a/b;base64,SGVsbG8%3D", "a/b|Hello"},
      {"data:a/b;base64,", "a/b|"},
      {"data:a/b;base64,A", "none"},
      {"data:a/b;base64,AA=A", "none"},
      {"data:a/b;base64,A!AA", "none"},
      {"data:a/b", "none"},
      {"data", "none"},
      {"a,data:", "none"},
      {"data:,x#fragment", "text/plain;charset=US-ASCII|x"},
      {"data:model/vrml,#VRML V2.0 utf8", "model/vrml|#VRML V2.0 utf8"},
      {"data:,%4", "text/plain;charset=US-ASCII|%4"},
      {"data:,100%", "text/plain;charset=US-ASCII|100%"},
  };
  for (const auto& [url, text] : decoded) CHECK(text_of(url) == text);
}

}  // namespace
