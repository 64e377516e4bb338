// Tests of the rights of clients: host names, pages of other sites, proxies.
#include "net/base/host_names.h"

#include "tests/net/served_site.h"

using namespace gs::net;
using namespace gs::net::test;

namespace {

IpAddress address_of_text(const std::string& text) { return ip_address_of(text).value(); }

// Returns the answer to a GET of /a with these header lines.
std::string asked_for(const ServedSite& site, const std::string& lines, const std::string& target = "/a") {
  RawClient client(site.port);
  client.send("GET " + target + " HTTP/1.1\r\n" + lines + "Connection: close\r\n\r\n");
  return client.receive_all();
}

}  // namespace

TEST_CASE("normalises host names, and rejects invalid ones") {
  const std::pair<const char*, const char*> hosts[] = {
      {"localhost", "localhost"}, {"LocalHost.:8080", "localhost"},  {"127.0.0.1:80", "127.0.0.1"},
      {"[::1]", "::1"},           {"[0:0:0:0:0:0:0:1]:8080", "::1"}, {"a.example:", "a.example"},
  };
  for (const auto& [text, host] : hosts) CHECK(host_of(text) == host);
  for (const char* bad : {"", ".", ":80", "a:b", "a:1:2", "a:123456", "::1", "[::1", "[::1]x", "[::1]:x", "[a]", "a b",
                          "user@localhost", "localhost/", "localhost,evil", "lo\tcal", "\xff", "[127.0.0.1]"})
    CHECK_FALSE(host_of(bad));
  CHECK_FALSE(host_of(std::string(300, 'a')));
}

TEST_CASE("accepts its own host names and configured ones on loopback") {
  const HostNames names("127.0.0.1", {"gallery.lan"});
  for (const char* good : {"localhost", "localhost:1", "127.0.0.1:8080", "[::1]:8080", "gallery.lan", "Gallery.LAN:80"})
    CHECK(names.admits(good));
  for (const char* bad : {"", "evil.example", "evil.example:8080", "localhost.evil.example", "127.0.0.1.evil.example",
                          "127.0.0.2", "192.168.0.1", "localhost:8080.evil.example", "localhost@evil.example"})
    CHECK_FALSE(names.admits(bad));
  CHECK(HostNames("127.0.0.9", {}).admits("127.0.0.9:1"));
  CHECK(HostNames("::1", {}).admits("[::1]"));
  CHECK_FALSE(HostNames("::1", {}).admits("evil.example"));
  // A server for other machines accepts any name, unless names are configured.
  CHECK(HostNames("*", {}).admits("any.example"));
  CHECK(HostNames("192.0.2.1", {}).admits("any.example"));
  CHECK_FALSE(HostNames("*", {"a.example"}).admits("any.example"));
  CHECK(HostNames("*", {"a.example"}).admits("a.example"));
  CHECK(HostNames("*", {"2001:db8::1"}).admits("[2001:db8::1]:80"));
  CHECK_FALSE(HostNames("*", {}).is_own("any.example"));
  CHECK(HostNames("*", {}).is_own("localhost"));
}

TEST_CASE("takes the client of a request from X-Forwarded-For of trusted proxies only") {
  const std::vector<AddressBlock> proxies = {*address_block_of("10.0.0.0/8"), *address_block_of("::1")};
  const auto client = [&](const char* peer, const char* forwarded) {
    return address_text(client_of(address_of_text(peer), forwarded, proxies));
  };
  CHECK(client("192.0.2.1", "198.51.100.7") == "192.0.2.1");
  CHECK(client("::1", "2001:db8::5") == "2001:db8::5");
  const std::pair<const char*, const char*> clients[] = {
      {"", "10.0.0.1"},
      {"198.51.100.7", "198.51.100.7"},
      {"1.2.3.4, 198.51.100.7", "198.51.100.7"},
      {"198.51.100.7 ,10.0.0.2,\t10.0.0.3", "198.51.100.7"},
      {"10.0.0.2, 10.0.0.3", "10.0.0.2"},
      {"198.51.100.7:4711", "198.51.100.7"},
      {"[2001:db8::5]:4711", "2001:db8::5"},
      {"198.51.100.7, unknown", "10.0.0.1"},
      {"127.0.0.1, ", "10.0.0.1"},
      {",,,", "10.0.0.1"},
  };
  for (const auto& [forwarded, address] : clients) CHECK(client("10.0.0.1", forwarded) == address);
}

