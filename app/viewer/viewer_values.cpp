#include "app/viewer/viewer_values.h"

#include "app/picture/volume_show.h"
#include "qnv/sampling/volume/volume_values.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

namespace gs::app {

ViewerValues::Values& ViewerValues::of(const View& view) {
  constexpr std::chrono::seconds kNow{0};
  std::erase_if(values_, [&](const auto& entry) {
    const auto& coming = entry.second.coming;
    return entry.second.of.expired() && (!coming.valid() || coming.wait_for(kNow) == std::future_status::ready);
  });
  auto found = values_.find(view.document.get());
  // Another document may have the address of a closed one.
  if (found != values_.end() && found->second.of.lock() != view.document) {
    values_.erase(found);
    found = values_.end();
  }
  if (found == values_.end()) {
    Values& values = values_[view.document.get()];
    values.of = view.document;
    values.streamed = streamed_values(*view.list);
    begin_reading(values, view);
    return values;
  }
  Values& values = found->second;
  const StepContent::Shared step = step_geometry(values, view, view.document->data);
  if (!values.coming.valid())
    if (auto newer = step ? step->as<qnv::Volume>()->values : streamed_values(*view.list);
        newer && newer != values.streamed) {
      values.streamed = std::move(newer);
      begin_reading(values, view);
    }
  (void)take(values);
  return values;
}

std::span<const double> ViewerValues::times_of(const View& view) {
  const auto geometry = first_volume_geometry(*view.list);
  const auto* const volume = geometry ? geometry->as<qnv::Volume>() : nullptr;
  return volume && volume->series ? volume->series->times() : std::span<const double>();
}

std::uint32_t ViewerValues::step_of(const View& view) {
  const auto times = times_of(view);
  if (times.empty()) return 0;
  if (view.volume.step) return std::min(*view.volume.step, static_cast<std::uint32_t>(times.size() - 1));
  const auto values = streamed_values(*view.list);
  return values ? values->step : 0;
}

bool ViewerValues::shows_step(const View& view) {
  return !view.volume.step || times_of(view).empty() || of(view).step.is_ready();
}

StepContent::Shared ViewerValues::step_geometry(Values& values, const View& view, const VoxelComponent& component) {
  if (!view.volume.step || times_of(view).empty()) return nullptr;
  qnv::ShownComponent wish{component.index, component.magnitude, component.chosen};
  wish.step.number = step_of(view);
  return values.step.get(first_volume_geometry(*view.list), wish);
}

void ViewerValues::begin_reading(Values& values, const View& view) {
  VoxelComponent data = view.document->data;
  data.found.reset();  // this thread reads the list of the document
  values.coming = std::async(
      std::launch::async, [path = view.document->world.path, data = std::move(data), streamed = values.streamed, this] {
        const WorldBudget budget = own_budget();
        budget->stop_when([this] { return stop_.load(); });  // also while a child reads
        return streamed ? VolumeGrid::take(streamed->source, &stop_, budget, VolumeGrid::kMaxVoxels, streamed.get())
                        : VolumeGrid::read(path, &stop_, budget, VolumeGrid::kMaxVoxels, data);
      });
}

bool ViewerValues::take(Values& values) {
  if (!values.coming.valid() || values.coming.wait_for(std::chrono::seconds(0)) != std::future_status::ready)
    return false;
  auto read = values.coming.get();
  if (auto* problem = std::get_if<std::string>(&read)) {
    values.problem = std::move(*problem);
  } else {
    values.grid = std::move(std::get<std::shared_ptr<const VolumeGrid>>(read));
    values.problem.clear();
  }
  return true;
}

bool ViewerValues::is_busy() const {
  return std::any_of(values_.begin(), values_.end(), [](const auto& entry) {
    const Values& values = entry.second;
    return values.coming.valid() || values.histogram.is_busy() || values.draft.is_busy() || values.surface.is_busy() ||
           values.projection.is_busy() || values.vectors.is_busy() || values.step.is_busy();
  });
}

bool ViewerValues::take() {
  bool any = false;
  for (auto& [document, values] : values_) {
    any = take(values) || any;
    any = values.histogram.take() || any;
    any = values.draft.take() || any;
    any = values.surface.take() || any;
    any = values.projection.take() || any;
    any = values.vectors.take() || any;
    any = values.step.take() || any;
  }
  return any;
}

std::shared_ptr<const VolumeHistogram> ViewerValues::histogram_of(const View& view) {
  Values& values = of(view);
  if (!values.grid) return nullptr;
  return values.histogram.get(values.grid, true,
                              [](const auto& grid, bool, Progress&) -> DerivedContent<VolumeHistogram> {
                                return std::make_shared<const VolumeHistogram>(*grid);
                              });
}

std::optional<float> ViewerValues::isovalue_of(const View& view) {
  if (view.volume.isovalue) return view.volume.isovalue;
  const auto histogram = histogram_of(view);
  std::optional<float>& isovalue = of(view).isovalue;
  if (!histogram) return isovalue;
  // Small changes of the threshold while a stream arrives do not move the surface.
  constexpr float kPart = 0.03f;
  const float threshold = histogram->threshold(), range = histogram->range().second - histogram->range().first;
  if (!isovalue || !(std::abs(threshold - *isovalue) <= kPart * range)) isovalue = threshold;
  return isovalue;
}

std::string ViewerValues::problem_of(const View& view) {
  Values& values = of(view);
  if (!values.problem.empty()) return values.problem;
  if (view.volume.surface && !values.surface.problem().empty()) return values.surface.problem();
  if (view.volume.mode != VolumeMode::vectors) return values.projection.problem();
  return view.volume.share == kUsualShare ? std::string() : values.vectors.problem();
}

VolumeContent ViewerValues::content_of(const View& view, const VolumeContent& before) {
  const VolumeDisplay& display = view.volume;
  Values& values = of(view);
  VolumeContent content;
  content.surface_color = display.surface_color;
  content.hides_vectors = view.slices.alone && (view.slices.any() || display.surface);
  content.clip = view.look.clip;
  // Vectors of a step need no grid of values.
  if (display.mode == VolumeMode::vectors && display.share == kUsualShare)
    content.vectors = step_geometry(values, view, view.document->data);
  if (!values.grid) {
    if (display.surface) content.surface = before.surface;
    return content;
  }
  if (display.surface) {
    const auto isovalue = isovalue_of(view);
    if (isovalue)
      content.surface =
          values.surface.get(values.grid, *isovalue, [](const auto& grid, float value, Progress& progress) {
            return isosurface_mesh(grid, value, own_budget(), &progress);
          });
    if (!content.surface && values.surface.problem().empty()) content.surface = before.surface;
    if (!content.surface && isovalue && values.surface.problem().empty())
      content.surface = values.draft.get(values.grid, *isovalue, [](const auto& grid, float value, Progress& progress) {
        return isosurface_mesh(grid, value, own_budget(), &progress, kMostSurfaceTriangles, draft_stride(*grid));
      });
  }
  if (content.hides_vectors) return content;
  if (display.mode != VolumeMode::vectors) {
    const ProjectionColors colors{display.mode, view.slices.window, view.slices.map};
    content.projection =
        values.projection.get(values.grid, colors, [](const auto& grid, const ProjectionColors& wish, Progress&) {
          return projection_of(*grid, wish, own_budget());
        });
    if (!content.projection && values.projection.problem().empty()) content.projection = before.projection;
  } else if (display.share != kUsualShare) {
    if (const auto geometry = first_volume_geometry(*view.list))
      content.vectors =
          values.vectors.get(values.grid, display.share, [geometry](const auto& grid, float share, Progress& progress) {
            return vectors_of_share(grid, *geometry->as<qnv::Volume>(), share, own_budget(), &progress);
          });
    if (!content.vectors && values.vectors.problem().empty()) content.vectors = before.vectors;
  }
  return content;
}

void ViewerValues::note_pointed(const View& view, const glm::dvec3& point) {
  constexpr double kSmallPart = 1.0 / 64;
  const double size = view.list->bounds.empty() ? 0.0 : glm::length(glm::dvec3(view.list->bounds.size()));
  const bool same = pointed_ && pointed_in_.lock() == view.document;
  if (same && glm::distance(*pointed_, point) < kSmallPart * size) return;
  pointed_ = point;
  pointed_in_ = view.document;
}

render::VolumeReading ViewerValues::reading_of(const View& view, bool exact, std::span<const glm::dvec3> ruler) {
  constexpr std::size_t kMostRulerPoints = 3;
  render::VolumeReading reading;
  reading.exact = exact;
  if (exact && pointed_ && pointed_in_.lock() == view.document) reading.points.push_back(*pointed_);
  const std::size_t skipped = ruler.size() - std::min(ruler.size(), kMostRulerPoints);
  reading.points.insert(reading.points.end(), ruler.rbegin(), ruler.rend() - static_cast<std::ptrdiff_t>(skipped));
  reading.values = exact || view.slices.any() || view.volume.needs_values();
  if (!view.slices.any()) return reading;
  reading.only_slices = view.slices.alone && !view.volume.surface;
  const auto& grid = of(view).grid;
  const auto world_from_node = world_from_volume(*view.list);
  if (grid && world_from_node) reading.slices = slice_planes(*grid, view.slices, *world_from_node);
  return reading;
}

const render::RenderList& ViewerValues::shown(std::size_t pane, const View& view) {
  if (!view.slices.any() && !view.volume.needs_values() && view.over.empty()) return *view.list;
  Scene& scene = scenes_[pane];
  if (scene.of.lock() != view.document) {
    scene = {};
    scene.of = view.document;
  }
  std::vector<const render::RenderList*> over;
  for (const View::Over& one : view.over)
    if (one.view) over.push_back(one.view->list.get());
  return scene.over.with(own_list(scene, view), over);
}

// Returns the render list of a view with its slices and other content of its volume.
const render::RenderList& ViewerValues::own_list(Scene& scene, const View& view) {
  if (!view.slices.any() && !view.volume.needs_values()) return *view.list;
  const render::RenderList& list = scene.slices.with_slices(*view.list, of(view).grid, view.slices);
  const auto world_from_node = world_from_volume(*view.list);
  if (!view.volume.needs_values() || !world_from_node) return list;
  scene.content = content_of(view, scene.content);
  return scene.volume.with_content(list, *world_from_node, scene.content);
}

}  // namespace gs::app
