#pragma once

#include "app/session/session.h"
#include "app/settings/settings_store.h"

#include <cstddef>
#include <string>
#include <vector>

namespace gs::app {

/// Record of the opened files in the user's folders: the recent files, and the session that can be restored after a
/// crash. Main thread.
class SessionRecord {
 public:
  /// `session` and `store` must outlive the object. `not_kept` is the file that is not recorded, such as the demo
  /// world. Takes the files of sessions that crashed, if the user wants to restore them.
  SessionRecord(Session& session, SettingsStore& store, std::string not_kept);

  [[nodiscard]] const std::string& not_kept() const { return not_kept_; }
  /// Adds files that were opened to the recent files.
  void note_recent_files(const std::vector<std::string>& opened);
  /// Records files and viewports of the session.
  void note_session();
  /// Returns the files of a session that crashed, until the user has decided about them.
  [[nodiscard]] const std::vector<std::string>& to_restore() const { return lost_.files; }
  /// Opens the files of the session that crashed, if `wanted`. Then forgets them.
  void restore(bool wanted);

 private:
  Session& session_;
  SettingsStore& store_;
  const std::string not_kept_;
  SessionMemory lost_;  // files of sessions that crashed, until the user has decided about them
};

}  // namespace gs::app