TEST_CASE("HTTP server on loopback: refuses a page with a name that resolves to this machine") {
  ServedSite site;
  site.write("a", "what is served");
  site.options.host_names = {"gallery.lan"};
  site.start();
  const std::string port = std::to_string(site.port);
  for (const std::string& name : {std::string("localhost"), "localhost:" + port, "127.0.0.1:" + port, "[::1]:" + port,
                                  std::string("gallery.lan")})
    CHECK(asked_for(site, "Host: " + name + "\r\n").ends_with("what is served"));
  for (const std::string& lines : {"Host: evil.example:" + port + "\r\n", std::string("Host: evil.example\r\n"),
                                   std::string("Host: localhost.evil.example\r\n"), std::string("Host: \r\n"),
                                   std::string("Host: localhost\r\nHost: evil.example\r\n"),
                                   std::string("Host: evil.example\r\nHost: localhost\r\n")})
    for (const char* target : {"/a", "/", "/health", "/metrics", "/a?thumbnail", "/nothing"}) {
      const std::string answer = asked_for(site, lines, target);
      INFO(lines << target << "\n" << answer);
      CHECK((answer.starts_with("HTTP/1.1 421") || answer.starts_with("HTTP/1.1 400")));
      CHECK(answer.find("what is served") == std::string::npos);
      CHECK(answer.find("evil.example") == std::string::npos);
      CHECK(answer.find("Access-Control") == std::string::npos);
    }
  CHECK(asked_for(site, "Host: localhost\r\n", "http://evil.example/a").starts_with("HTTP/1.1 421"));
  CHECK(asked_for(site, "Host: evil.example\r\n", "http://localhost/a").starts_with("HTTP/1.1 421"));
  CHECK(asked_for(site, "Host: localhost\r\n", "http://localhost:" + port + "/a").ends_with("what is served"));
  RawClient old(site.port);
  old.send("GET /a HTTP/1.0\r\n\r\n");
  CHECK(old.receive_all().find(" 421 ") != std::string::npos);
}

TEST_CASE("HTTP server: lets pages of other sites read only what CORS allows") {
  ServedSite site;
  site.write("a", "what is served");
  const std::string local = "Host: localhost\r\n", page = local + "Origin: https://gallery.example\r\n",
                    other = local + "Origin: https://evil.example\r\n";
  const auto preflight = [&](const std::string& origin) {
    return site.get("/a", {"Origin: " + origin, "Access-Control-Request-Method: GET"}, "OPTIONS");
  };
  site.start();
  for (const std::string& lines : {local, page, other}) {
    const std::string answer = asked_for(site, lines);
    CHECK(answer.find("Access-Control") == std::string::npos);
    CHECK(answer.find("Cross-Origin-Resource-Policy: same-origin\r\n") != std::string::npos);
  }
  const Got refused = preflight("https://gallery.example");
  CHECK(refused.status == 204);
  CHECK(refused.headers.at("allow") == "GET, HEAD, OPTIONS");
  for (const auto& [name, value] : refused.headers) CHECK_FALSE(name.starts_with("access-control"));

  site.server.reset();
  site.options.origins = {"https://gallery.example", "http://localhost:3000"};
  site.start();
  const std::string answer = asked_for(site, page);
  CHECK(answer.find("Access-Control-Allow-Origin: https://gallery.example\r\n") != std::string::npos);
  CHECK(answer.find("Cross-Origin-Resource-Policy: cross-origin\r\n") != std::string::npos);
  CHECK(answer.find("Vary: Origin\r\n") != std::string::npos);
  CHECK(asked_for(site, other).find("Access-Control") == std::string::npos);
  CHECK(asked_for(site, other).find("Vary: Origin\r\n") != std::string::npos);
  CHECK(asked_for(site, local).find("Access-Control") == std::string::npos);
  CHECK(preflight("http://localhost:3000").headers.at("access-control-allow-origin") == "http://localhost:3000");
  CHECK(preflight("https://gallery.example.evil.example").headers.count("access-control-allow-origin") == 0);

  site.server.reset();
  site.options.origins = {"*"};
  site.start();
  CHECK(asked_for(site, other).find("Access-Control-Allow-Origin: *\r\n") != std::string::npos);
}

