#include "net/serve/http_server.h"

#include "net/serve/http_loop.h"

#include <utility>

namespace gs::net {

struct HttpServer::State {
  explicit State(HttpServerOptions options) : loop(std::move(options)) {}
  HttpLoop loop;
};

HttpServer::HttpServer(std::unique_ptr<State> state) : state_(std::move(state)) {}
HttpServer::~HttpServer() = default;

std::variant<std::unique_ptr<HttpServer>, HttpServerError> HttpServer::start(HttpServerOptions options) {
  auto state = std::make_unique<State>(std::move(options));
  if (auto problem = state->loop.start()) return HttpServerError{std::move(*problem)};
  return std::unique_ptr<HttpServer>(new HttpServer(std::move(state)));
}

std::uint16_t HttpServer::port() const { return state_->loop.port(); }
void HttpServer::adopt(Descriptor socket) { state_->loop.adopt(std::move(socket)); }
void HttpServer::wake() { state_->loop.wake(); }
HttpServerStatistics HttpServer::statistics() const { return state_->loop.statistics(); }
void HttpServer::stop(std::chrono::milliseconds grace) { state_->loop.stop(grace); }

}  // namespace gs::net
