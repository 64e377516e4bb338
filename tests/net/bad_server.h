#pragma once

#include "base/noncopyable.h"

#include <catch2/catch.hpp>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <list>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

/// Server on a loopback address that sends scripted bytes, which may be wrong. The kernel chooses the port.
namespace gs::net::test {

class BadServer : NonCopyable {
 public:
  /// One request on one connection.
  class Exchange {
   public:
    std::string request;      // the request line and the headers
    unsigned number = 0;      // index of the request
    bool keep_alive = false;  // set if another request may follow

    /// Returns false if the client is gone.
    bool send(std::string_view text) const {
      while (!text.empty()) {
        const ssize_t sent = ::send(socket_, text.data(), text.size(), MSG_NOSIGNAL);
        if (sent <= 0) return false;
        text.remove_prefix(static_cast<std::size_t>(sent));
      }
      return true;
    }
    /// Waits for a time, or until the test ends.
    void sleep(std::chrono::milliseconds time = std::chrono::seconds(60)) const {
      std::unique_lock lock(server_.mutex_);
      server_.stopped_.wait_for(lock, time, [this] { return server_.stopping_; });
    }
    /// Ends the connection by a reset.
    void reset() const {
      const linger now{1, 0};
      ::setsockopt(socket_, SOL_SOCKET, SO_LINGER, &now, sizeof now);
    }
    [[nodiscard]] std::string header(const std::string& name) const {
      const std::size_t at = request.find("\r\n" + name + ": ");
      if (at == std::string::npos) return {};
      const std::size_t begin = at + name.size() + 4;
      return request.substr(begin, request.find("\r\n", begin) - begin);
    }

   private:
    friend class BadServer;
    Exchange(BadServer& server, int socket) : server_(server), socket_(socket) {}
    BadServer& server_;
    int socket_;
  };
  using Handler = std::function<void(Exchange&)>;

  explicit BadServer(Handler handler, std::string host = "127.0.0.1")
      : handler_(std::move(handler)), host_(std::move(host)) {
    listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    REQUIRE(::inet_pton(AF_INET, host_.c_str(), &address.sin_addr) == 1);
    socklen_t size = sizeof address;
    REQUIRE(::bind(listener_, reinterpret_cast<const sockaddr*>(&address), size) == 0);
    REQUIRE(::listen(listener_, 64) == 0);
    REQUIRE(::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size) == 0);
    port_ = ntohs(address.sin_port);
    acceptor_ = std::thread([this] { accept(); });
  }
  ~BadServer() {
    {
      const std::lock_guard lock(mutex_);
      stopping_ = true;
      for (const int socket : sockets_) ::shutdown(socket, SHUT_RDWR);
    }
    stopped_.notify_all();
    ::shutdown(listener_, SHUT_RDWR);
    acceptor_.join();
    for (std::thread& thread : threads_) thread.join();
    ::close(listener_);
  }

  [[nodiscard]] std::string url(const std::string& path = "/a") const {
    return "http://" + host_ + ":" + std::to_string(port_) + path;
  }
  [[nodiscard]] std::vector<std::string> requests() const {
    const std::lock_guard lock(mutex_);
    return requests_;
  }
  [[nodiscard]] std::size_t connections() const { return connections_; }

 private:
  void accept() {
    for (;;) {
      const int socket = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
      const std::lock_guard lock(mutex_);
      if (stopping_ || socket < 0) {
        if (socket >= 0) ::close(socket);
        return;
      }
      ++connections_;
      sockets_.push_back(socket);
      threads_.emplace_back([this, socket] { serve(socket); });
    }
  }

  void serve(int socket) {
    std::string text;
    for (bool more = true; more;) {
      std::size_t end = 0;
      while ((end = text.find("\r\n\r\n")) == std::string::npos) {
        char buffer[4096];
        const ssize_t got = ::recv(socket, buffer, sizeof buffer, 0);
        if (got <= 0) break;
        text.append(buffer, static_cast<std::size_t>(got));
      }
      if (end == std::string::npos) break;
      Exchange exchange(*this, socket);
      exchange.request = text.substr(0, end + 2);
      text.erase(0, end + 4);
      {
        const std::lock_guard lock(mutex_);
        exchange.number = static_cast<unsigned>(requests_.size());
        requests_.push_back(exchange.request);
      }
      handler_(exchange);
      more = exchange.keep_alive;
    }
    const std::lock_guard lock(mutex_);
    sockets_.remove(socket);
    ::close(socket);
  }

  const Handler handler_;
  const std::string host_;
  int listener_ = -1;
  unsigned port_ = 0;
  mutable std::mutex mutex_;
  std::condition_variable stopped_;
  bool stopping_ = false;
  std::list<int> sockets_;
  std::vector<std::string> requests_;
  std::atomic<std::size_t> connections_{0};
  std::list<std::thread> threads_;
  std::thread acceptor_;
};

/// Returns a valid HTTP answer.
inline std::string http(const std::string& status, const std::string& headers, const std::string& body) {
  return "HTTP/1.1 " + status + "\r\n" + headers + "Content-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body;
}

}  // namespace gs::net::test
