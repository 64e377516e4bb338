#pragma once

#include "app/interface/ui_overlay.h"
#include "app/session/world_reader.h"
#include "app/view/actions.h"
#include "app/view/picking.h"
#include "app/view/viewports.h"
#include "app/viewer/folder_questions.h"
#include "app/viewer/links.h"
#include "app/viewer/viewer.h"
#include "app/viewer/viewer_panes.h"
#include "app/window/window.h"
#include "render/draw/renderer.h"

#include <array>
#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gs::app {

/// Window, viewports, renderer and user interface, tied together once a frame. Main thread only.
/// viewer.cpp: the loop and the files; viewer_input.cpp: what the user does; viewer_picture.cpp: what he sees.
class Viewer {
 public:
  Viewer(const ViewerOptions& options, const LoadOptions& load, std::unique_ptr<Window> window,
         std::unique_ptr<render::Renderer> renderer);
  ~Viewer();
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;

  void run();

 private:
  /// A file that is being read.
  struct Reader {
    DocumentList::Reading reading;
    std::shared_ptr<WorldReader> reader;
    LoadingState state;
  };

  void wait_for_something();
  void wait_idle();
  void frame(double now, const std::vector<WindowEvent>& events);
  void move_views(float seconds);
  [[nodiscard]] std::vector<Document*> living() const;
  bool let_live();
  [[nodiscard]] std::optional<double> next_life() const;
  void measure(double started, double now, bool continuous);

  void load_next();
  bool take_news();
  bool take_document(const Reader& from, WorldReader::News& news);
  bool take_arrivals(Document& document, const std::string& path, WorldReader::News news);
  void prioritize();
  bool feed_streams();
  void ask_for_streams();
  void show_failed(std::uint64_t reading, const std::string& path, const vrml::Diagnostics& diagnostics);
  void show_loaded();
  void show_title();

  void handle(const WindowEvent& event);
  void handle_pointer(const WindowEvent& event);
  bool handle_key(const WindowEvent& event);
  bool run(Action action);
  bool run_in(View& view, Action action);
  void point_at(std::size_t pane, const InputTracker::Gesture& gesture);
  [[nodiscard]] static PickOptions pick_options(const View& view, const glm::vec2& size);
  bool point_world(std::size_t pane, bool down);
  bool point_with(const WindowEvent& event, std::size_t pane);
  void point_again();
  void leave_world();
  void open_links(std::size_t pane);
  void enter_by_link(Pane& pane);
  void follow_link(std::size_t pane, const Link& link);
  [[nodiscard]] std::optional<float> distance_under(const View& view, const Ray& ray, const glm::vec2& size);

  void choose_mode(NavigationMode mode);
  void bind_viewpoint(std::size_t index);
  void step_viewpoint(int direction);
  void fit();
  void reset();
  void change_speed(float factor);
  void open_files(const std::vector<std::string>& paths);
  void select_file(std::size_t index);
  void choose_layout(ViewportLayout layout);
  void activate(std::size_t pane);
  void toggle_link();
  void close_or_cancel();
  void answer_question(bool allow);

  /// Of the active viewport; null: nothing is shown there.
  [[nodiscard]] View* view() { return panes_.at(panes_.active()).view(); }
  /// What the bars leave of the window.
  [[nodiscard]] Viewport area() const;
  /// Of the viewports in sight, in the order of `Panes::visible`.
  [[nodiscard]] std::vector<Viewport> places() const { return arrange(panes_.layout(), area()); }
  [[nodiscard]] Viewport place_of(std::size_t pane) const;
  [[nodiscard]] bool moving() const;
  [[nodiscard]] bool loading() const;
  [[nodiscard]] UiModel model();
  void describe_viewports(UiModel& model) const;
  [[nodiscard]] std::string progress_of(const std::string& path) const;
  void apply(const UiActions& actions);
  void draw_viewports();
  void draw_viewport(std::size_t pane, render::DrawOptions draw);

  const ViewerOptions& options_;
  LoadOptions load_;  // with what the user has allowed since
  std::unique_ptr<Window> window_;
  std::unique_ptr<render::Renderer> renderer_;
  UiOverlay ui_;
  Panes panes_;
  PointerRouter router_;
  Picker picker_;
  std::optional<std::size_t> pointed_pane_;     // in whose world the pointing device is
  glm::vec2 pointer_{0};                        // framebuffer pixels
  bool pointer_moved_ = false;                  // since sensors heard of it
  bool sensor_has_pointer_ = false;             // until the button is released
  std::map<std::string, std::string> entries_;  // Viewpoints that links lead to, by file
  Refinement refinement_;
  FolderQuestions questions_;
  bool linked_ = false;
  std::size_t leader_ = 0;  // the viewport that the user moved last
  std::string title_;
  double next_priorities_ = 0;
  double life_due_ = 0;  // seconds of the window's clock: when time goes on in the worlds, if it does
  double last_frame_ = 0, frame_ms_ = 0, frames_a_second_ = 0;
  int frames_wanted_;
  bool was_continuous_ = false;
  std::vector<Reader> readers_;
  std::vector<std::shared_ptr<WorldReader>> retired_;  // whom nobody waits for; they end as soon as they can
};

}  // namespace gs::app
