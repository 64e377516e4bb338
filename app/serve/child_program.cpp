#include "app/serve/child_program.h"

#include "app/base/environment.h"
#include "app/base/exit_status.h"
#include "net/base/descriptor.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

namespace gs::app {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kCannotStart = 127;  // exit status that shells use for this case

// Returns the last line of a file.
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

// Runs in the child between fork and exec. Only this thread exists there, so it may only make system calls.
[[noreturn]] void become(const char* program, char* const* arguments, char* const* environment, int error_output,
                         const ChildLimits& limits) {
  // The child is killed when this program ends. It ignores Ctrl-C on the terminal.
  (void)::prctl(PR_SET_PDEATHSIG, SIGKILL);
  (void)::setpgid(0, 0);
  sigset_t none;
  sigemptyset(&none);
  (void)::sigprocmask(SIG_SETMASK, &none, nullptr);
  struct sigaction standard {};
  standard.sa_handler = SIG_DFL;
  (void)::sigaction(SIGPIPE, &standard, nullptr);
  const auto set = [](__rlimit_resource which, std::uint64_t most) {
    const rlimit both{most, most};
    return ::setrlimit(which, &both) == 0;
  };
  bool good = set(RLIMIT_FSIZE, limits.file_bytes) && set(RLIMIT_CORE, 0);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // sanitizers need terabytes of address space
  good = good && set(RLIMIT_DATA, limits.memory);
#endif
  const int nothing = ::open("/dev/null", O_RDWR);
  good = good && ::dup2(nothing, STDIN_FILENO) >= 0 && ::dup2(nothing, STDOUT_FILENO) >= 0 &&
         ::dup2(error_output, STDERR_FILENO) >= 0;
  // Close all other descriptors, because some may lack the close-on-exec flag.
  (void)::close_range(STDERR_FILENO + 1, ~0U, 0);
  if (good) (void)::execve(program, arguments, environment);
  ::_exit(kCannotStart);
}

// Starts the program. Returns the process ID, or 0 if no process could be created.
pid_t spawn(const std::string& program, const std::vector<std::string>& arguments, int error_output,
            const ChildLimits& limits) {
  std::vector<char*> list{const_cast<char*>(program.c_str())};
  for (const std::string& argument : arguments) list.push_back(const_cast<char*>(argument.c_str()));
  list.push_back(nullptr);
  const std::vector<char*> environment = kept_environment();
  const pid_t child = ::fork();
  if (child == 0) become(program.c_str(), list.data(), environment.data(), error_output, limits);
  return std::max<pid_t>(child, 0);
}

// Returns the failure that an exit status stands for; nullopt on success. `line` is the last line on standard error.
std::optional<ChildFailure> failure_of(int status, const std::string& line) {
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    // The system sends SIGKILL when memory runs out, so a retry may succeed.
    return ChildFailure{std::string("ended by signal ") + ::strsignal(signal), signal != SIGKILL};
  }
  if (WEXITSTATUS(status) == kDone) return std::nullopt;
  if (WEXITSTATUS(status) == kCannotStart) return ChildFailure{"cannot be started", false};
  return ChildFailure{line.empty() ? "failed" : line, WEXITSTATUS(status) != kNotWritten};
}

}  // namespace

std::optional<ChildFailure> run_child(const std::string& program, const std::vector<std::string>& arguments,
                                      const ChildLimits& limits, const std::stop_token& stop) {
  const net::Descriptor errors(::memfd_create("errors", MFD_CLOEXEC));
  const pid_t child = spawn(program, arguments, errors.get(), limits);
  if (child == 0) return ChildFailure{program + " cannot be started", false};
  const net::Descriptor watch(static_cast<int>(::syscall(SYS_pidfd_open, child, 0)));
  const Clock::time_point end = Clock::now() + limits.time;
  int status = 0;
  bool killed = false;
  for (;;) {
    const pid_t ended = ::waitpid(child, &status, WNOHANG);
    if (ended == child) break;
    if (ended < 0 && errno != EINTR) return ChildFailure{"lost its process", false};
    if (!killed && (stop.stop_requested() || Clock::now() >= end)) {
      ::kill(child, SIGKILL);
      killed = true;
    }
    pollfd wait{watch.get(), POLLIN, 0};
    (void)::poll(&wait, 1, 50);
  }
  if (killed)
    return stop.stop_requested() ? ChildFailure{"was stopped", false} : ChildFailure{"exceeded the time limit", true};
  return failure_of(status, last_line(errors));
}

}  // namespace gs::app
