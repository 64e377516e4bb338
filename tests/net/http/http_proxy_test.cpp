#include "net/http/http_proxy.h"

#include <catch2/catch.hpp>

#include <map>
#include <string>

namespace {

using namespace gs::net;

std::string proxy(const char* url, const std::map<std::string, std::string>& variables) {
  return proxy_of(parse_url(url), [&](const std::string& name) {
    const auto found = variables.find(name);
    return found == variables.end() ? std::string() : found->second;
  });
}

TEST_CASE("takes the proxy of a URL from the environment") {
  CHECK(proxy("http://a.example/", {}).empty());
  CHECK(proxy("http://a.example/", {{"http_proxy", "p:1"}}) == "p:1");
  CHECK(proxy("https://a.example/", {{"http_proxy", "p:1"}}).empty());
  CHECK(proxy("https://a.example/", {{"HTTPS_PROXY", "p:2"}}) == "p:2");
  CHECK(proxy("https://a.example/", {{"HTTPS_PROXY", "p:2"}, {"https_proxy", "p:3"}}) == "p:3");
  CHECK(proxy("http://a.example/", {{"HTTP_PROXY", "p:1"}}).empty());
  CHECK(proxy("http://a.example/", {{"ALL_PROXY", "p:4"}}) == "p:4");
  CHECK(proxy("http:///x", {{"http_proxy", "p:1"}}).empty());
}

TEST_CASE("uses no proxy for the hosts of no_proxy") {
  const auto direct = [](const char* host, const char* list) {
    return proxy(("http://" + std::string(host) + "/").c_str(), {{"http_proxy", "p:1"}, {"no_proxy", list}}).empty();
  };
  CHECK(direct("a.example", "*"));
  CHECK(direct("a.example", "b, a.example"));
  CHECK(direct("A.Example.:8080", "a.example"));
  CHECK(direct("x.a.example", ".a.example"));
  CHECK(direct("x.a.example", "a.example"));
  CHECK_FALSE(direct("xa.example", "a.example"));
  CHECK_FALSE(direct("a.example", "x.a.example"));
  CHECK(direct("10.1.2.3", "10.0.0.0/8"));
  CHECK(direct("[::1]:80", "[::1]"));
  CHECK_FALSE(direct("11.1.2.3", "10.0.0.0/8"));
  CHECK_FALSE(direct("110.1.2.3", "10.1.2.3"));
  CHECK_FALSE(direct("a.example", ""));
}

}  // namespace
