#pragma once

#include "app/session/session_log.h"
#include "app/view/actions.h"
#include "app/view/navigation.h"
#include "app/view/viewports.h"
#include "app/window/window.h"
#include "qnv/base/cloud.h"
#include "render/draw/renderer.h"
#include "render/scene/cloud_look.h"
#include "vrml/mesh/mesh.h"

#include <glm/vec2.hpp>

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gs::app {

/// A viewport in sight.
struct UiViewport {
  Viewport place;
  std::string label;    // of the file it shows; empty: none
  std::string loading;  // label of what is being read for it, or empty
  bool active = false;
};

/// Whether a world may read a folder that is not its own.
struct UiQuestion {
  std::string world;  // label
  std::string folder, reference;
};

/// What the user interface shows. Made anew for each frame; pointers need to last only that long.
struct UiModel {
  std::vector<std::string> files;   // labels
  std::optional<std::size_t> file;  // of these, the chosen one

  std::vector<UiViewport> viewports;
  ViewportLayout layout = ViewportLayout::one;
  bool linked = false;  // all viewports move as one
  std::optional<UiQuestion> question;

  // From here on: the active viewport.
  bool has_world = false;

  std::vector<std::string> viewpoints;   // labels
  std::optional<std::size_t> viewpoint;  // of these, the bound one
  NavigationMode mode = NavigationMode::none;
  NavigationRules rules;
  float speed = 1;  // metres a second
  bool headlight = false;
  bool has_sounds = false, muted = false;

  // Its clouds.
  render::CloudLook look;
  bool has_surface_clouds = false, has_volumes = false;
  vrml::Bounds bounds;                                     // world space, of everything
  std::vector<std::shared_ptr<const qnv::Cloud>> volumes;  // of which the panel takes a summary, once
  glm::vec3 looking{0, 0, -1};                             // world space, along the middle of the view

  render::FrameStatistics statistics;
  double frame_ms = 0, frames_a_second = 0;
  std::string gl_renderer;
  const SessionLog* log = nullptr;

  bool over_sensor = false;                // the pointer is over something in the world that can be clicked or dragged
  std::string link;                        // what it leads to; may be empty
  std::optional<glm::vec2> travel_anchor;  // framebuffer pixels
  glm::vec2 pointer{0};
};

/// What the user asked for with it.
struct UiActions {
  std::optional<std::string> open;
  std::optional<std::size_t> file, viewpoint;
  std::optional<NavigationMode> mode;
  std::optional<Action> run;
  std::optional<ViewportLayout> layout;
  std::optional<bool> allow_folder;           // the answer to UiModel::question
  std::optional<std::size_t> cancel_loading;  // of UiModel::viewports
  std::optional<render::CloudLook> look;      // instead of the model's
};

/// The bars and panels over the picture. Belongs to the thread of the window, whose context is current.
/// Writes no files.
class UiOverlay {
 public:
  /// Installs itself behind the window's own event callbacks. `scale`: 1 on a common screen.
  UiOverlay(GLFWwindow* window, float scale);
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

  /// Framebuffer pixels that the bars cover at the upper and lower edge.
  [[nodiscard]] int top_height() const;
  [[nodiscard]] int bottom_height() const;
  /// Seconds until something changes without an event, or nothing does.
  [[nodiscard]] std::optional<double> next_change() const;

  void show_open_panel();
  void toggle_help();
  void toggle_statistics();
  void toggle_log();
  void toggle_clouds();
  void show_log();
  /// A line that goes away by itself; `is_error` lines stay longer.
  void show_notice(std::string text, bool is_error);
  void clear_notices();
  /// What was chosen in the Open panel shows, or `problem` says why it does not: then the panel stays, for another try.
  void open_ended(const std::string& problem);
  /// Closes the topmost panel or notice. False when there was none.
  bool close_one();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gs::app
