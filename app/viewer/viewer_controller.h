#pragma once

#include "app/desktop/file_dialog.h"
#include "app/inspect/inspection.h"
#include "app/interface/ui_overlay.h"
#include "app/session/session.h"
#include "app/settings/settings_store.h"
#include "app/view/actions.h"
#include "app/viewer/saving/session_record.h"
#include "app/viewer/saving/view_bookmarks.h"
#include "app/viewer/saving/world_saver.h"
#include "app/viewer/viewer_splats.h"

#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gs::app {

/// Operations of a window. The last four functions are optional: they belong to the tools for measuring and saving
/// pictures, and need a renderer.
class WindowOperations {
 public:
  virtual ~WindowOperations() = default;
  virtual void toggle_full_screen() = 0;
  virtual void close() = 0;

  /// Runs an action of the tools. Returns false if the action is not theirs, or if it should close a tool and none is
  /// open.
  virtual bool run_tool(Action) { return false; }
  /// Handles an event before the session does. Returns true if the session must not receive the event.
  virtual bool take(const SessionInput::Event&) { return false; }
  virtual void describe_tools(UiTools&) {}
  virtual void apply_tools(const UiToolActions&) {}
};

struct ViewerControllerOptions {
  SessionOptions session;
  UserFolders folders;                     // paths of user data; if empty, none are read or written
  std::string not_kept;                    // file that is not added to the recent files, such as the demo world
  float scale = 1;                         // scale of the screen; 1 is normal
  bool up_given = false;                   // `session.style.up` has precedence over the setting
  std::span<const DialogProgram> dialogs;  // programs for file dialogs; if empty, the built-in dialog is used
};

/// Divides `budget` vectors among the pictures of a frame, by their sizes and the weights of their viewports. A picture
/// without vectors gets 0.
[[nodiscard]] std::vector<std::size_t> budgets_of(const Frame& frame, const Panes& panes, std::size_t budget);

/// Measurements of the last frame, for the status bar.
struct PictureMeasures {
  double frame_ms = 0, frames_a_second = 0;
  std::size_t budget = 0;  // max vectors in all viewports together
  std::string gl_renderer;
};

/// Session with its interface and the user's settings: everything of a window except for the window system and drawing.
/// Therefore tests need neither. Main thread.
class ViewerController {
 public:
  ViewerController(ViewerControllerOptions options, LoadOptions load, std::unique_ptr<InterfaceBackend> backend,
                   WindowOperations& window, const std::function<void()>& wake);
  ~ViewerController();
  ViewerController(const ViewerController&) = delete;
  ViewerController& operator=(const ViewerController&) = delete;

  [[nodiscard]] Session& session() { return session_; }
  [[nodiscard]] UiOverlay& ui() { return ui_; }
  [[nodiscard]] Inspection& inspection() { return inspection_; }
  [[nodiscard]] const SettingsStore& kept() const { return store_; }

  /// Handles events that belong to the interface, and returns those for the session. Call after
  /// UiOverlay::begin_frame().
  [[nodiscard]] std::vector<SessionInput::Event> take(const std::vector<WindowEvent>& events);
  /// Reports the result of a step to the user and to the log. Returns true if the interface must be drawn again.
  bool tell(const Frame& frame);
  /// Returns the state that the interface shows in this frame.
  [[nodiscard]] UiModel model(const Frame& frame, const PictureMeasures& measures);
  /// Returns true if the interface shows transfer rates, which must be updated regularly.
  [[nodiscard]] bool shows_rates() const;
  /// Carries out the user's requests of a frame.
  void apply(const UiActions& actions);
  /// Opens the files that the user has chosen in the desktop's dialog. Returns true if the dialog has ended.
  bool take_chosen_files();
  /// Returns true if the window may be closed. Otherwise asks the user first, and closes it later.
  [[nodiscard]] bool may_close() { return saver_.permits_end(); }
  /// Returns the present title of the window.
  [[nodiscard]] std::string title();
  /// Saves the size and position of the window for the next start, in screen units.
  void note_window(int width, int height, const std::optional<std::array<int, 2>>& place);

 private:
  bool run(Action action);
  bool picks(const WindowEvent& event);
  void change(const UserSettings& settings);
  void exchange_camera(Action action);
  bool undo(int direction);
  [[nodiscard]] std::string folder_of_file() const;
  void describe_viewports(UiModel& model, const Frame& frame, std::size_t budget);
  void describe_user(UiModel& model, const Pane& pane);
  [[nodiscard]] std::string progress_of(const std::string& path);

  SettingsStore store_;
  WindowOperations& window_;
  bool up_given_, memory_given_;
  UiOverlay ui_;
  Session session_;
  Inspection inspection_;       // extension of the session
  SplatEditing splat_editing_;  // extension of the session
  std::array<RateHistory, kMaxViewports> readings_;
  ViewBookmarks bookmarks_;
  SessionRecord record_;
  FileDialog dialog_;
  WorldSaver saver_;
  std::string opening_;  // file that the user chose in the Open dialog and that is still loading
};

}  // namespace gs::app
