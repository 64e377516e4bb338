#include "app/viewer/viewer_view.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace gs::app {
namespace {

constexpr std::size_t kManyItems = 2000;

bool usable(const vrml::Bounds& bounds) {
  const float size = bounds.empty() ? 0.0f : glm::length(bounds.size());
  return size > 0 && std::isfinite(size);
}

}  // namespace

View view_of(std::shared_ptr<Document> document, const glm::vec2& viewport, std::string_view viewpoint, bool* found) {
  View view;
  view.list = document->list;
  view.collected_for = document->collected_for;
  const render::RenderList& list = *view.list;
  view.rules = document->has_navigation_info ? navigation_rules(list.navigation)
                                             : default_navigation_rules(list.bounds, !list.viewpoints.empty());
  view.headlight = list.navigation.headlight;
  const auto named = viewpoint.empty() ? std::nullopt : find_viewpoint(list.viewpoints, viewpoint);
  view.viewpoint = named ? named : list.viewpoints.empty() ? std::nullopt : std::optional<std::size_t>(0);
  if (view.viewpoint) {
    const render::ViewpointState& bound = list.viewpoints[*view.viewpoint];
    view.home = pose_of(bound.world_from_camera, bound.field_of_view);
  } else {
    view.home = first_pose(list.bounds, viewport);
  }
  view.home_size = viewport;
  view.navigation = start_navigation(view.rules, list.bounds, view.home);
  view.document = std::move(document);
  if (found) *found = viewpoint.empty() || named.has_value();
  return view;
}

View renewed(const View& before, std::shared_ptr<Document> document, const glm::vec2& viewport) {
  View view = view_of(std::move(document), viewport, {});
  view.look = before.look;
  view.headlight = before.headlight;
  // Who reads a file again has changed something and wants to see it, from where he is.
  if (view.rules.allows(before.navigation.mode)) {
    view.navigation.pose = before.navigation.pose;
    view.navigation.mode = before.navigation.mode;
  }
  return view;
}

View grown(const View& before, std::shared_ptr<Document> document, const glm::vec2& viewport) {
  const Pose& pose = before.navigation.pose;
  const bool unmoved = pose.position == before.home.position && pose.orientation == before.home.orientation &&
                       !before.navigation.moving();
  if (!unmoved) return renewed(before, std::move(document), viewport);
  View view = view_of(std::move(document), viewport, {});
  view.look = before.look;
  view.headlight = before.headlight;
  if (before.viewpoint && *before.viewpoint < view.list->viewpoints.size() && *before.viewpoint != view.viewpoint) {
    view.viewpoint = before.viewpoint;
    view.home = before.home;
    view.navigation.pose = before.home;
  }
  return view;
}

void fit_home(View& view, const glm::vec2& viewport) {
  if (view.viewpoint || !view.list || view.home_size == viewport) return;
  const Pose& pose = view.navigation.pose;
  const bool unmoved = pose.position == view.home.position && pose.orientation == view.home.orientation;
  view.home = first_pose(view.list->bounds, viewport);
  view.home_size = viewport;
  if (unmoved && !view.navigation.moving()) view.navigation.pose = view.home;
}

bool follow_viewer(View& view) {
  if (!view.document || !view.document->viewer_dependent || !view.document->world.scene) return false;
  Document& document = *view.document;
  const glm::vec3 viewer = view.navigation.pose.position;
  // Large worlds are gathered again only where it is likely to show.
  const float tolerance = view.list->items.size() > kManyItems ? view.navigation.scene_size * 0.002f : 0.0f;
  if (!(glm::distance(viewer, view.collected_for) > tolerance)) return false;
  view.collected_for = viewer;
  view.list = std::make_shared<const render::RenderList>(
      render::collect(*document.world.scene, document.world.images, document.meshes, viewer, document.world.clouds));
  if (view.viewpoint && *view.viewpoint >= view.list->viewpoints.size()) view.viewpoint.reset();
  return true;
}

Pose linked_pose(const Pose& pose, const vrml::Bounds& from, const vrml::Bounds& to) {
  if (!usable(from) || !usable(to) || (from.lower == to.lower && from.upper == to.upper)) return pose;
  const float scale = glm::length(to.size()) / glm::length(from.size());
  Pose result = pose;
  result.position = to.center() + (pose.position - from.center()) * scale;
  const float reach = std::max({std::abs(result.position.x), std::abs(result.position.y), std::abs(result.position.z)});
  return reach <= kFarthest ? result : pose;
}

void link_view(View& view, const View& leader) {
  if (!view.document || !leader.document || view.navigation.mode == NavigationMode::none) return;
  // Of the documents: what a view has gathered for itself may differ from place to place.
  const vrml::Bounds &from = leader.document->list->bounds, &to = view.document->list->bounds;
  view.navigation = with_mode(view.navigation, view.navigation.mode);
  view.navigation.transition.reset();
  view.navigation.pose = linked_pose(leader.navigation.pose, from, to);
  Pose center;  // what EXAMINE turns about lies in the same place, too
  center.position = leader.navigation.center;
  view.navigation.center = linked_pose(center, from, to).position;
}

}  // namespace gs::app
