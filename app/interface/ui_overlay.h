#pragma once

#include "app/interface/base/ui_model.h"
#include "app/interface/dock/dock.h"
#include "app/settings/app_state.h"
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

/// Platform of the interface: a window, or a null implementation in tests.
class InterfaceBackend {
 public:
  InterfaceBackend() = default;
  InterfaceBackend(const InterfaceBackend&) = delete;
  InterfaceBackend& operator=(const InterfaceBackend&) = delete;
  virtual ~InterfaceBackend() = default;

  /// Initialises the backend; called once in the Dear ImGui context.
  virtual void begin() = 0;
  /// Sets size and time of the new frame in Dear ImGui.
  virtual void begin_frame() = 0;
  /// Handles a rebuilt font atlas.
  virtual void fonts_changed() = 0;
  /// Draws the layout into the bound framebuffer.
  virtual void draw() = 0;
};

/// Bars and panels around the picture. Use on the window's thread with its context current. Writes no files.
class UiOverlay {
 public:
  /// `scale` is the screen scale; 1 is normal.
  UiOverlay(std::unique_ptr<InterfaceBackend> backend, float scale, const UserSettings& settings = {});
  ~UiOverlay();
  UiOverlay(const UiOverlay&) = delete;
  UiOverlay& operator=(const UiOverlay&) = delete;

  /// Starts a frame with the events since the last one. Afterwards, `wants_*` reflect the pointer position.
  void begin_frame(double now, const std::vector<WindowEvent>& events);
  /// Lays out the interface. Call once after `begin_frame`.
  [[nodiscard]] UiActions build(const UiModel& model);
  /// Draws the layout into the bound framebuffer.
  void draw();

  /// Report whether the pointer is over a panel, or a text field has the keyboard focus.
  [[nodiscard]] bool wants_pointer() const;
  [[nodiscard]] bool wants_keys() const;
  /// Reports whether another frame is needed to process input.
  [[nodiscard]] bool has_input_left() const;

  /// Returns the area left for the picture in a framebuffer of this size, for the next frame.
  [[nodiscard]] Viewport picture_area(const glm::ivec2& framebuffer);
  /// Returns the seconds until the interface changes without an event; nullopt if it will not.
  [[nodiscard]] std::optional<double> next_change() const;

  /// Runs an action that only affects the interface. Returns false for other actions.
  bool run(Action action);
  /// Shows the built-in file dialog, for desktops without one.
  void show_open_dialog();
  /// Panel positions and dock area sizes (left, right, bottom), for saving and restoring.
  [[nodiscard]] std::vector<PanelMemory> panels() const;
  [[nodiscard]] std::array<double, kDockSides> areas() const;
  void arrange(const std::vector<PanelMemory>& panels, const std::array<double, kDockSides>& areas);
  /// Opens the panel of an action, or brings it to the front.
  void show_panel(Action toggle);
  /// Clipboard of the desktop, as UTF-8.
  [[nodiscard]] std::string clipboard() const;
  void set_clipboard(const std::string& text);
  /// Shows a notice that disappears after a while; errors stay longer.
  void show_notice(std::string text, bool is_error, std::string_view about = {});
  void clear_notices();
  /// Ends the wait of the Open panel. An empty `problem` closes the panel; otherwise it stays open and shows the
  /// message.
  void open_ended(const std::string& problem);
  /// close_over() closes the topmost overlay: a menu, list or dialog. close_beside() closes a panel or notice beside
  /// the picture. Both return false if there is none.
  bool close_over();
  bool close_beside();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gs::app
