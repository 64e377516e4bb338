#include "net/load/ssh_transfers.h"

#include <utility>

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
