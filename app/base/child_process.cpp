#include "app/base/child_process.h"

#include "app/base/environment.h"
#include "net/base/descriptor.h"

#include <cerrno>
#include <csignal>
#include <cstring>

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace gs::app {
namespace {

constexpr int kFirstGiven = 3;

bool set_attributes(posix_spawnattr_t& attributes) {
  sigset_t none, standard;
  sigemptyset(&none);
  sigemptyset(&standard);
  sigaddset(&standard, SIGPIPE);
  return ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF) == 0 &&
         ::posix_spawnattr_setsigmask(&attributes, &none) == 0 &&
         ::posix_spawnattr_setsigdefault(&attributes, &standard) == 0;
}

}  // namespace

pid_t start_child(const std::string& program, std::vector<std::string> arguments, std::span<const int> given) {
  const int above = kFirstGiven + static_cast<int>(given.size());
  // Copies above the numbers of the child, so that none is overwritten before it is copied.
  std::vector<net::Descriptor> copies;
  for (const int file : given) copies.emplace_back(::fcntl(file, F_DUPFD_CLOEXEC, above));
  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  if (::posix_spawn_file_actions_init(&actions) != 0) return 0;
  if (::posix_spawnattr_init(&attributes) != 0) {
    (void)::posix_spawn_file_actions_destroy(&actions);
    return 0;
  }
  bool good = set_attributes(attributes) &&
              ::posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0) == 0 &&
              ::posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0) == 0;
  int number = kFirstGiven;
  for (const net::Descriptor& copy : copies)
    good = good && copy && ::posix_spawn_file_actions_adddup2(&actions, copy.get(), number++) == 0;
  good = good && ::posix_spawn_file_actions_addclosefrom_np(&actions, above) == 0;
  arguments.insert(arguments.begin(), program);
  std::vector<char*> pointers;
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  const std::vector<char*> environment = kept_environment();
  pid_t child = 0;
  good =
      good && ::posix_spawn(&child, program.c_str(), &actions, &attributes, pointers.data(), environment.data()) == 0;
  (void)::posix_spawnattr_destroy(&attributes);
  (void)::posix_spawn_file_actions_destroy(&actions);
  return good ? child : 0;
}

std::string end_child(pid_t child) {
  if (child <= 0) return {};
  int status = 0;
  if (::waitpid(child, &status, WNOHANG) == child)
    return WIFSIGNALED(status) ? std::string("signal ") + ::strsignal(WTERMSIG(status)) : "";
  (void)::kill(child, SIGKILL);
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return {};
}

}  // namespace gs::app
