#include "net/control/control_caller.h"

#include "net/base/descriptor.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <string_view>
#include <system_error>

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

namespace gs::net {
namespace {

constexpr std::size_t kMaxAnswer = std::size_t{1} << 20;

ControlCallError call_problem(const std::string& path, const std::string& why) { return {path + ": " + why}; }
ControlCallError call_failure(const std::string& path) {
  return call_problem(path, std::generic_category().message(errno));
}

}  // namespace

std::variant<std::string, ControlCallError> call_control(const std::string& path, const std::string& token,
                                                         const std::string& message,
                                                         std::chrono::milliseconds patience) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point until = Clock::now() + patience;
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof address.sun_path) return call_problem(path, "not a valid socket path");
  path.copy(address.sun_path, path.size());
  const Descriptor socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!socket || ::connect(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
    return call_failure(path);
  ucred peer{};
  socklen_t size = sizeof peer;
  if (::getsockopt(socket.get(), SOL_SOCKET, SO_PEERCRED, &peer, &size) != 0) return call_failure(path);
  if (peer.uid != ::geteuid()) return call_problem(path, "it belongs to another user");
  const std::string text = token + "\n" + message + "\n";
  std::string_view left = text;
  std::string answer;
  std::array<char, 4096> buffer;
  for (;;) {
    const auto time = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now());
    if (time.count() <= 0) return call_problem(path, "no answer in time");
    pollfd watched{socket.get(), static_cast<short>(POLLIN | (left.empty() ? 0 : POLLOUT)), 0};
    if (::poll(&watched, 1, static_cast<int>(std::min<std::int64_t>(time.count(), 60'000))) < 0 && errno != EINTR)
      return call_failure(path);
    if ((watched.revents & POLLOUT) != 0 && !left.empty()) {
      const ssize_t sent = ::send(socket.get(), left.data(), left.size(), MSG_NOSIGNAL);
      if (sent < 0 && errno != EAGAIN && errno != EINTR) return call_failure(path);
      if (sent > 0) left.remove_prefix(static_cast<std::size_t>(sent));
    }
    if ((watched.revents & (POLLIN | POLLHUP | POLLERR)) == 0) continue;
    const ssize_t got = ::recv(socket.get(), buffer.data(), buffer.size(), 0);
    if (got < 0 && (errno == EAGAIN || errno == EINTR)) continue;
    if (got < 0) return call_failure(path);
    if (got == 0) return call_problem(path, "it closed the connection without an answer");
    answer.append(buffer.data(), static_cast<std::size_t>(got));
    if (const std::size_t end = answer.find('\n'); end != std::string::npos) return answer.substr(0, end);
    if (answer.size() > kMaxAnswer) return call_problem(path, "its answer is incomplete");
  }
}

}  // namespace gs::net
