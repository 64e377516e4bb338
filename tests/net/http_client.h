#pragma once

#include "base/noncopyable.h"

#include <curl/curl.h>
#include <catch2/catch.hpp>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <map>
#include <string>
#include <system_error>
#include <vector>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

namespace gs::net::test {

/// Answer as libcurl received it.
struct Got {
  CURLcode code = CURLE_OK;
  long status = 0;
  std::map<std::string, std::string> headers;  // names in lower case
  std::string body;                            // as received, not decompressed
};

/// Requests with libcurl, on a new connection each time. An empty `method` means GET.
inline Got fetch(std::uint16_t port, const std::string& target, const std::vector<std::string>& headers = {},
                 const std::string& method = {}) {
  Got got;
  CURL* curl = curl_easy_init();
  REQUIRE(curl);
  const std::string url = "http://127.0.0.1:" + std::to_string(port) + target;
  curl_slist* list = nullptr;
  for (const std::string& header : headers) list = curl_slist_append(list, header.c_str());
  curl_easy_setopt(curl, CURLOPT_URL, url.c_str());
  curl_easy_setopt(curl, CURLOPT_PATH_AS_IS, 1L);
  curl_easy_setopt(curl, CURLOPT_NOSIGNAL, 1L);
  curl_easy_setopt(curl, CURLOPT_TIMEOUT, 120L);
  curl_easy_setopt(curl, CURLOPT_HTTPHEADER, list);
  if (method == "HEAD") curl_easy_setopt(curl, CURLOPT_NOBODY, 1L);
  if (!method.empty()) curl_easy_setopt(curl, CURLOPT_CUSTOMREQUEST, method.c_str());
  curl_easy_setopt(curl, CURLOPT_WRITEDATA, &got);
  curl_easy_setopt(
      curl, CURLOPT_WRITEFUNCTION, +[](char* bytes, std::size_t size, std::size_t count, void* to) {
        static_cast<Got*>(to)->body.append(bytes, size * count);
        return size * count;
      });
  curl_easy_setopt(curl, CURLOPT_HEADERDATA, &got);
  curl_easy_setopt(
      curl, CURLOPT_HEADERFUNCTION, +[](char* bytes, std::size_t size, std::size_t count, void* to) {
        std::string line(bytes, size * count);
        while (!line.empty() && (line.back() == '\n' || line.back() == '\r')) line.pop_back();
        if (const std::size_t colon = line.find(": "); colon != std::string::npos) {
          std::string name = line.substr(0, colon);
          std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
          static_cast<Got*>(to)->headers[name] = line.substr(colon + 2);
        }
        return size * count;
      });
  got.code = curl_easy_perform(curl);
  curl_easy_getinfo(curl, CURLINFO_RESPONSE_CODE, &got.status);
  curl_slist_free_all(list);
  curl_easy_cleanup(curl);
  return got;
}

/// Opens a socket on a free loopback port.
inline int bound_socket(std::uint16_t& port) {
  const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  REQUIRE(::bind(socket, reinterpret_cast<const sockaddr*>(&address), size) == 0);
  REQUIRE(::getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size) == 0);
  port = ntohs(address.sin_port);
  return socket;
}

/// Returns a free loopback port.
inline std::uint16_t free_port() {
  std::uint16_t port = 0;
  ::close(bound_socket(port));
  return port;
}

/// Connection without a library. `from` is the client's address in 127.0.0.0/8.
class RawClient : NonCopyable {
 public:
  explicit RawClient(std::uint16_t port, const char* from = "127.0.0.1", int receive_buffer = 0)
      : RawClient(AF_INET, receive_buffer) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    ::inet_pton(AF_INET, from, &address.sin_addr);
    must(::bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0, "bind");
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(port);
    must(::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0, "connect");
  }
  // Fails the test. Used instead of Catch's assertions, which work on one thread only.
  static void must(bool good, const char* what) {
    if (!good) throw std::system_error(errno, std::generic_category(), what);
  }
  ~RawClient() { ::close(socket_); }

  [[nodiscard]] int socket() const { return socket_; }
  bool send(const std::string& text) const {
    for (std::size_t at = 0; at < text.size();) {
      const ssize_t sent = ::send(socket_, text.data() + at, text.size() - at, MSG_NOSIGNAL);
      if (sent <= 0) return false;
      at += static_cast<std::size_t>(sent);
    }
    return true;
  }
  /// Returns the next bytes, or an empty text at the end of the connection.
  [[nodiscard]] std::string receive(std::size_t most = 65536) const {
    std::string text(most, '\0');
    const ssize_t got = ::recv(socket_, text.data(), most, 0);
    text.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
    return text;
  }
  /// Receives until the other side closes.
  [[nodiscard]] std::string receive_all() const {
    std::string all;
    for (std::string piece = receive(); !piece.empty(); piece = receive()) all += piece;
    return all;
  }

 protected:
  RawClient(int family, int receive_buffer) : socket_(::socket(family, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    must(socket_ >= 0, "socket");
    if (receive_buffer > 0) ::setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof receive_buffer);
  }

  int socket_ = -1;
};

}  // namespace gs::net::test
