#pragma once

#include "app/session/viewports/view.h"
#include "app/view/derived/derived_value.h"
#include "app/view/derived/overlay_scene.h"
#include "app/view/derived/step_content.h"
#include "app/view/derived/volume_histogram.h"
#include "app/view/derived/volume_scene.h"
#include "app/view/values/slice_scene.h"
#include "base/noncopyable.h"
#include "render/scene/splat_style.h"

#include <atomic>
#include <cstddef>
#include <future>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <variant>

namespace gs::app {

/// Values of the volumes that viewports show, from files and streams, and the content that comes from them. Other
/// threads read and compute. Main thread.
class ViewerValues : NonCopyable {
 public:
  /// Values of one document.
  struct Values {
    std::future<std::variant<std::shared_ptr<const VolumeGrid>, std::string>> coming;
    std::shared_ptr<const VolumeGrid> grid;
    std::shared_ptr<const qnv::VolumeValues> streamed;  // of the stream, or null for a file
    std::string problem;
    std::weak_ptr<Document> of;
    std::optional<float> isovalue;  // threshold between two classes of values
    DerivedValue<bool, VolumeHistogram> histogram;
    DerivedValue<float, vrml::Mesh> draft, surface;  // isosurface: its first version is a draft
    DerivedValue<ProjectionColors, VolumeProjection> projection;
    DerivedValue<float, qnv::Geometry> vectors;
    StepContent step;  // of a time series
  };

  /// `component` is that of volume files.
  ViewerValues() = default;
  ~ViewerValues() { stop_ = true; }

  /// Returns the values of a view's document, and begins to read them if necessary. The values of a stream become
  /// better while it arrives.
  Values& of(const View& view);
  /// Returns the histogram of the values; null until it is made.
  std::shared_ptr<const VolumeHistogram> histogram_of(const View& view);
  /// Returns the value of a view's isosurface: that of the view, else a threshold; nullopt until it is known.
  std::optional<float> isovalue_of(const View& view);
  /// Returns the error message of the content that the view wishes; empty if there is none.
  std::string problem_of(const View& view);

  /// Returns the values that a view shows besides the vectors of its volume. `exact` means that single values are
  /// read. Those under the pointer and at the last points of the ruler come first.
  render::VolumeReading reading_of(const View& view, bool exact, std::span<const glm::dvec3> ruler = {});
  /// Notes the place of the value under the pointer. Small movements count as none, because each place is a new view.
  void note_pointed(const View& view, const glm::dvec3& point);
  /// Returns the render list to draw in viewport `pane`: the list of the view, with its slices and other content.
  const render::RenderList& shown(std::size_t pane, const View& view);

  /// Returns the number of steps of the time series that a view shows, by their times; empty for other contents.
  [[nodiscard]] static std::span<const double> times_of(const View& view);
  /// Returns the step that a view wishes to show.
  [[nodiscard]] static std::uint32_t step_of(const View& view);
  /// Returns true if the view shows the step that it wishes.
  [[nodiscard]] bool shows_step(const View& view);

  /// Returns true while a thread reads values or computes content. take() takes them, and returns true if there were
  /// any.
  [[nodiscard]] bool is_busy() const;
  bool take();

 private:
  /// Scene of a viewport. While new content is computed, the viewport shows the previous content.
  struct Scene {
    std::weak_ptr<Document> of;
    VolumeContent content;
    SliceScene slices;
    VolumeScene volume;
    OverlayScene over;
  };
  bool take(Values& values);
  const render::RenderList& own_list(Scene& scene, const View& view);
  void begin_reading(Values& values, const View& view);
  /// Returns the volume of the step that the view wishes; null if it is that of the document.
  static StepContent::Shared step_geometry(Values& values, const View& view, const VoxelComponent& component);
  VolumeContent content_of(const View& view, const VolumeContent& before);

  std::atomic<bool> stop_{false};  // true stops the threads that read values
  std::map<const Document*, Values> values_;
  std::weak_ptr<Document> pointed_in_;  // volume with the pointer
  std::optional<glm::dvec3> pointed_;   // place of its value, in world space
  std::map<std::size_t, Scene> scenes_;  // by viewport; kMaxViewports is used for saved pictures and values
};

}  // namespace gs::app
