#include "app/serve/stdio_server.h"

#include "app/serve/live_relay.h"
#include "net/tunnel/socket_pump.h"
#include "net/tunnel/tunnel_session.h"

#include <csignal>
#include <mutex>
#include <optional>

#include <fcntl.h>
#include <unistd.h>

namespace gs::app {
namespace {

/// Silence of the client after which it must answer, within as long again.
constexpr std::chrono::minutes kQuietClient{2};
constexpr std::chrono::milliseconds kLongestServeStep{60'000};

// Takes standard input and output away from the rest of the program: its output would damage the frames.
std::pair<net::Descriptor, net::Descriptor> take_standard_streams() {
  net::Descriptor in(::fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 3)), out(::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3));
  const net::Descriptor nothing(::open("/dev/null", O_RDONLY | O_CLOEXEC));
  (void)::dup2(nothing.get(), STDIN_FILENO);
  (void)::dup2(STDERR_FILENO, STDOUT_FILENO);
  return {std::move(in), std::move(out)};
}

}  // namespace

std::optional<std::string> serve_standard_streams(const ArchiveOptions& given) {
  const auto [in, out] = take_standard_streams();
  std::signal(SIGPIPE, SIG_IGN);
  Archive* server = nullptr;
  std::mutex mutex;  // guards `server`
  LiveRelay relay([&] {
    const std::lock_guard lock(mutex);
    if (server) server->wake();
  });
  ArchiveOptions options = given;
  options.content = [&relay](const net::ContentRequest& request) { return relay.content(request); };
  options.post = [&relay](const net::PostRequest& request) { return relay.post(request); };
  auto started = Archive::start(options);
  if (const auto* problem = std::get_if<std::string>(&started)) return *problem;
  Archive& archive = *std::get<std::unique_ptr<Archive>>(started);
  {
    const std::lock_guard lock(mutex);
    server = &archive;
  }
  net::TunnelTerms terms;
  terms.role = net::TunnelRole::server;
  terms.version = GHOSTSPACE_VERSION;
  terms.quiet = kQuietClient;
  net::TunnelSession session(terms, std::chrono::steady_clock::now());
  net::SocketPump pump(in.get(), out.get());
  std::vector<pollfd> others;
  std::optional<std::string> over;
  while (!over) {
    over = pump.step(session, kLongestServeStep, others);
    for (const auto id : session.take_opened()) {
      auto [ours, theirs] = net::socket_pair();
      if (!ours) {
        session.close(id);
        continue;
      }
      pump.add(id, std::move(ours));
      archive.adopt(std::move(theirs));
    }
  }
  {
    const std::lock_guard lock(mutex);
    server = nullptr;
  }
  archive.stop(std::chrono::milliseconds(0));
  if (over->empty()) return std::nullopt;
  return "the client is not understood: " + *over;
}

}  // namespace gs::app
