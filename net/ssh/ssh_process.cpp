#include "net/ssh/ssh_process.h"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace gs::net {
namespace {

struct Pipe {
  Descriptor read, write;
  Pipe() {
    int both[2] = {-1, -1};
    if (::pipe2(both, O_CLOEXEC) != 0) return;
    read = Descriptor(both[0]);
    write = Descriptor(both[1]);
  }
};

// Standard signals, and no inherited descriptors except the three pipes.
int spawn(pid_t& child, const std::string& program, char* const* arguments, const Pipe& in, const Pipe& out,
          const Pipe& errors) {
  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  if (const int problem = ::posix_spawn_file_actions_init(&actions)) return problem;
  if (const int problem = ::posix_spawnattr_init(&attributes)) {
    (void)::posix_spawn_file_actions_destroy(&actions);
    return problem;
  }
  sigset_t none, standard;
  sigemptyset(&none);
  sigemptyset(&standard);
  for (const int signal : {SIGPIPE, SIGINT, SIGTERM, SIGHUP}) sigaddset(&standard, signal);
  int problem = ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  if (problem == 0) problem = ::posix_spawnattr_setsigmask(&attributes, &none);
  if (problem == 0) problem = ::posix_spawnattr_setsigdefault(&attributes, &standard);
  if (problem == 0) problem = ::posix_spawn_file_actions_adddup2(&actions, in.read.get(), STDIN_FILENO);
  if (problem == 0) problem = ::posix_spawn_file_actions_adddup2(&actions, out.write.get(), STDOUT_FILENO);
  if (problem == 0) problem = ::posix_spawn_file_actions_adddup2(&actions, errors.write.get(), STDERR_FILENO);
  if (problem == 0) problem = ::posix_spawn_file_actions_addclosefrom_np(&actions, STDERR_FILENO + 1);
  if (problem == 0) problem = ::posix_spawnp(&child, program.c_str(), &actions, &attributes, arguments, environ);
  (void)::posix_spawnattr_destroy(&attributes);
  (void)::posix_spawn_file_actions_destroy(&actions);
  return problem;
}

}  // namespace

std::variant<SshProcess, std::string> SshProcess::start(const std::string& program,
                                                        std::vector<std::string> arguments) {
  Pipe in, out, errors;
  if (!in.write || !out.write || !errors.write) return std::string("no pipes: ") + std::strerror(errno);
  arguments.insert(arguments.begin(), program);
  std::vector<char*> pointers;
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  SshProcess process;
  if (const int problem = spawn(process.child_, program, pointers.data(), in, out, errors)) {
    process.child_ = 0;
    return problem == ENOENT ? "the program " + program + " is not installed"
                             : "the program " + program + " cannot be started: " + std::strerror(problem);
  }
  process.input_ = std::move(in.write);
  process.output_ = std::move(out.read);
  process.errors_ = std::move(errors.read);
  return process;
}

SshProcess::SshProcess(SshProcess&& other) noexcept
    : child_(std::exchange(other.child_, 0)),
      status_(other.status_),
      input_(std::move(other.input_)),
      output_(std::move(other.output_)),
      errors_(std::move(other.errors_)) {}

SshProcess& SshProcess::operator=(SshProcess&& other) noexcept {
  if (this == &other) return *this;
  (void)end({});
  child_ = std::exchange(other.child_, 0);
  status_ = other.status_;
  input_ = std::move(other.input_);
  output_ = std::move(other.output_);
  errors_ = std::move(other.errors_);
  return *this;
}

SshProcess::~SshProcess() { (void)end({}); }

bool SshProcess::wait(std::chrono::milliseconds time) {
  constexpr std::chrono::milliseconds kStep{5};
  for (;; time -= kStep) {
    int status = 0;
    const pid_t ended = ::waitpid(child_, &status, WNOHANG);
    if (ended == child_ || (ended < 0 && errno != EINTR)) {
      if (ended == child_ && WIFEXITED(status)) status_ = WEXITSTATUS(status);
      child_ = 0;
      return true;
    }
    if (time <= std::chrono::milliseconds(0)) return false;
    std::this_thread::sleep_for(kStep);
  }
}

std::optional<int> SshProcess::end(std::chrono::milliseconds patience) {
  input_.close();
  if (child_ == 0 || wait(patience)) return status_;
  (void)::kill(child_, SIGTERM);
  if (wait(patience)) return status_;
  (void)::kill(child_, SIGKILL);
  while (!wait(std::chrono::milliseconds(100))) {
  }
  return status_;
}

}  // namespace gs::net
