#pragma once

#include "app/inspect/inspection.h"
#include "app/interface/ui_overlay.h"
#include "app/session/session.h"
#include "app/settings/settings_store.h"
#include "app/view/actions.h"
#include "app/viewer/file_dialog.h"

#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gs::app {

/// Window operations. The last four are optional and need a renderer: measuring and saving pictures.
class WindowOperations {
 public:
  virtual ~WindowOperations() = default;
  virtual void toggle_full_screen() = 0;
  virtual void close() = 0;

  /// Runs an action of the tools. Returns false if it is another action, or if there was nothing to close.
  virtual bool run_tool(Action) { return false; }
  /// Handles an event before the session. Returns true if the session must not receive it.
  virtual bool take(const SessionInput::Event&) { return false; }
  virtual void describe_tools(UiTools&) {}
  virtual void apply_tools(const UiToolActions&) {}
};

struct ViewerControllerOptions {
  SessionOptions session;
  UserFolders folders;                     // if empty, no user data is read or written
  std::string not_kept;                    // file that is not remembered, such as the demo world
  float scale = 1;                         // of the screen
  bool up_given = false;                   // session.style.up overrides the setting
  std::span<const DialogProgram> dialogs;  // if empty, the built-in dialog chooses files
};

/// Divides `budget` vectors among the pictures of a frame, by size and viewport weight. An entry is 0 if the picture
/// shows no vectors.
[[nodiscard]] std::vector<std::size_t> budgets_of(const Frame& frame, const Panes& panes, std::size_t budget);

/// Measurements of the last picture, for the status bar.
struct PictureMeasures {
  double frame_ms = 0, frames_a_second = 0;
  std::size_t budget = 0;  // vectors of all viewports together
  std::string gl_renderer;
};

/// Session with its interface and the user's settings: a window without window system and drawing, so that tests need
/// neither. Main thread.
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

  /// Runs the interface's own events and returns those for the session. Call after UiOverlay::begin_frame().
  [[nodiscard]] std::vector<SessionInput::Event> take(const std::vector<WindowEvent>& events);
  /// Reports the results of a step to the user and the log. Returns true if the interface has changed.
  bool tell(const Frame& frame);
  /// Returns the data that the interface shows.
  [[nodiscard]] UiModel model(const Frame& frame, const PictureMeasures& measures);
  /// Returns true if the interface shows transfer rates, so that it must be redrawn soon.
  [[nodiscard]] bool shows_rates() const;
  /// Runs the user's requests.
  void apply(const UiActions& actions);
  /// Opens the files chosen in the desktop's dialog. Returns true if the dialog has ended.
  bool take_chosen_files();
  /// Returns the title of the window.
  [[nodiscard]] std::string title();
  /// Stores the size and position of the window for the next start.
  void note_window(int width, int height, const std::optional<std::array<int, 2>>& place);

 private:
  bool run(Action action);
  bool picks(const WindowEvent& event);
  void change(const UserSettings& settings);
  void exchange_camera(Action action);
  [[nodiscard]] std::string folder_of_file() const;
  [[nodiscard]] std::optional<Bookmark> bookmark_of_view();
  [[nodiscard]] std::optional<std::size_t> find_bookmark();
  void toggle_bookmark();
  void open_bookmark(std::size_t index);
  void remember(const std::vector<std::string>& arrived);
  void note_session();
  void restore();
  void describe_viewports(UiModel& model, const Frame& frame, std::size_t budget);
  void describe_user(UiModel& model, const Pane& pane);
  [[nodiscard]] std::string progress_of(const std::string& path);

  SettingsStore store_;
  WindowOperations& window_;
  std::string not_kept_;
  bool up_given_, memory_given_;
  UiOverlay ui_;
  Session session_;
  Inspection inspection_;  // extension of the session
  std::array<RateHistory, kMaxViewports> readings_;
  FileDialog dialog_;
  SessionMemory lost_;   // sessions that ended unexpectedly, until the user has answered
  std::string opening_;  // last choice in the Open dialog
};

}  // namespace gs::app
