#include "net/serve/request_fields.h"

#include "tests/net/served_site.h"

#include <string>
#include <vector>

using namespace gs::net;
using namespace gs::net::test;

namespace {

std::string refusal(const std::vector<ReceivedField>& fields, std::string_view version = "HTTP/1.1") {
  return refuse_fields(fields, version).value_or("");
}

/// Returns everything that a server sends until it closes. `request` omits the first line and the Host field.
std::string answer_to(const ServedSite& site, const std::string& request) {
  RawClient client(site.port);
  client.send("GET /a HTTP/1.1\r\nHost: localhost\r\n" + request);
  return client.receive_all();
}

std::size_t count_answers(const std::string& text) {
  std::size_t count = 0;
  for (std::size_t at = 0; (at = text.find("HTTP/1.1 ", at)) != std::string::npos; ++at) ++count;
  return count;
}

}  // namespace

TEST_CASE("refuses ambiguous header fields (RFC 9112 5, 6)") {
  CHECK(refusal({}).empty());
  CHECK(refusal({{"Host", "a"}, {"X-Empty", ""}, {"x!#$%&'*+-.^_`|~9", "a\tb \xff"}}).empty());
  CHECK(refusal({{"Content-Length", "5"}}).empty());
  CHECK(refusal({{"Transfer-Encoding", "Chunked"}}).empty());
  CHECK(refusal({{"Content-Length", "5"}, {"content-LENGTH", "6"}}) == "expected one Content-Length field");
  CHECK(refusal({{"Transfer-Encoding", "chunked"}, {"transfer-encoding", "chunked"}}) ==
        "expected one Transfer-Encoding field");
  CHECK(refusal({{"Transfer-Encoding", "chunked"}, {"Content-Length", "5"}}) ==
        "expected Content-Length or Transfer-Encoding, not both");
  CHECK(refusal({{"Transfer-Encoding", "gzip, chunked"}}) == "the Transfer-Encoding is unknown; expected chunked");
  CHECK(refusal({{"Transfer-Encoding", "chunked"}}, "HTTP/1.0") == "expected no Transfer-Encoding in HTTP/1.0");
  CHECK(refusal({{"Host", "a", true}}) == "a header field spans several lines; expected one line per field");
  for (const char* name : {"", "Transfer-Encoding ", "Content-Length\t", " Host", "a b", "a:b", "a\"b", "\xc3\xa4"})
    CHECK(refusal({{name, "1"}}) == "the name of a header field has an invalid character");
  for (const char* value : {"a\rb", "\x7f", "\x01"})
    CHECK(refusal({{"X", value}}) == "the value of a header field has a control character");
}

TEST_CASE("HTTP server: answers 400 to doubtful header fields and closes the connection") {
  ServedSite site;
  site.write("a", "first");
  site.write("b", "second");
  site.options.request_timeout = std::chrono::milliseconds(2000);
  site.start();
  const std::string hidden = "GET /b HTTP/1.1\r\nHost: localhost\r\n\r\n";
  for (const char* fields : {
           "Content-Length: 0\r\nContent-Length: 45\r\n",
           "Content-Length: 45\r\nContent-Length: 0\r\n",
           "Transfer-Encoding : chunked\r\n",
           "Transfer-Encoding\t: chunked\r\n",
           "Content-Length: 0\r\nTransfer-Encoding: chunked\r\n",
           "Transfer-Encoding: xchunked\r\n",
           "X: 1\r\n folded\r\n",
           "X: 1\r\n\tfolded\r\n",
           "X: 1\r\n \r\n",
           "X: 1\r\n a\r\n b\r\n",
           "Content: 45\r\n -Length\r\n",
           "X:1\r\nY:2\r\nZ:3\r\n folded\r\n",
           "X: 1\n folded\n",
       }) {
    INFO(fields);
    const std::string answer = answer_to(site, std::string(fields) + "\r\n" + hidden);
    CHECK(answer.starts_with("HTTP/1.1 400"));
    CHECK(answer.find("Connection: close\r\n") != std::string::npos);
    CHECK(count_answers(answer) == 1);
  }
  // The first field line cannot be a continuation.
  RawClient first(site.port);
  first.send("GET /a HTTP/1.1\r\n Host: localhost\r\nHost: localhost\r\n\r\n" + hidden);
  const std::string answer = first.receive_all();
  CHECK(answer.starts_with("HTTP/1.1 400"));
  CHECK(count_answers(answer) == 1);
}

TEST_CASE("HTTP server: accepts blanks around values, and several requests on a connection") {
  ServedSite site;
  site.write("a", "first");
  site.start();
  const std::string ask = "GET /a HTTP/1.1\r\nHost:localhost\r\nX:  a \t b  \r\nEmpty:\r\nAlso-Empty: \r\n";
  RawClient client(site.port);
  client.send(ask + "\r\n" + ask + "Content-Length: 0\r\n\r\n" + ask + "Connection: close\r\n\r\n");
  const std::string answers = client.receive_all();
  CHECK(count_answers(answers) == 3);
  CHECK(answers.find("HTTP/1.1 400") == std::string::npos);
  // Many fields, which take several packets and buffers.
  std::string many;
  for (int i = 0; i < 100; ++i) many += "X-" + std::to_string(i) + ": " + std::string(150, 'v') + "\r\n";
  RawClient slow(site.port);
  slow.send("GET /a HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n");
  for (std::size_t at = 0; at < many.size(); at += 1000) {
    slow.send(many.substr(at, 1000));
    ::usleep(2000);
  }
  slow.send("\r\n");
  CHECK(slow.receive_all().starts_with("HTTP/1.1 200"));
}
