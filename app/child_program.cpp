#include "app/child_program.h"

#include "net/descriptor.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace gs::app {
namespace {

using Clock = std::chrono::steady_clock;

// The last line that is there.
std::string last_line(const net::Descriptor& file) {
  std::array<char, 4096> end{};
  const off_t size = ::lseek(file.get(), 0, SEEK_END);
  const off_t begin = std::max<off_t>(0, size - static_cast<off_t>(end.size()));
  const ssize_t got = ::pread(file.get(), end.data(), end.size(), begin);
  std::string text(end.data(), got > 0 ? static_cast<std::size_t>(got) : 0);
  while (!text.empty() && text.back() == '\n') text.pop_back();
  const std::size_t line = text.rfind('\n');
  return line == std::string::npos ? text : text.substr(line + 1);
}

void limit(pid_t child, const ChildLimits& limits) {
  const auto set = [child](__rlimit_resource which, std::uint64_t most) {
    const rlimit both{most, most};
    (void)::prlimit(child, which, &both, nullptr);
  };
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // whose shadows take terabytes of addresses
  set(RLIMIT_AS, limits.memory);
#endif
  set(RLIMIT_FSIZE, limits.file_bytes);
  set(RLIMIT_CORE, 0);
}

// 0 when it cannot be started.
pid_t spawn(const std::string& program, const std::vector<std::string>& arguments, int error_output) {
  std::vector<char*> list{const_cast<char*>(program.c_str())};
  for (const std::string& argument : arguments) list.push_back(const_cast<char*>(argument.c_str()));
  list.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  posix_spawn_file_actions_init(&actions);
  posix_spawnattr_init(&attributes);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, error_output, STDERR_FILENO);
  // The server blocks signals, and Ctrl-C on its terminal is not the child's.
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setpgroup(&attributes, 0);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETPGROUP);
  pid_t child = 0;
  if (posix_spawn(&child, program.c_str(), &actions, &attributes, list.data(), environ) != 0) child = 0;
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  return child;
}

}  // namespace

std::optional<std::string> run_child(const std::string& program, const std::vector<std::string>& arguments,
                                     const ChildLimits& limits, const std::stop_token& stop) {
  const net::Descriptor errors(::memfd_create("errors", MFD_CLOEXEC));
  const pid_t child = spawn(program, arguments, errors.get());
  if (child == 0) return program + " cannot be started";
  limit(child, limits);
  const net::Descriptor watch(static_cast<int>(::syscall(SYS_pidfd_open, child, 0)));
  const Clock::time_point end = Clock::now() + limits.time;
  int status = 0;
  bool killed = false;
  for (;;) {
    const pid_t ended = ::waitpid(child, &status, WNOHANG);
    if (ended == child) break;
    if (ended < 0 && errno != EINTR) return "lost its process";
    if (!killed && (stop.stop_requested() || Clock::now() >= end)) {
      ::kill(child, SIGKILL);
      killed = true;
    }
    pollfd wait{watch.get(), POLLIN, 0};
    (void)::poll(&wait, 1, 50);
  }
  if (killed) return stop.stop_requested() ? "was stopped" : "takes too long";
  if (WIFSIGNALED(status)) return std::string("ended by signal ") + ::strsignal(WTERMSIG(status));
  if (WEXITSTATUS(status) == 0) return std::nullopt;
  const std::string line = last_line(errors);
  return line.empty() ? "failed" : line;
}

}  // namespace gs::app
