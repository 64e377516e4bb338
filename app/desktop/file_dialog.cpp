#include "app/desktop/file_dialog.h"

#include "net/base/descriptor.h"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <mutex>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace gs::app {
namespace {

constexpr std::size_t kMaxOutput = std::size_t{1} << 20;
constexpr int kChosenNone = 1;  // exit status of each program when the user cancels

bool has_desktop() {
  for (const char* variable : {"DISPLAY", "WAYLAND_DISPLAY"})
    if (const char* value = std::getenv(variable); value && *value) return true;
  return false;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    if (end > at) lines.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return lines;
}

}  // namespace

std::span<const DialogProgram> dialog_programs() {
  static const std::vector<DialogProgram> kPrograms = {
      {"zenity",
       {"--file-selection", "--multiple", "--separator=\n", "--title=Open", "--filename={folder}/"},
       {"--file-selection", "--save", "--confirm-overwrite", "--title=Save as", "--filename={file}"}},
      {"kdialog",
       {"--title", "Open", "--multiple", "--separate-output", "--getopenfilename", "{folder}"},
       {"--title", "Save as", "--getsavefilename", "{file}"}},
      {"qarma",
       {"--file-selection", "--multiple", "--separator=\n", "--title=Open", "--filename={folder}/"},
       {"--file-selection", "--save", "--confirm-overwrite", "--title=Save as", "--filename={file}"}},
  };
  return kPrograms;
}

struct FileDialog::Running {
  pid_t child = 0;
  bool saves = false;
  net::Descriptor output;
  std::mutex mutex;
  std::optional<Answer> answer;  // guarded by the mutex
  std::thread reader;            // last member: its thread uses the others
};

FileDialog::FileDialog(std::function<void()> wake, std::span<const DialogProgram> programs)
    : wake_(std::move(wake)), programs_(programs) {}

FileDialog::~FileDialog() {
  if (!running_) return;
  {
    const std::lock_guard lock(running_->mutex);
    if (!running_->answer) (void)::kill(running_->child, SIGKILL);
  }
  running_->reader.join();
}

bool FileDialog::show(const std::string& folder) { return start(false, kFolderArgument, folder); }

bool FileDialog::show_saving(const std::string& path) { return start(true, kFileArgument, path); }

bool FileDialog::start(bool saves, const char* placeholder, const std::string& place) {
  if (running_) return true;
  if (!has_desktop()) return false;
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) return false;
  auto running = std::make_unique<Running>();
  running->saves = saves;
  running->output = net::Descriptor(ends[0]);
  const net::Descriptor input(ends[1]);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, input.get(), STDOUT_FILENO);
  // Discard the messages that toolkits write about the desktop.
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  bool started = false;
  for (const DialogProgram& program : programs_) {
    std::vector<std::string> arguments = saves ? program.save_arguments : program.arguments;
    if (arguments.empty()) continue;
    for (std::string& argument : arguments)
      if (const std::size_t at = argument.find(placeholder); at != std::string::npos)
        argument.replace(at, std::strlen(placeholder), place);
    std::vector<char*> words{const_cast<char*>(program.name.c_str())};
    for (std::string& argument : arguments) words.push_back(argument.data());
    words.push_back(nullptr);
    started = ::posix_spawnp(&running->child, program.name.c_str(), &actions, nullptr, words.data(), environ) == 0;
    if (started) break;
  }
  posix_spawn_file_actions_destroy(&actions);
  if (!started) return false;
  running_ = std::move(running);
  // `input` is closed at the end of this function; then only the child can write to the pipe.
  running_->reader = std::thread([run = running_.get(), wake = wake_] {
    std::string text;
    char buffer[4096];
    for (;;) {
      const ssize_t count = ::read(run->output.get(), buffer, sizeof buffer);
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) break;
      if (text.size() < kMaxOutput) text.append(buffer, static_cast<std::size_t>(count));
    }
    siginfo_t about{};
    while (::waitid(P_PID, static_cast<id_t>(run->child), &about, WEXITED | WNOWAIT) != 0 && errno == EINTR) {
    }
    Answer answer;
    answer.saves = run->saves;
    {
      // Reap the child under the mutex: a reaped process ID may be reused, and the destructor must not kill it then.
      const std::lock_guard lock(run->mutex);
      int status = 0;
      (void)::waitpid(run->child, &status, 0);
      const bool exited = WIFEXITED(status);
      if (exited && WEXITSTATUS(status) == 0) answer.files = lines_of(text);
      answer.failed = !exited || WEXITSTATUS(status) > kChosenNone;
      run->answer = answer;
    }
    wake();
  });
  return true;
}

std::optional<FileDialog::Answer> FileDialog::take() {
  if (!running_) return std::nullopt;
  std::optional<Answer> answer;
  {
    const std::lock_guard lock(running_->mutex);
    answer = std::move(running_->answer);
    if (!answer) return std::nullopt;
  }
  running_->reader.join();
  running_.reset();
  return answer;
}

}  // namespace gs::app
