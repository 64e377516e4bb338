#include "app/control/control_service.h"

#include "app/base/console.h"
#include "net/control/control_token.h"

#include <optional>
#include <utility>

namespace gs::app {
namespace {

class ServerChannel final : public ControlChannel {
 public:
  explicit ServerChannel(std::unique_ptr<net::ControlServer> server) : server_(std::move(server)) {}
  [[nodiscard]] std::optional<net::ControlNews> next() override { return server_->next(); }
  void send(std::uint64_t client, std::string message) override { (void)server_->send(client, std::move(message)); }
  [[nodiscard]] bool is_behind(std::uint64_t client) const override { return server_->is_behind(client); }

 private:
  std::unique_ptr<net::ControlServer> server_;
};

// Returns the last message for a rejected client of a line-based connection.
std::string farewell(const std::string& why) {
  std::string out = "{\"jsonrpc\":\"2.0\",\"id\":null,\"error\":{\"code\":-32001,\"message\":";
  append_json_string(out, why);
  return out + "}}";
}

}  // namespace

struct ControlService::State {
  State(std::unique_ptr<net::ControlServer> server, std::function<void()> wake)
      : channel(std::move(server)), control(channel, std::move(wake)) {}
  ServerChannel channel;
  Control control;
};

ControlService::ControlService(std::unique_ptr<State> state) : state_(std::move(state)) {}
ControlService::~ControlService() = default;

Control& ControlService::control() { return state_->control; }

std::variant<std::unique_ptr<ControlService>, std::string> ControlService::start(const ControlPlaces& places,
                                                                                 std::function<void()> wake) {
  net::ControlServerOptions options;
  options.paths = places.paths;
  options.ports = places.ports;
  options.terms.token = net::make_control_token();
  options.terms.farewell = farewell;
  const std::string token = options.terms.token;
  if (!places.token_file.empty()) options.ready = [&] { return net::write_control_token(places.token_file, token); };
  auto started = net::ControlServer::start(std::move(options), wake);
  if (auto* problem = std::get_if<std::string>(&started)) return std::move(*problem);
  auto server = std::move(std::get<std::unique_ptr<net::ControlServer>>(started));
  for (const std::string& path : places.paths) complain("ghostspace: control at %s", path.c_str());
  for (const std::uint16_t port : server->ports())
    complain("ghostspace: control at ws://127.0.0.1:%u/", unsigned{port});
  if (places.token_file.empty()) complain("ghostspace: control token %s", token.c_str());
  return std::unique_ptr<ControlService>(
      new ControlService(std::make_unique<State>(std::move(server), std::move(wake))));
}

}  // namespace gs::app
