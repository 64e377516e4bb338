#pragma once

#include "app/settings/log_file.h"
#include "app/settings/user_folders.h"
#include "app/settings/user_memory.h"
#include "app/settings/user_settings.h"

#include <optional>
#include <string>
#include <vector>

namespace gs::app {

/// What the program remembered last, as far as it can be read; says nothing.
[[nodiscard]] UserMemory remembered(const UserFolders& folders);

/// What is kept of the user's from one window to the next: settings, bookmarks, and what the program remembers. Written
/// when it changes, each file as a whole or not at all. What cannot be read is told once, kept as FILE.bad, and stops
/// nothing. Without folders it reads and writes nothing. One thread.
class UserKeeper {
 public:
  explicit UserKeeper(UserFolders folders);
  /// A clean end: there is nothing to restore.
  ~UserKeeper();
  UserKeeper(const UserKeeper&) = delete;
  UserKeeper& operator=(const UserKeeper&) = delete;

  [[nodiscard]] const UserSettings& settings() const { return settings_; }
  void set(const UserSettings& settings);
  [[nodiscard]] const UserMemory& memory() const { return memory_; }
  void set(const UserMemory& memory);
  [[nodiscard]] const std::vector<Bookmark>& bookmarks() const { return bookmarks_; }
  void set(const std::vector<Bookmark>& bookmarks);

  /// What this window shows, for the one after it if it ends by itself.
  void note_session(const SessionMemory& session);
  /// What windows showed that ended by themselves; asked once, then they are forgotten.
  [[nodiscard]] SessionMemory take_lost_sessions();

  /// What went wrong since the last call, a line each: `FILE:LINE: error: ...`.
  [[nodiscard]] std::vector<std::string> take_problems();
  /// Writes a line into the log on disk, if the settings say so.
  void log(std::string_view line);

 private:
  void read();
  void write(const std::string& path, const std::string& text);

  UserFolders folders_;
  UserSettings settings_;
  UserMemory memory_;
  std::vector<Bookmark> bookmarks_;
  std::optional<SessionMemory> session_;  // as it was written last
  std::string session_file_;
  std::vector<std::string> problems_;
  LogFile log_;
};

}  // namespace gs::app
