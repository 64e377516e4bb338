#include "app/picture/picture_clipboard.h"

#include "net/base/descriptor.h"
#include "net/files/file.h"

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <thread>

#include <fcntl.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace gs::app {
namespace {

// Waits for a program that has copied its input. It may stay in the background. Returns false if it failed.
bool has_taken(pid_t child) {
  constexpr std::chrono::milliseconds kStep{5};
  constexpr int kSteps = 200;
  int status = 0;
  for (int i = 0; i < kSteps; ++i) {
    const pid_t ended = ::waitpid(child, &status, WNOHANG);
    if (ended == child) return WIFEXITED(status) && WEXITSTATUS(status) == 0;
    if (ended < 0 && errno != EINTR) return false;
    std::this_thread::sleep_for(kStep);
  }
  std::thread([child] {
    int ignored = 0;
    while (::waitpid(child, &ignored, 0) < 0 && errno == EINTR) {
    }
  }).detach();
  return true;
}

}  // namespace

std::span<const ClipboardProgram> clipboard_programs() {
  static const std::vector<ClipboardProgram> kPrograms = {
      {"wl-copy", {"--type", "image/png"}, "WAYLAND_DISPLAY"},
      {"xclip", {"-selection", "clipboard", "-target", "image/png"}, "DISPLAY"},
  };
  return kPrograms;
}

std::optional<std::string> copy_png(std::span<const std::byte> png, std::span<const ClipboardProgram> programs) {
  const net::Descriptor file(::memfd_create("picture.png", MFD_CLOEXEC));
  if (file.get() < 0 || !net::write_all(file.get(), png)) return "there is no memory for the picture";
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, file.get(), STDIN_FILENO);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  bool copied = false;
  for (const ClipboardProgram& program : programs) {
    const char* const desktop = std::getenv(program.variable.c_str());
    if (!desktop || !*desktop || ::lseek(file.get(), 0, SEEK_SET) != 0) continue;
    std::vector<std::string> arguments = program.arguments;
    std::vector<char*> words{const_cast<char*>(program.name.c_str())};
    for (std::string& argument : arguments) words.push_back(argument.data());
    words.push_back(nullptr);
    pid_t child = 0;
    const int failed = ::posix_spawnp(&child, program.name.c_str(), &actions, nullptr, words.data(), environ);
    copied = failed == 0 && has_taken(child);
    if (copied) break;
  }
  posix_spawn_file_actions_destroy(&actions);
  if (copied) return std::nullopt;
  return "install wl-copy (package wl-clipboard) or xclip, or press F12 to save the picture";
}

}  // namespace gs::app
