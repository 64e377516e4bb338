#pragma once

#include "app/interface/dock/dock.h"
#include "app/interface/model/ui_model.h"
#include "app/settings/app_state.h"
#include "app/view/actions.h"
#include "app/view/viewports.h"
#include "app/window/window_event.h"
#include "base/noncopyable.h"

#include <glm/vec2.hpp>

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// Interface between Dear ImGui and the platform: a window, or a null implementation in tests.
class InterfaceBackend : NonCopyable {
 public:
  virtual ~InterfaceBackend() = default;

  /// Initialises the backend. Called once, when the Dear ImGui context is current.
  virtual void begin() = 0;
  /// Passes the size and time of the new frame to Dear ImGui.
  virtual void begin_frame() = 0;
  /// Uploads a rebuilt font atlas.
  virtual void fonts_changed() = 0;
  /// Draws the layout into the bound framebuffer.
  virtual void draw() = 0;
};

/// User interface around and over the picture: bars, panels, dialogs. Use on the window's thread with its OpenGL
/// context current. Writes no files.
class UiOverlay : NonCopyable {
 public:
  /// `scale` is the scale of the screen; 1 is normal.
  UiOverlay(std::unique_ptr<InterfaceBackend> backend, float scale, const UserSettings& settings = {});
  ~UiOverlay();

  /// Starts a frame with the events since the last frame. Afterwards, wants_pointer() and wants_keys() hold for these
  /// events.
  void begin_frame(double now, const std::vector<WindowEvent>& events);
  /// Lays out the interface and returns the user's requests. Call once after begin_frame().
  [[nodiscard]] UiActions build(const UiModel& model);
  /// Draws the layout into the bound framebuffer.
  void draw();

  /// Reports whether pointer events belong to the interface, not to the picture. wants_keys() reports whether a text
  /// field has the keyboard.
  [[nodiscard]] bool wants_pointer() const;
  [[nodiscard]] bool wants_keys() const;
  /// Reports whether events are pending that need another frame.
  [[nodiscard]] bool has_input_left() const;

  /// Returns the area that the bars and panels leave for the picture in the next frame, in framebuffer pixels.
  [[nodiscard]] Viewport picture_area(const glm::ivec2& framebuffer);
  /// Returns the seconds until the interface changes without an event; nullopt if it will not.
  [[nodiscard]] std::optional<double> next_change() const;

  /// Runs an action that affects only the interface. Returns false, without effect, for other actions.
  bool run(Action action);
  /// Opens the built-in file dialog, for desktops that have none.
  void show_open_dialog();
  /// Opens the built-in dialog for saving, with a proposed path. `formats` lists the possible extensions.
  void show_save_dialog(const std::string& path, const std::string& formats);
  /// Returns the positions of the panels. arrange() restores them, and the sizes of the dock areas in the order left,
  /// right, bottom.
  [[nodiscard]] std::vector<PanelMemory> panels() const;
  [[nodiscard]] std::array<double, kDockSides> areas() const;
  void arrange(const std::vector<PanelMemory>& panels, const std::array<double, kDockSides>& areas);
  /// Opens the panel that an action toggles, or brings it to the front.
  void show_panel(Action toggle);
  /// Returns the text on the clipboard of the desktop, in UTF-8.
  [[nodiscard]] std::string clipboard() const;
  void set_clipboard(const std::string& text);
  /// Shows a notice (toast) for a few seconds; errors stay longer.
  void show_notice(std::string text, bool is_error, std::string_view about = {});
  void clear_notices();
  /// Reports whether the file that the Open dialog is waiting for could be opened. Closes the dialog if `problem` is
  /// empty; otherwise the dialog stays open and shows the message.
  void open_ended(const std::string& problem);
  /// Closes the topmost overlay: a menu, list or dialog. close_beside() closes a list of a panel, or a notice. Both
  /// return false if there is nothing to close.
  bool close_over();
  bool close_beside();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gs::app
