#include "app/commands/serve.h"

#include "app/base/confinement.h"
#include "app/base/console.h"
#include "app/commands/common/shared.h"
#include "app/serve/stdio_server.h"

#include <atomic>
#include <csignal>
#include <thread>

namespace gs::app {
namespace {

constexpr std::chrono::seconds kGrace{1};
constexpr std::uint16_t kHttpPort = 8080;

std::string place(const ArchiveOptions& options, std::uint16_t port) {
  const bool six = options.bind.find(':') != std::string::npos;
  const std::string host = options.bind == "*" ? "localhost" : six ? "[" + options.bind + "]" : options.bind;
  return host + ":" + std::to_string(port) + "/";
}

}  // namespace

std::optional<std::string> check_serve(const ServeCommand& options) {
  if (options.files.empty() && !options.standard_streams) return "serve: expected a folder";
  if (options.standard_streams && (options.http_port || options.cells_port))
    return "--stdio opens no port; leave out --http and --cells";
  return std::nullopt;
}

int run_serve(const ServeCommand& given_options) {
  ArchiveOptions options = given_options;
  if (!given_options.files.empty()) options.folder = given_options.files.front();
  if (!options.http_port && !options.cells_port) options.http_port = kHttpPort;
  options.report = [](const std::string& message) { complain("ghostspace: %s", message.c_str()); };
  if (options.standard_streams) {
    options.http_port.reset();
    options.log.clear();
    const auto problem = serve_standard_streams(options);
    return problem ? fail(*problem) : kDone;
  }
  // Block the signals before other threads start. All threads inherit this, so only sigwait below receives the signals.
  sigset_t signals, before;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals, &before);
  std::signal(SIGPIPE, SIG_IGN);
  auto started = Archive::start(options);
  if (const auto* problem = std::get_if<std::string>(&started)) {
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
    return fail(*problem);
  }
  Archive& archive = *std::get<std::unique_ptr<Archive>>(started);
  if (const auto port = archive.http_port())
    complain("ghostspace: serving %s on http://%s", options.folder.c_str(), place(options, *port).c_str());
  if (archive.http_port())
    complain("ghostspace: processes without network make thumbnails and streams; confinement: %s",
             confinement_support().text().c_str());
  if (const auto port = archive.cells_port())
    complain("ghostspace: serving %s on cells://%s", options.folder.c_str(), place(options, *port).c_str());
  int signal = 0;
  while (sigwait(&signals, &signal) != 0) {
  }
  // From now on, a second signal ends the program at once.
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  complain("ghostspace: stopping; transfers may take %d s more", static_cast<int>(kGrace.count()));
  archive.stop(kGrace);
  return kDone;
}

}  // namespace gs::app