TEST_CASE("HTTP server: serves /metrics only on this machine, by its own name and without a proxy") {
  ServedSite site;
  site.options.bind = "*";
  site.start();
  const auto status = [&](const std::string& lines) { return asked_for(site, lines, "/metrics").substr(9, 3); };
  CHECK(status("Host: localhost\r\n") == "200");
  CHECK(status("Host: 127.0.0.1:1234\r\n") == "200");
  CHECK(status("Host: evil.example\r\n") == "404");
  for (const char* field :
       {"X-Forwarded-For: 127.0.0.1", "X-Real-IP: 127.0.0.1", "Forwarded: for=127.0.0.1", "Via: 1.1 x"})
    CHECK(status("Host: localhost\r\n" + std::string(field) + "\r\n") == "404");
  site.server.reset();
  site.options.proxies = {*address_block_of("127.0.0.1")};
  site.start();
  CHECK(status("Host: localhost\r\n") == "404");
  CHECK(status("Host: localhost\r\nX-Forwarded-For: 127.0.0.1\r\n") == "404");
}

TEST_CASE("HTTP server: keeps other clients of a proxy served when one reaches its limit") {
  ServedSite site;
  site.write("a", "a");
  site.options.limits.requests_per_second = 5;
  site.options.limits.connections_of_client = 2;
  site.options.proxies = {*address_block_of("127.0.0.1")};
  std::filesystem::create_directories(site.made());
  const std::string log = site.made() + "/log";
  site.options.log = std::get<AccessLog>(AccessLog::open(log));
  site.start();
  const auto ask = [](const std::string& forwarded) {
    return "GET /a HTTP/1.1\r\nHost: localhost\r\nX-Forwarded-For: " + forwarded + "\r\n\r\n";
  };
  // More connections than one address may have. The first client uses up its limit.
  std::vector<std::unique_ptr<RawClient>> connections;
  for (int i = 0; i < 6; ++i) connections.push_back(std::make_unique<RawClient>(site.port));
  bool refused = false;
  for (int i = 0; i < 100 && !refused; ++i) {
    connections[0]->send(ask("198.51.100.1"));
    refused = connections[0]->receive().starts_with("HTTP/1.1 429");
  }
  CHECK(refused);
  for (std::size_t i = 1; i < connections.size(); ++i) {
    // The server ignores addresses that the client writes into X-Forwarded-For before the proxy's entry.
    connections[i]->send(ask("198.51.100.1, 198.51.100." + std::to_string(10 + i)));
    CHECK(connections[i]->receive().starts_with("HTTP/1.1 200"));
  }
  // The server ignores X-Forwarded-For from an address that is not a trusted proxy.
  RawClient stranger(site.port, "127.0.0.7");
  bool limited = false;
  for (int i = 0; i < 100 && !limited; ++i) {
    stranger.send(ask("203.0.113." + std::to_string(i)));
    limited = stranger.receive().starts_with("HTTP/1.1 429");
  }
  CHECK(limited);
  connections.clear();
  site.server.reset();
  std::ifstream file(log);
  const std::string lines{std::istreambuf_iterator<char>(file), {}};
  CHECK(lines.find("198.51.100.11 - - [") != std::string::npos);
  CHECK(lines.find("127.0.0.7 - - [") != std::string::npos);
  CHECK(lines.find("\n127.0.0.1 - - [") == std::string::npos);
}
