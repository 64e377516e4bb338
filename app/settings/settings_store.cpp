#include "app/settings/settings_store.h"

#include "app/base/temporary_file.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <filesystem>
#include <system_error>
#include <utility>

#include <unistd.h>

namespace gs::app {
namespace {

namespace fs = std::filesystem;
constexpr char kMemoryFile[] = "/memory.json", kLogFile[] = "/log", kSessionStart[] = "session-",
               kSessionEnd[] = ".json";
constexpr std::size_t kMaxSessions = 16;  // max number of session files that are read

// Returns the process ID in the name of a session file.
std::optional<pid_t> process_of(const std::string& name) {
  if (!name.starts_with(kSessionStart) || !name.ends_with(kSessionEnd)) return std::nullopt;
  const std::size_t first = sizeof kSessionStart - 1, end = name.size() - (sizeof kSessionEnd - 1);
  if (end <= first) return std::nullopt;
  pid_t process = 0;
  const auto [stop, error] = std::from_chars(name.data() + first, name.data() + end, process);
  return error == std::errc() && stop == name.data() + end && process > 0 ? std::optional(process) : std::nullopt;
}

bool is_running(pid_t process) { return ::kill(process, 0) == 0 || errno == EPERM; }

}  // namespace

AppState remembered(const UserFolders& folders) {
  std::string problem;
  const auto text = folders.state.empty() ? std::nullopt : read_user_file(folders.state + kMemoryFile, problem);
  return text ? read_memory(*text).value_or(AppState{}) : AppState{};
}

SettingsStore::SettingsStore(UserFolders folders) : folders_(std::move(folders)) {
  if (!folders_.state.empty()) {
    session_file_ = folders_.state + "/" + kSessionStart + std::to_string(::getpid()) + kSessionEnd;
    log_ = LogFile(folders_.state + kLogFile);
    remove_unfinished_beside(session_file_);
  }
  remove_unfinished_beside(folders_.settings_file);
  remove_unfinished_beside(folders_.bookmarks_file);
  read();
}

SettingsStore::~SettingsStore() {
  std::error_code error;
  if (session_) fs::remove(session_file_, error);
}

void SettingsStore::read() {
  const auto contents = [this](const std::string& path) {
    std::string problem;
    auto text = read_user_file(path, problem);
    if (!problem.empty()) {
      problems_.push_back(problem);
      unread_.push_back(path);
    }
    return text;
  };
  if (const auto text = contents(folders_.settings_file)) {
    ReadSettings found = read_settings(*text);
    settings_ = found.settings;
    for (const std::string& problem : found.problems) problems_.push_back(folders_.settings_file + ":" + problem);
    if (!found.problems.empty()) keep_bad_file(folders_.settings_file, *text);
  }
  const auto spoilt = [this](const std::string& path, const std::string& text) {
    problems_.push_back(path + ": error: not a file written by GhostSpace; kept as " + path + ".bad");
    keep_bad_file(path, text);
  };
  if (const auto text = contents(folders_.bookmarks_file)) {
    if (auto found = read_bookmarks(*text))
      bookmarks_ = std::move(*found);
    else
      spoilt(folders_.bookmarks_file, *text);
  }
  if (folders_.state.empty()) return;
  const std::string memory_file = folders_.state + kMemoryFile;
  if (const auto text = contents(memory_file)) {
    if (auto found = read_memory(*text))
      state_ = std::move(*found);
    else
      spoilt(memory_file, *text);
  }
}

void SettingsStore::write(const std::string& path, const std::string& text) {
  if (path.empty()) return;
  const bool unread = std::find(unread_.begin(), unread_.end(), path) != unread_.end();
  if (std::optional<std::string> problem =
          unread ? path + ": error: not saved, because the file could not be read" : write_user_file(path, text)) {
    // Report an equal problem only once.
    if (std::find(problems_.begin(), problems_.end(), *problem) == problems_.end())
      problems_.push_back(std::move(*problem));
  }
}

void SettingsStore::set(const UserSettings& settings) {
  if (std::exchange(settings_, settings) != settings) write(folders_.settings_file, settings_text(settings_));
}

void SettingsStore::set(const AppState& state) {
  if (std::exchange(state_, state) != state && !folders_.state.empty())
    write(folders_.state + kMemoryFile, memory_text(state_));
}

void SettingsStore::set(const std::vector<Bookmark>& bookmarks) {
  if (std::exchange(bookmarks_, bookmarks) != bookmarks) write(folders_.bookmarks_file, bookmarks_text(bookmarks_));
}

void SettingsStore::note_session(const SessionMemory& session) {
  if (session_file_.empty() || session_ == session) return;
  session_ = session;
  write(session_file_, session_text(session));
}

SessionMemory SettingsStore::take_lost_sessions() {
  SessionMemory lost;
  if (folders_.state.empty()) return lost;
  std::error_code error;
  std::vector<fs::path> files;
  fs::directory_iterator entry(folders_.state, error);
  for (; !error && entry != fs::directory_iterator(); entry.increment(error)) {
    const auto process = process_of(entry->path().filename().string());
    if (process && !is_running(*process) && files.size() < kMaxSessions) files.push_back(entry->path());
  }
  for (const fs::path& file : files) {
    std::string problem;
    const auto text = read_user_file(file.string(), problem);
    const auto session = text ? read_session(*text) : std::nullopt;
    // Restore the arrangement of the first session only. The other sessions only add their files.
    if (session && lost.files.empty()) {
      lost.split = session->split;
      lost.viewports = session->viewports;
    }
    if (session)
      for (const std::string& one : session->files)
        if (std::find(lost.files.begin(), lost.files.end(), one) == lost.files.end()) lost.files.push_back(one);
    fs::remove(file, error);
  }
  return lost;
}

std::vector<std::string> SettingsStore::take_problems() { return std::exchange(problems_, {}); }

void SettingsStore::log(std::string_view line) {
  if (settings_.writes_log) log_.add(line);
}

}  // namespace gs::app
