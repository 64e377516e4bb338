#include "app/session/viewports/view.h"

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <utility>

// Views of documents that were read again.
namespace gs::app {
namespace {

// Returns a view of a document with the user's choices for the previous view.
View with_choices_of(const View& before, std::shared_ptr<Document> document, const glm::vec2& viewport) {
  View view = view_of(std::move(document), viewport, {}, nullptr, before.style);
  view.history = before.history;
  view.look = before.look;
  view.slices = before.slices;
  view.volume = before.volume;
  if (!before.document->is_preview) view.color_bar = before.color_bar;
  view.headlight = before.headlight;
  view.budget = before.budget;
  view.over = before.over;
  return view;
}

// Returns true if two views of a file show different datasets, channels or components.
bool shows_other_data(const View& one, const View& other) {
  const VoxelComponent &a = one.document->data, &b = other.document->data;
  return a.dataset != b.dataset || a.channel != b.channel || a.index != b.index || a.magnitude != b.magnitude ||
         a.flow != b.flow;
}

// Returns true if the colours of a view's surfaces stand for values.
bool has_color_key(const View& view) { return view.document->world.color_key.has_value(); }

// Returns true if two boxes fill about the same space.
bool bounds_agree(const WideBox& one, const WideBox& other) {
  if (one.empty() || other.empty()) return false;
  const double a = glm::length(glm::dvec3(one.upper - one.lower)),
               b = glm::length(glm::dvec3(other.upper - other.lower));
  const double apart = glm::length((one.lower + one.upper - other.lower - other.upper) * 0.5);
  constexpr double kRatio = 2, kApart = 0.25;
  return a <= b * kRatio && b <= a * kRatio && apart <= kApart * std::max(a, b);
}

}  // namespace

View renewed(const View& before, std::shared_ptr<Document> document, const glm::vec2& viewport) {
  View view = with_choices_of(before, std::move(document), viewport);
  if (shows_other_data(before, view)) {
    // Values of other data do not suit.
    view.slices.window.reset();
    view.volume.isovalue.reset();
    view.volume.step.reset();
    view.look.transfer = {};
    view.color_bar = view.color_bar || (has_color_key(view) && !has_color_key(before));
    if (!bounds_agree(before.list->bounds, view.list->bounds)) return view;
  }
  // Keep the pose of the viewer, because the user wants to compare the new file with the old one.
  if (view.rules.allows(before.navigation.mode)) {
    view.navigation.pose = before.navigation.pose;
    view.navigation.mode = before.navigation.mode;
  }
  return view;
}

View grown(const View& before, std::shared_ptr<Document> document, const glm::vec2& viewport) {
  if (!at_home(before)) return renewed(before, std::move(document), viewport);
  View view = with_choices_of(before, std::move(document), viewport);
  if (view.document == before.document) view.left = before.left;
  if (before.viewpoint && *before.viewpoint < view.list->viewpoints.size() && *before.viewpoint != view.viewpoint) {
    view.viewpoint = before.viewpoint;
    view.world_from_viewpoint = before.world_from_viewpoint;
    view.home = before.home;
    view.navigation.pose = before.home;
  }
  return view;
}

}  // namespace gs::app
