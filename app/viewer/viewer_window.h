#pragma once

#include "app/desktop/hand_over.h"
#include "app/view/panes/picture_ledger.h"
#include "app/view/picture_detail.h"
#include "app/viewer/frame_rate.h"
#include "app/viewer/start_page.h"
#include "app/viewer/viewer.h"
#include "app/viewer/viewer_controller.h"
#include "app/viewer/viewer_tools.h"
#include "app/window/window.h"
#include "base/noncopyable.h"
#include "render/draw/renderer.h"

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gs::app {

/// Window of a session. It passes the user's input to the session, draws the pictures, and draws the interface over
/// them. Main thread.
///
/// The main loop is in viewer.cpp, the drawing in viewer_picture.cpp. The parts that need no window are in
/// viewer_controller.h.
class Viewer final : public WindowOperations, NonCopyable {
 public:
  Viewer(const ViewerOptions& options, const LoadOptions& load, std::unique_ptr<Window> window,
         std::unique_ptr<render::Renderer> renderer);
  /// Opens the sockets for clients. Returns the error, or nullopt.
  [[nodiscard]] std::optional<std::string> start_control();
  ~Viewer() override = default;

  void run();
  /// Shows the last pictures of the worlds and a notice while a step waits for Scripts. The worlds may be half changed,
  /// so nothing else is drawn.
  void draw_waiting();

 private:
  void toggle_full_screen() override { window_->toggle_full_screen(); }
  void close() override { window_->close(); }

  [[nodiscard]] bool ends();
  void wait_for_something();
  void wait_idle();
  void present(double started);
  void measure(double started, double now, bool in_motion);
  void tell(const Frame& frame);
  void show_title();
  void take_handed_over();
  [[nodiscard]] std::size_t budget() const;

  // Overrides of WindowOperations that need the renderer.
  bool run_tool(Action action) override;
  bool take(const SessionInput::Event& event) override;
  void describe_tools(UiTools& tools) override;
  void apply_tools(const UiToolActions& actions) override;
  /// Returns the rectangle of the active viewport in framebuffer pixels.
  [[nodiscard]] Viewport active_place() const;
  [[nodiscard]] ViewerTools::Tell teller();

  void keep_thumbnail(bool rests);
  void draw_viewports();
  void draw_viewport(const Frame::Picture& picture, render::DrawOptions draw);
  void draw_nothing(const Frame::Picture& picture, render::DrawOptions draw);
  [[nodiscard]] bool awaits_finer() const;
  [[nodiscard]] bool wants_finer() const;

  const ViewerOptions& options_;
  std::unique_ptr<Window> window_;
  std::unique_ptr<render::Renderer> renderer_;
  ViewerController controller_;
  UiOverlay& ui_;                            // owned by controller_
  Session& session_;                         // owned by controller_
  std::unique_ptr<ControlService> control_;  // null if no client can control the program
  std::unique_ptr<HandOver> hand_over_;      // null if other processes cannot send files to this window
  Frame frame_;                              // result of the last step
  ViewerTools tools_;
  StartPage start_page_;
  PictureLedger pictures_;
  std::array<PictureDetail, kMaxViewports> details_;
  std::array<unsigned, kMaxViewports> rests_{};  // consecutive pictures at rest, by viewport
  LoadingPace pace_;
  std::string title_;
  PictureMeasures measures_;
  FrameRate rate_;
  int frames_wanted_;
  bool was_in_motion_ = false, was_loading_ = false;
  UiModel model_;                        // interface of the last frame
  std::optional<double> step_began_;     // time; while a step runs
  double waiting_drawn_ = 0;             // time of the last draw_waiting()
  bool interface_open_ = false;          // ui_.begin_frame() was called in this turn of the main loop
  std::vector<UiActions> late_actions_;  // actions of the user in draw_waiting(), for the end of the step
  bool interface_first_ = false;         // draw the interface at once, without waiting for a new picture of the worlds
  double picture_seconds_ = 0;           // seconds; duration of the last picture
  /// Picture that the current frame drew, for PictureDetail::note().
  struct DrawnPicture {
    std::size_t pane, level;
    bool given_up;
    std::size_t gaussians;
    double seconds;  // time of drawing
  };
  std::vector<DrawnPicture> drawn_;  // pictures of the current frame
};

}  // namespace gs::app
