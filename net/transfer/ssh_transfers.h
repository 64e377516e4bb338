#pragma once

#include <memory>
#include <optional>
#include <string>

#include "net/ssh/ssh_link.h"
#include "net/transfer/transport.h"

#include <sys/socket.h>

namespace gs::net {

/// Space of documents that were read over ssh. They are private, and may not refer to this machine.
inline constexpr AddressSpace kSshSpace = AddressSpace::local;
/// Maximum time for which a server that is reached by ssh may encode a file.
inline constexpr Milliseconds kEncodingTime{30 * 60'000};

/// Sets `link` to the link for a URL. Returns the reason why the URL is invalid, or nullopt.
[[nodiscard]] std::optional<std::string> find_ssh_link(const Url& url, const LoaderOptions& options,
                                                       std::shared_ptr<SshLink>& link);
/// Returns the name of a link for curl.
[[nodiscard]] std::string ssh_socket_name(const SshLink& link);
/// Listens for one connection of this process, at an address that the system chooses and that curl then connects to.
/// Sets `address` and its size. Returns an empty descriptor on failure. A connected socket would not do, because curl
/// 7.88 connects each socket that it gets.
[[nodiscard]] Descriptor listen_for_self(sockaddr& address, unsigned& bytes);
/// Connects the other end of curl's connection at `listener` to a link, and closes the listener. Ignores connections of
/// other processes. Returns false on failure; true without a listener, for a connection that was used before.
[[nodiscard]] bool connect_self(SshLink& link, Descriptor& listener);
/// Returns the URL of a request over ssh. Its host is constant, because the link decides where the request goes.
[[nodiscard]] std::string http_of_ssh(Url url);
/// Translates a failure of ssh into a transfer result.
[[nodiscard]] TransferEnd describe_ssh_failure(const SshFailure& failure);

}  // namespace gs::net
