#pragma once

#include "app/inspect/inspection.h"
#include "app/interface/ui_overlay.h"
#include "app/session/session.h"
#include "app/settings/user_keeper.h"
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

/// What only a window can do, and, behind these two, what only one who draws can: measure, and keep pictures. Who
/// does not draw leaves that out.
class DeskWindow {
 public:
  virtual ~DeskWindow() = default;
  virtual void toggle_full_screen() = 0;
  virtual void close() = 0;

  /// False: the action is none of that kind, or there was nothing to be closed.
  virtual bool run_tool(Action) { return false; }
  /// What is about to be the session's. True: it was its own, and the session does not see it.
  virtual bool take(const SessionInput::Event&) { return false; }
  virtual void describe_tools(UiTools&) {}
  virtual void apply_tools(const UiToolActions&) {}
};

struct DeskOptions {
  SessionOptions session;
  UserFolders folders;                     // empty: nothing of the user's is read or written
  std::string not_kept;                    // a file that is not remembered: that of a program without arguments
  float scale = 1;                         // of the screen
  bool up_given = false;                   // session.style.up counts before the setting
  std::span<const DialogProgram> dialogs;  // none: files are chosen in its own dialog
};

/// How many of `budget` vectors each picture of a frame gets: by its size and by the weight of its viewport; 0: it
/// shows none.
[[nodiscard]] std::vector<std::size_t> budgets_of(const Frame& frame, const Panes& panes, std::size_t budget);

/// What the picture took, for the status bar.
struct DeskMeasures {
  double frame_ms = 0, frames_a_second = 0;
  std::size_t budget = 0;  // vectors of all viewports together
  std::string gl_renderer;
};

/// A session, its interface, and what is kept of the user's; all of a window but the window and the drawing, so that
/// tests can do without both. Main thread.
class Desk {
 public:
  Desk(DeskOptions options, LoadOptions load, std::unique_ptr<InterfaceBackend> backend, DeskWindow& window,
       const std::function<void()>& wake);
  ~Desk();
  Desk(const Desk&) = delete;
  Desk& operator=(const Desk&) = delete;

  [[nodiscard]] Session& session() { return session_; }
  [[nodiscard]] UiOverlay& ui() { return ui_; }
  [[nodiscard]] Inspection& inspection() { return inspection_; }
  [[nodiscard]] const UserKeeper& kept() const { return keeper_; }

  /// What of the events is the session's, behind UiOverlay::begin_frame; does what is the interface's own.
  [[nodiscard]] std::vector<SessionInput::Event> take(const std::vector<WindowEvent>& events);
  /// Tells the user, and those who read the log, what a step has led to. True: the interface shows something else.
  bool tell(const Frame& frame);
  /// What the interface is to show of it.
  [[nodiscard]] UiModel model(const Frame& frame, const DeskMeasures& measures);
  /// It tells how much comes a second, and will tell something else soon.
  [[nodiscard]] bool shows_rates() const;
  /// Does what the user asked for with it.
  void apply(const UiActions& actions);
  /// Opens what was chosen in the desktop's dialog. True: that has ended.
  bool take_chosen_files();
  /// Of the window.
  [[nodiscard]] std::string title();
  /// How large the window is, and where, for the next one.
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
  [[nodiscard]] std::string progress_of(const std::string& path) const;

  UserKeeper keeper_;
  DeskWindow& window_;
  std::string not_kept_;
  bool up_given_, memory_given_;
  UiOverlay ui_;
  Session session_;
  Inspection inspection_;  // a guest of the session
  std::array<RateHistory, kMostViewports> readings_;
  FileDialog dialog_;
  SessionMemory lost_;   // of windows that ended by themselves, until the user has answered
  std::string opening_;  // what was chosen in the Open dialog last
};

}  // namespace gs::app
