#pragma once

#include "app/interface/model/ui_model.h"
#include "app/picture/animation.h"
#include "app/picture/frame_writer.h"
#include "app/picture/paint.h"
#include "app/session/session.h"
#include "app/view/ground_grid.h"
#include "app/view/picking.h"
#include "app/view/values/ruler.h"
#include "app/view/values/slice_drag.h"
#include "app/viewer/viewer.h"
#include "app/viewer/viewer_values.h"
#include "base/noncopyable.h"

#include <atomic>
#include <chrono>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace gs::app {

/// Tools of the active viewport: measuring, values and slices of volumes, saving pictures. Main thread.
class ViewerTools : NonCopyable {
 public:
  ViewerTools(const ViewerOptions& options, render::Renderer& renderer);

  /// Handles a click or a movement of the pointer. Returns true if the session must not receive the event.
  bool take(const SessionInput::Event& event, const View* seen, const Viewport& place);
  /// Returns the render list to draw in viewport `pane`: the list of the view, with its slices and other content.
  [[nodiscard]] const render::RenderList& shown(std::size_t pane, const View& view) {
    return values_.shown(pane, view);
  }
  /// Returns the render list of the ground grid of a view; null if the grid is off.
  [[nodiscard]] std::shared_ptr<const render::RenderList> guides(const View& view);
  void describe(UiTools& tools, const View* seen, const Viewport& place);
  /// Function that shows a notice to the user.
  using Tell = std::function<void(std::string text, bool is_problem)>;
  void apply(const UiToolActions& actions, View* seen, const Viewport& place, const Tell& tell);
  void take_picture(const View& seen, const Viewport& place, const Tell& tell);
  /// Copies the picture of a viewport to the clipboard, in the size of the viewport.
  void copy_picture(const View& seen, const Viewport& place, const Tell& tell);
  /// Adds the present camera to the tour of the view's file.
  void add_to_tour(const View& seen, const Tell& tell);
  void toggle_ruler();
  /// Ends measuring (Esc). Returns false if the ruler is not in use.
  bool close();
  /// Returns true while a thread reads values of a volume, or computes content from them. take_values() takes results,
  /// and returns true if there were any.
  [[nodiscard]] bool reads_values() const { return values_.is_busy() || steps_.playing; }
  bool take_values();
  /// Returns the values that a view shows besides the vectors of its volume.
  [[nodiscard]] render::VolumeReading reading_of(const View& view) {
    const bool ruled = measuring_ && ruled_.lock() == view.document;
    return values_.reading_of(view, wants_value_, ruled ? std::span(ruler_.points()) : std::span<const glm::dvec3>());
  }
  /// Draws and saves the next picture of an animation. Returns true if further frames are needed.
  bool go_on(const View* seen, const Tell& tell);

 private:
  struct Export {
    std::unique_ptr<FrameWriter> writer;
    std::string path;
    std::vector<AnimationStep> steps;
    std::size_t next = 0;
    std::weak_ptr<Document> of;
    render::Camera camera;
    glm::dvec3 center{0}, up{0, 1, 0};
    std::vector<render::Camera> tour;  // cameras to visit; empty means a turntable
    glm::ivec2 size{0};
    PictureRequest request;
  };
  /// Playback of the steps of a time series in one document.
  struct StepPlayback {
    std::weak_ptr<Document> of;
    bool playing = false;
    double rate = 10;  // steps per second
    std::chrono::steady_clock::time_point next{};
  };
  void show_as_wished(View& seen, const Tell& tell);
  void play_steps(const UiToolActions& actions, View& seen);
  [[nodiscard]] std::optional<SliceGrip> slice_under_pointer(const View& seen, const Viewport& place);
  void describe_volume(UiTools& tools, const View& seen, const qnv::Description& volume);
  void describe_slices(UiTools& tools, const View& seen, const Viewport& place);
  [[nodiscard]] static std::optional<ColorBar> bar_of(const View& seen);
  void probe(const View& seen, const Viewport& place);
  void probe_projection(const View& seen, const Ray& ray, const qnv::Description& volume);
  [[nodiscard]] PictureScene scene_of(std::size_t slice_scene, const View& seen, const glm::ivec2& size,
                                      const PictureRequest& request);
  void start_animation(const View& seen, const Viewport& place, bool of_tour, const Tell& tell);
  void save_transfer(const std::string& path, const Transfer& shown, const qnv::Description& volume, const Tell& tell);
  [[nodiscard]] std::vector<render::Camera>& tour_of(const View& seen);
  [[nodiscard]] glm::ivec2 size_of(const Viewport& place) const;

  const ViewerOptions& options_;
  render::Renderer& renderer_;
  Picker picker_;
  Ruler ruler_;
  bool measuring_ = false, wants_value_ = false, wants_histogram_ = false, probe_due_ = false;
  glm::vec2 pressed_{0}, pointer_{0};
  std::string value_;
  std::optional<SliceGrip> grip_;  // grip on the slice that the user is dragging
  GroundGrids grids_;
  std::weak_ptr<Document> ruled_;  // document in which the points of the ruler are
  ViewerValues values_;
  struct Wished {
    std::weak_ptr<Document> of;
    bool all = false;  // all options are applied; false while slices wait for the dimensions of the volume
  };
  std::vector<Wished> wished_;  // documents to which the options of the command line were applied
  PictureWish wish_;
  std::string folder_;
  std::string replaceable_transfer_;  // file that was read, written or confirmed here, and may be overwritten
  std::weak_ptr<Document> asked_;     // document to which `asked_is_volume_` refers
  bool asked_is_volume_ = false;
  StepPlayback steps_;
  std::optional<Export> export_;
  std::vector<render::Camera> tour_;
  std::weak_ptr<Document> toured_;  // document to which `tour_` belongs
};

}  // namespace gs::app
