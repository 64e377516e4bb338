#pragma once

#include "app/interface/base/ui_model.h"
#include "app/interface/dock/dock.h"
#include "app/settings/user_memory.h"
#include "app/view/actions.h"
#include "app/view/viewports.h"
#include "app/window/window_event.h"

#include <glm/vec2.hpp>

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// What the interface is shown on: a window, or nothing at all in tests.
class InterfaceBackend {
 public:
  InterfaceBackend() = default;
  InterfaceBackend(const InterfaceBackend&) = delete;
  InterfaceBackend& operator=(const InterfaceBackend&) = delete;
  virtual ~InterfaceBackend() = default;

  /// Once, in the context of Dear ImGui.
  virtual void begin() = 0;
  /// Tells Dear ImGui sizes and times of the frame that begins.
  virtual void begin_frame() = 0;
  /// The font atlas of Dear ImGui is another than before.
  virtual void fonts_changed() = 0;
  /// Draws what was laid out into the framebuffer that is bound.
  virtual void draw() = 0;
};

/// The bars and panels around the picture. Belongs to the thread of the window, whose context is current.
/// Writes no files.
class UiOverlay {
 public:
  /// `scale`: 1 on a common screen.
  UiOverlay(std::unique_ptr<InterfaceBackend> backend, float scale, const UserSettings& settings = {});
  ~UiOverlay();
  UiOverlay(const UiOverlay&) = delete;
  UiOverlay& operator=(const UiOverlay&) = delete;

  /// Starts a frame; after it, `wants_*` know where the pointer is. `events` came since the last frame.
  void begin_frame(double now, const std::vector<WindowEvent>& events);
  /// Lays out everything. Call once after `begin_frame`.
  [[nodiscard]] UiActions build(const UiModel& model);
  /// Draws what was laid out into the framebuffer that is bound.
  void draw();

  /// True when the pointer is over a panel, or the keys go into a text field.
  [[nodiscard]] bool wants_pointer() const;
  [[nodiscard]] bool wants_keys() const;
  /// True when another frame is needed for what the user has done.
  [[nodiscard]] bool has_input_left() const;

  /// What bars and panels leave to the picture in a framebuffer of this size, for the frame that is made next.
  [[nodiscard]] Viewport picture_area(const glm::ivec2& framebuffer);
  /// Seconds until something changes without an event, or nothing does.
  [[nodiscard]] std::optional<double> next_change() const;

  /// Does what is the interface's alone. False: the action is none of that kind.
  bool run(Action action);
  /// Its own, for those whose desktop has none.
  void show_open_dialog();
  /// Where the panels are, and how large the areas of the dock (left, right, bottom); to be kept, and taken up again.
  [[nodiscard]] std::vector<PanelMemory> panels() const;
  [[nodiscard]] std::array<double, kDockSides> areas() const;
  void arrange(const std::vector<PanelMemory>& panels, const std::array<double, kDockSides>& areas);
  /// Opens the panel of an action, or brings it to the front.
  void show_panel(Action toggle);
  /// The desktop's clipboard, as UTF-8.
  [[nodiscard]] std::string clipboard() const;
  void set_clipboard(const std::string& text);
  /// A line that goes away by itself; `is_error` lines stay longer.
  void show_notice(std::string text, bool is_error, std::string_view about = {});
  void clear_notices();
  /// What was chosen in the Open panel shows, or `problem` says why it does not: then the panel stays, for another try.
  void open_ended(const std::string& problem);
  /// Closes what is open over the picture: a menu, a list, a dialog; false: nothing is. Or what stands beside it: a
  /// panel, a notice.
  bool close_over();
  bool close_beside();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gs::app
