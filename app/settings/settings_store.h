#pragma once

#include "app/settings/app_state.h"
#include "app/settings/log_file.h"
#include "app/settings/user_folders.h"
#include "app/settings/user_settings.h"
#include "base/noncopyable.h"

#include <optional>
#include <string>
#include <vector>

namespace gs::app {

/// Returns the saved state of the program; defaults for all values that cannot be read. Reports no errors.
[[nodiscard]] AppState remembered(const UserFolders& folders);

/// Store of the user's settings and bookmarks, and of the state that is kept between windows. Each change writes its
/// file atomically. A file with a wrong format is copied to FILE.bad, reported once, and otherwise ignored. A file that
/// cannot be read stays as it is. If `folders` is empty, nothing is read or written. One thread.
class SettingsStore : NonCopyable {
 public:
  explicit SettingsStore(UserFolders folders);
  /// Removes this window's session file, because after a regular end there is nothing to restore.
  ~SettingsStore();

  [[nodiscard]] const UserSettings& settings() const { return settings_; }
  void set(const UserSettings& settings);
  [[nodiscard]] const AppState& state() const { return state_; }
  void set(const AppState& state);
  [[nodiscard]] const std::vector<Bookmark>& bookmarks() const { return bookmarks_; }
  void set(const std::vector<Bookmark>& bookmarks);

  /// Saves the files of this window, so that they can be restored after a crash.
  void note_session(const SessionMemory& session);
  /// Returns the files of all sessions that crashed, and removes the session files.
  [[nodiscard]] SessionMemory take_lost_sessions();

  /// Returns the problems since the previous call, one line each: `FILE:LINE: error: ...`.
  [[nodiscard]] std::vector<std::string> take_problems();
  /// Appends a line to the log on disk, if the settings allow a log.
  void log(std::string_view line);

 private:
  void read();
  void write(const std::string& path, const std::string& text);

  UserFolders folders_;
  UserSettings settings_;
  AppState state_;
  std::vector<Bookmark> bookmarks_;
  std::optional<SessionMemory> session_;  // contents of the session file, as written last
  std::string session_file_;
  std::vector<std::string> problems_;
  std::vector<std::string> unread_;  // files with unknown contents, which are therefore never replaced
  LogFile log_;
};

}  // namespace gs::app
