#pragma once

#include "app/desktop/file_dialog.h"
#include "app/interface/ui_overlay.h"
#include "app/saving/world_export.h"
#include "app/session/session.h"
#include "app/settings/settings_store.h"
#include "app/view/actions.h"

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gs::app {

/// Saving of worlds, and the questions before a file is replaced or edits are lost. Main thread.
class WorldSaver {
 public:
  /// Objects that the saver uses, and that must outlive it.
  struct Parts {
    Session& session;
    UiOverlay& ui;
    FileDialog& dialog;
    const SettingsStore& store;
  };
  /// `not_kept` is a file that is not the user's, such as the demo world. `close` closes the window. Another thread
  /// calls `wake` when take_results() has a result.
  WorldSaver(Parts parts, std::string not_kept, std::function<void()> close, std::function<void()> wake);

  /// Asks for the file in which to save the world of the active viewport.
  void ask_for_file();
  /// Asks again with the built-in dialog, after the desktop's dialog has failed.
  void ask_in_window();
  /// Saves the world at the path that the user chose. Asks before it replaces a file, unless the user has `agreed`.
  void save_to(const std::string& path, bool agreed);

  /// Returns true if the user's action or request loses no edits. Otherwise asks the user first, and returns false; the
  /// action may follow after the answer.
  [[nodiscard]] bool permits(Action action);
  [[nodiscard]] bool permits(const PaneRequest& request);
  /// Returns true if the window may be closed; see permits().
  [[nodiscard]] bool permits_end() { return permits(Action::quit); }

  /// Returns the question to show; nullopt if there is none.
  [[nodiscard]] std::optional<UiQuestion> question() const;
  void answer(UiAnswer answer);
  /// Reports exports that have ended. Returns false if there are none.
  bool take_results();

 private:
  /// Action that waits until edits are saved or discarded.
  struct Waiting {
    Action action = Action::quit;
    std::size_t pane = 0;
    std::string path;
    std::shared_ptr<Document> document;  // world with the edits
  };

  /// Running export, and the edit of splats that it saves.
  struct Export {
    std::unique_ptr<WorldExport> running;
    std::weak_ptr<Document> document;
    SplatEdit splats;
  };

  [[nodiscard]] bool permits(Action action, std::size_t pane, const std::string& path);
  [[nodiscard]] bool is_shown_elsewhere(std::size_t pane, const std::string& path) const;
  [[nodiscard]] std::string proposed_path() const;
  void show_dialog();
  void write_text(const std::string& path);
  void start_export(const std::string& path);
  void saved(const std::string& path, std::size_t left_out);
  void proceed(const Waiting& waiting);

  Session& session_;
  UiOverlay& ui_;
  FileDialog& dialog_;
  const SettingsStore& store_;
  std::string not_kept_;
  std::function<void()> close_, wake_;
  std::shared_ptr<Document> document_;                // world that is being saved; null if none is
  std::optional<Waiting> asked_;                      // action about which the user is asked
  std::optional<Waiting> after_;                      // action that follows when `document_` is saved
  std::vector<std::shared_ptr<Document>> discarded_;  // worlds that may be lost when the window closes
  bool warned_ = false;                               // the user knows that closing the window ends exports
  std::string replaced_;  // existing file about which the user is asked; empty if there is none
  std::vector<Export> exports_;
};

}  // namespace gs::app
