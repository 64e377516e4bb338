#include "net/transfer/ssh_transfers.h"

#include <utility>

#include <unistd.h>

namespace gs::net {

std::optional<std::string> find_ssh_link(const Url& url, const LoaderOptions& options, std::shared_ptr<SshLink>& link) {
  auto target = ssh_target_of(url);
  if (auto* why = std::get_if<std::string>(&target)) return std::move(*why);
  SshSettings settings;
  settings.remote_program = options.remote_program;
  settings.version = GHOSTSPACE_VERSION;
  link = SshLinks::shared().find(std::get<SshTarget>(target), settings, options.report);
  return std::nullopt;
}

std::string ssh_socket_name(const SshLink& link) { return "ghostspace-ssh-" + std::to_string(link.number()); }

Descriptor listen_for_self(sockaddr& address, unsigned& bytes) {
  Descriptor listener(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  // An address of two bytes lets the system choose a short name in the abstract name space (unix(7), autobind).
  address.sa_family = AF_UNIX;
  socklen_t size = sizeof(address);
  constexpr int kWaiting = 8;
  if (!listener || ::bind(listener.get(), &address, sizeof(sa_family_t)) != 0 ||
      ::listen(listener.get(), kWaiting) != 0 || ::getsockname(listener.get(), &address, &size) != 0 ||
      size > sizeof(address))
    return {};
  bytes = size;
  return listener;
}

bool connect_self(SshLink& link, Descriptor& listener) {
  if (!listener) return true;
  const Descriptor own = std::exchange(listener, Descriptor());
  for (;;) {
    Descriptor socket(::accept4(own.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
    if (!socket) return false;
    ucred peer{};
    socklen_t size = sizeof(peer);
    if (::getsockopt(socket.get(), SOL_SOCKET, SO_PEERCRED, &peer, &size) == 0 && peer.pid == ::getpid())
      return link.take(std::move(socket));
  }
}

std::string http_of_ssh(Url url) {
  url.scheme = "http";
  url.authority = "localhost";
  return url.text();
}

TransferEnd describe_ssh_failure(const SshFailure& failure) {
  using Kind = SshFailure::Kind;
  LoadErrorKind kind = LoadErrorKind::broken;
  if (failure.kind == Kind::refused) kind = LoadErrorKind::insecure;
  if (failure.kind == Kind::unreachable) kind = LoadErrorKind::unreachable;
  if (failure.kind == Kind::unusable) kind = LoadErrorKind::bad_response;
  return {LoadError{kind, failure.message, 0}, failure.kind == Kind::broken || failure.kind == Kind::idle};
}

}  // namespace gs::net
