#pragma once

#include "app/settings/app_state.h"
#include "app/settings/log_file.h"
#include "app/settings/user_folders.h"
#include "app/settings/user_settings.h"

#include <optional>
#include <string>
#include <vector>

namespace gs::app {

/// Returns the stored state of the program, as far as it is readable. Reports no errors.
[[nodiscard]] AppState remembered(const UserFolders& folders);

/// Store of the user's settings, bookmarks and state between windows. Each change writes its file atomically. An
/// unreadable file is reported once, saved as FILE.bad, and otherwise ignored. Without folders, nothing is read or
/// written. One thread.
class SettingsStore {
 public:
  explicit SettingsStore(UserFolders folders);
  /// Removes the session's file, because a clean end leaves nothing to restore.
  ~SettingsStore();
  SettingsStore(const SettingsStore&) = delete;
  SettingsStore& operator=(const SettingsStore&) = delete;

  [[nodiscard]] const UserSettings& settings() const { return settings_; }
  void set(const UserSettings& settings);
  [[nodiscard]] const AppState& state() const { return state_; }
  void set(const AppState& state);
  [[nodiscard]] const std::vector<Bookmark>& bookmarks() const { return bookmarks_; }
  void set(const std::vector<Bookmark>& bookmarks);

  /// Stores the files of this window, to restore them if the program ends unexpectedly.
  void note_session(const SessionMemory& session);
  /// Returns the sessions that ended unexpectedly, and forgets them.
  [[nodiscard]] SessionMemory take_lost_sessions();

  /// Returns the problems since the last call, one line each: `FILE:LINE: error: ...`.
  [[nodiscard]] std::vector<std::string> take_problems();
  /// Writes a line to the log on disk, if the settings allow it.
  void log(std::string_view line);

 private:
  void read();
  void write(const std::string& path, const std::string& text);

  UserFolders folders_;
  UserSettings settings_;
  AppState state_;
  std::vector<Bookmark> bookmarks_;
  std::optional<SessionMemory> session_;  // as last written
  std::string session_file_;
  std::vector<std::string> problems_;
  LogFile log_;
};

}  // namespace gs::app
