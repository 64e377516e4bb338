#include "net/base/url.h"

#include <catch2/catch.hpp>

#include <filesystem>
#include <utility>

namespace {

using namespace gs::net;

std::string resolved(std::string_view base, std::string_view reference) {
  return resolve(parse_url(base), parse_url(reference)).text();
}

TEST_CASE("splits a URL into its parts (RFC 3986 appendix B)") {
  const Url url = parse_url("HTTP://www.ics.uci.edu/pub/ietf/uri/?a=b#Related");
  CHECK(url.scheme == "http");
  CHECK(url.authority == "www.ics.uci.edu");
  CHECK(url.path == "/pub/ietf/uri/");
  CHECK(url.query == "a=b");
  CHECK(url.fragment == "Related");

  const Url empty_parts = parse_url("file:///a?#");
  CHECK(empty_parts.has_authority);
  CHECK(empty_parts.authority.empty());
  CHECK(empty_parts.has_query);
  CHECK(empty_parts.has_fragment);
  const Url none = parse_url("a");
  CHECK_FALSE(none.has_authority);
  CHECK_FALSE(none.has_query);
  CHECK_FALSE(none.has_fragment);

  // RFC 3986 1.1.2
  for (const char* text : {"ftp://ftp.is.co.za/rfc/rfc1808.txt", "http://www.ietf.org/rfc/rfc2396.txt",
                           "ldap://[2001:db8::7]/c=GB?objectClass?one", "mailto:John.Doe@example.com",
                           "news:comp.infosystems.www.servers.unix", "tel:+1-816-555-1212", "telnet://192.0.2.16:80/",
                           "urn:oasis:names:specification:docbook:dtd:xml:4.1.2", "", "#", "?", "//", "a:", ":", "://",
                           "a//b", "#a#b?c", "foo://", "1a:b"})
    CHECK(parse_url(text).text() == text);
  CHECK(parse_url("1a:b").scheme.empty());
  CHECK(parse_url("mailto:John.Doe@example.com").path == "John.Doe@example.com");
}

TEST_CASE("resolves references as in the normal examples (RFC 3986 5.4.1)") {
  const std::pair<const char*, const char*> examples[] = {

      {"g", "http://a/b/c/g"},
      {"./g", "http://a/b/c/g"},
      {"g/", "http://a/b/c/g/"},
      {"/g", "http://a/g"},
      {"//g", "http://g"},
      {"?y", "http://a/b/c/d;p?y"},
      {"g?y", "http://a/b/c/g?y"},
      {"#s", "http://a/b/c/d;p?q#s"},
      {"g#s", "http://a/b/c/g#s"},
      {"g?y#s", "http://a/b/c/g?y#s"},
      {";x", "http://a/b/c/;x"},
      {"g;x", "http://a/b/c/g;x"},
      {"g;x?y#s", "http://a/b/c/g;x?y#s"},
      {"", "http://a/b/c/d;p?q"},
      {".", "http://a/b/c/"},
      {"./", "http://a/b/c/"},
      {"..", "http://a/b/"},
      {"../", "http://a/b/"},
      {"../g", "http://a/b/g"},
      {"../..", "http://a/"},
      {"../../", "http://a/"},
      {"../../g", "http://a/g"},
  };
  for (const auto& [reference, target] : examples) {
    CHECK(resolved("http://a/b/c/d;p?q", reference) == target);
  }
  // A one-letter scheme counts as a drive letter, so the example uses two letters.
  CHECK(resolved("http://a/b/c/d;p?q", "gg:h") == "gg:h");
}

TEST_CASE("resolves references as in the abnormal examples (RFC 3986 5.4.2)") {
  const std::pair<const char*, const char*> examples[] = {
      {"../../../g", "http://a/g"},
      {"../../../../g", "http://a/g"},
      {"/./g", "http://a/g"},
      {"/../g", "http://a/g"},
      {"g.", "http://a/b/c/g."},
      {".g", "http://a/b/c/.g"},
      {"g..", "http://a/b/c/g.."},
      {"..g", "http://a/b/c/..g"},
      {"./../g", "http://a/b/g"},
      {"./g/.", "http://a/b/c/g/"},
      {"g/./h", "http://a/b/c/g/h"},
      {"g/../h", "http://a/b/c/h"},
      {"g;x=1/./y", "http://a/b/c/g;x=1/y"},
      {"g;x=1/../y", "http://a/b/c/y"},
      {"g?y/./x", "http://a/b/c/g?y/./x"},
      {"g?y/../x", "http://a/b/c/g?y/../x"},
      {"g#s/./x", "http://a/b/c/g#s/./x"},
      {"g#s/../x", "http://a/b/c/g#s/../x"},
      {"http:g", "http:g"},
  };
  for (const auto& [reference, target] : examples) CHECK(resolved("http://a/b/c/d;p?q", reference) == target);
}

TEST_CASE("never writes a path that looks like a scheme (RFC 3986 4.2)") {
  CHECK(resolved("a.wrl", "../http://b/c") == "./http://b/c");
  CHECK(parse_url(resolved("a.wrl", "../http://b/c")).scheme.empty());
  CHECK(resolved("http://a/b", "./x:y") == "http://a/x:y");
}

TEST_CASE("resolves references against files and against hosts without a path") {
  CHECK(resolved("file:///worlds/a/b.wrl", "tex/wood.png") == "file:///worlds/a/tex/wood.png");
  CHECK(resolved("file:///worlds/a/b.wrl", "../c.wrl#View") == "file:///worlds/c.wrl#View");
  CHECK(resolved("http://host", "a.wrl") == "http://host/a.wrl");
  CHECK(resolved("http://host?q", "a.wrl") == "http://host/a.wrl");
  CHECK(resolved("a/b.wrl", "c.wrl") == "a/c.wrl");
  CHECK(resolved("", "c.wrl") == "c.wrl");
  CHECK(resolved("x:", "y").find('y') != std::string::npos);
  // A path of two slashes never becomes a host.
  CHECK(resolved("urn:a", "/.//b") == "urn:/.//b");
}

TEST_CASE("rejects a drive letter as scheme") {
  const Url url = parse_url("C:\\worlds\\a.wrl#V");
  CHECK(url.scheme.empty());
  CHECK(url.path == "C:\\worlds\\a.wrl");
  CHECK(url.fragment == "V");
  CHECK(url_of_path("C:\\my worlds\\a.wrl").text() == "file:///C:/my%20worlds/a.wrl");
  CHECK(path_of_url(parse_url("file:///C:/my%20worlds/a.wrl")) == "C:/my worlds/a.wrl");
  CHECK(resolved("http://a/b", "C:\\w\\x.wrl") == "file:///C:/w/x.wrl");
  CHECK(resolved("http://a/b", "C:/w/my%20x.wrl#V") == "file:///C:/w/my%20x.wrl#V");
  CHECK(resolved("file:///C:/w/a.wrl", "b.wrl") == "file:///C:/w/b.wrl");
}

TEST_CASE("converts paths to file URLs and back") {
  CHECK(url_of_path("/a/b.wrl").text() == "file:///a/b.wrl");
  CHECK(url_of_path("/a b/50%/#1?.wrl").text() == "file:///a%20b/50%25/%231%3F.wrl");
  CHECK(url_of_path("/caf\xc3\xa9.wrl").text() == "file:///caf%C3%A9.wrl");
  CHECK(url_of_path("/a/./b").text() == "file:///a/b");
  for (const std::string path : {"/a/b.wrl", "/a b/50%/#1?.wrl", "/%41", "/caf\xc3\xa9", "/\xff\x01", "/", "/a/../b",
                                 "/a;b=c@d:e&f+g", "/a\\b", "/%", "/%4", "/100%zz"})
    CHECK(path_of_url(parse_url(url_of_path(path).text())) == path);
  const std::string here = std::filesystem::current_path().string();
  CHECK(path_of_url(url_of_path("x y.wrl")) == here + "/x y.wrl");
  CHECK(path_of_url(url_of_path("./x.wrl")) == here + "/x.wrl");
  CHECK(path_of_url(url_of_path("1:2.wrl")) == here + "/1:2.wrl");
}

TEST_CASE("returns a path for file URLs only, without zero bytes") {
  CHECK(path_of_url(parse_url("http://a/b")).empty());
  CHECK(path_of_url(parse_url("/a/b")).empty());
  CHECK(path_of_url(parse_url("file:///a%00b")).empty());
  CHECK(path_of_url(parse_url("file:/a/b")) == "/a/b");
  CHECK(path_of_url(parse_url("file://localhost/a")) == "/a");
  CHECK(path_of_url(parse_url("FILE:///a%2")) == "/a%2");
}

TEST_CASE("compares schemes without case (RFC 3986 3.1)") {
  for (const char* url : {"ghostspace:x", "GhostSpace:x", "GHOSTSPACE:"}) CHECK(has_scheme(url, "ghostspace"));
  for (const char* url : {"", "ghostspace", "ghostspaces:x", "ghost:x", " ghostspace:x", "x/ghostspace:"})
    CHECK_FALSE(has_scheme(url, "ghostspace"));
}

TEST_CASE("splits an authority into host and port") {
  const auto text = [](std::string_view authority) {
    const auto found = gs::net::host_and_port(authority);
    return found ? found->host + "|" + (found->port ? std::to_string(*found->port) : "-") : "none";
  };
  const std::pair<const char*, const char*> authorities[] = {
      {"example.org", "example.org|-"},
      {"example.org:", "example.org|-"},
      {"example.org:8080", "example.org|8080"},
      {"user:secret@example.org:1", "example.org|1"},
      {"192.0.2.1:65535", "192.0.2.1|65535"},
      {"[2001:db8::1]:6635", "2001:db8::1|6635"},
      {"[::1]", "::1|-"},
  };
  for (const auto& [authority, parts] : authorities) CHECK(text(authority) == parts);
  for (const char* bad : {"", ":80", "a:0", "a:65536", "a:-1", "a:8x", "a:8:8", "[::1", "[::1]8", "[]:80", "a: 80"})
    CHECK(text(bad) == "none");
}

TEST_CASE("repairs backslashes and blanks in URLs") {
  const std::pair<const char*, const char*> repairs[] = {
      {"  textures\\my wood.png\n", "textures/my%20wood.png"},
      {"http://a/b%20c", "http://a/b%20c"},
      {"", ""},
      {" \t ", ""},
      {"#Entry View", "#Entry%20View"},
  };
  for (const auto& [url, repaired] : repairs) CHECK(tidy_url(url) == repaired);
  const char* script = "javascript: function f() { print('a\\n'); }";
  CHECK(tidy_url(script) == script);
}

}  // namespace
