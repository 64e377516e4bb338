#include "app/session/viewports/view.h"

#include "vrml/behaviours/browser_events.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace gs::app {
namespace {

bool usable(const WideBox& bounds) {
  const float size = bounds.empty() ? 0.0f : glm::length(bounds.size());
  return size > 0 && std::isfinite(size);
}

constexpr std::size_t kMaxLeft = 1000;  // max stored poses at Viewpoints that were left

bool same(const vrml::NodePlace& a, const vrml::NodePlace& b) { return a.scene == b.scene && a.node == b.node; }

/// Stores the `jump` field of the bound Viewpoint. If the Viewpoint was removed, the stored value remains.
void note_jump(View& view) {
  const auto [scene, node] = view.bound_place;
  if (scene && view.document->runtime->execution().scenes().has(scene) && scene->contains(node))
    view.bound_jump = scene->get<vrml::SFBool>(node, "jump");
}

void note_bound(View& view) {
  const vrml::NodeChange bound =
      view.document->runtime->execution().stacks().bound(vrml::built_in_node_type(vrml::NodeKind::viewpoint));
  view.bound = bound.scene ? &bound.scene->node(bound.node) : nullptr;
  view.bound_place = {bound.scene, bound.node};
  note_jump(view);
}

/// Stores the pose of the viewer relative to the bound Viewpoint, for the return to that Viewpoint (VRML97 6.53).
void leave_viewpoint(View& view) {
  if (!view.bound_place.scene || !view.viewpoint) return;
  const Pose& stands = view.navigation.transition ? view.navigation.transition->to : view.navigation.pose;
  std::erase_if(view.left, [&](const View::Left& one) { return same(one.viewpoint, view.bound_place); });
  if (view.left.size() >= kMaxLeft) view.left.erase(view.left.begin());
  view.left.push_back({view.bound_place, glm::inverse(world_from_viewer(view.home)) * world_from_viewer(stands)});
}

/// Returns the stored pose for the bound Viewpoint, and removes it, because it is valid for one return only.
glm::dmat4 take_left(View& view) {
  for (auto one = view.left.begin(); one != view.left.end(); ++one)
    if (same(one->viewpoint, view.bound_place)) {
      const glm::dmat4 matrix = one->viewpoint_from_viewer;
      view.left.erase(one);
      return matrix;
    }
  return glm::dmat4(1);
}

/// Returns the pose of a viewer that has moved away from a Viewpoint at `home`.
Pose moved_pose(const Pose& home, const glm::dmat4& viewpoint_from_viewer) {
  Pose pose = pose_of(world_from_viewer(home) * viewpoint_from_viewer, home.field_of_view);
  pose.height = home.height;
  return pose;
}

/// Returns the pose at a Viewpoint that the user chooses: with the user's earlier movements there, if it retains them.
Pose kept_pose(const View& view, const render::ViewpointState& viewpoint) {
  if (viewpoint.retains_offset)
    for (const View::Left& one : view.left)
      if (same(one.viewpoint, {viewpoint.scene, viewpoint.node}))
        return moved_pose(view.home, one.viewpoint_from_viewer);
  return view.home;
}

std::optional<std::size_t> index_of(const render::RenderList& list, const vrml::Node* viewpoint) {
  for (std::size_t i = 0; i < list.viewpoints.size(); ++i)
    if (&list.viewpoints[i].scene->node(list.viewpoints[i].node) == viewpoint) return i;
  return std::nullopt;
}

/// Returns a pose of the author or of the initial view, with the projection that the user chose.
Pose seen_as_chosen(const View& view, const Pose& pose) {
  if (!view.style.parallel) return pose;
  const WideBox& bounds = view.list->bounds;
  const glm::dvec3 center(usable(bounds) ? bounds.center() : glm::dvec3(0));
  const double ahead = glm::dot(center - pose.position, glm::dvec3(pose.forward()));
  return with_parallel_rays(pose, true, std::max({ahead, glm::length(center - pose.position) * 0.1, 1e-9}));
}

/// Returns the pose of a Viewpoint in a viewport of the view's size.
Pose home_of(const View& view, const render::ViewpointState& viewpoint) {
  Pose pose = pose_of(viewpoint.world_from_camera, viewpoint.field_of_view);
  if (viewpoint.extent.x > 0) pose.height = height_that_shows(viewpoint.extent, view.home_size);
  if (viewpoint.view_all && usable(view.list->bounds))
    pose = pose_that_fits(pose, view.list->bounds, glm::max(view.home_size, glm::vec2(1)), glm::vec3(viewpoint.up));
  return viewpoint.extent.x > 0 ? valid_pose(pose, Pose{}) : seen_as_chosen(view, pose);
}

/// Applies the centre of rotation of a Viewpoint of X3D (X3D 23.3.1).
void take_center(View& view, const render::ViewpointState& viewpoint) {
  if (viewpoint.center_of_rotation) view.navigation.center = *viewpoint.center_of_rotation;
  view.center_of_rotation = viewpoint.center_of_rotation;
}

/// Moves the viewer to the bound Viewpoint, as the bound NavigationInfo asks (X3D 23.4.4). `to` is the pose there.
void travel_to_viewpoint(View& view, const render::ViewpointState& viewpoint, const Pose& to, bool jump) {
  Navigation& navigation = view.navigation;
  // The projection changes at once, because there is nothing between perspective and parallel projection.
  if ((to.height > 0) != (navigation.pose.height > 0)) {
    if (navigation.transition) navigation.pose = navigation.transition->to;
    navigation.transition.reset();
    navigation.pose = with_parallel_rays(navigation.pose, to.height > 0, looked_at_distance(navigation));
  }
  navigation = travel_to(navigation, to, jump);
  take_center(view, viewpoint);
  const render::NavigationState& info = view.list->navigation;
  view.travels = true;
  if (!navigation.transition) return;
  if (info.transition_seconds) navigation.transition->duration = *info.transition_seconds;
  if (!info.teleports && navigation.transition->duration > 0) return;
  navigation.pose = navigation.transition->to;
  navigation.transition.reset();
}

/// Reports the end of the movement to a Viewpoint to the NavigationInfo.
void report_arrival(View& view) {
  if (!view.travels || view.navigation.transition) return;
  view.travels = false;
  if (view.list->navigation.transition_seconds) vrml::report_transition(view.document->runtime->execution());
}

/// Applies the up vector and the scale of a Viewpoint to the navigation (VRML97 6.29).
void take_measures(View& view, const render::ViewpointState& viewpoint) {
  if (view.style.up == UpAxis::automatic) view.navigation.up = glm::vec3(viewpoint.up);
  view.navigation.speed *= static_cast<float>(viewpoint.scale / std::exchange(view.scale, viewpoint.scale));
}

/// Applies the fields of the bound NavigationInfo that have changed (VRML97 4.6.10, 6.29).
void follow_navigation_info(View& view) {
  const render::NavigationState& now = view.list->navigation;
  if (now == view.navigation_info) return;
  const render::NavigationState before = std::exchange(view.navigation_info, now);
  view.rules = navigation_rules(now);
  if (now.speed != before.speed) view.navigation.speed = now.speed * static_cast<float>(view.scale);
  if (now.headlight != before.headlight) view.headlight = now.headlight;
  if (now.types != before.types) view.navigation = with_mode(view.navigation, view.rules.start);
}

/// Sets the home pose to a view of all of `whole`.
void choose_home(View& view, const WideBox& whole, const glm::vec2& viewport) {
  view.home_size = viewport;
  view.framed = whole;
  if (view.list->default_extent.x > 0) {
    view.home = Pose();
    view.home.height = height_that_shows(view.list->default_extent, viewport);
  } else {
    view.home = seen_as_chosen(view, first_pose(whole, viewport, upright_of(view)));
  }
}

/// Re-frames a world without a Viewpoint after objects have moved out of the picture. The new picture contains the
/// initial bounds, all later bounds, and a margin. Does nothing after the user has moved.
void follow_growth(View& view) {
  /// max growth of the diagonal, so that one object that flies away does not reduce the others to a dot
  constexpr float kMaxGrowth = 32;
  /// margin as a fraction of the diagonal, in addition to half of the growth, so that not every step re-frames
  constexpr float kAir = 0.05f;
  const WideBox& now = view.list->bounds;
  if (view.viewpoint || !view.list->viewpoints.empty() || view.list->default_extent.x > 0 || view.home_size.x <= 0 ||
      !usable(now) || !at_home(view) ||
      render::has_in_view(camera_of(view.home), now, view.home_size.x, view.home_size.y))
    return;
  // Do not move the camera while the user drags an object.
  if (view.document->runtime->execution().pointing().pointed_at().active) return;
  WideBox whole = view.framed;
  whole.add(now);
  if (!usable(view.framed)) {
    whole = now;
    view.first_size = glm::length(now.size());
  }
  if (glm::length(whole.size()) > kMaxGrowth * view.first_size) return;
  const float air = kAir * glm::length(whole.size());
  const WideBox before = std::exchange(view.framed, whole);
  for (int axis = 0; axis < 3 && usable(before); ++axis) {
    if (const float growth = before.lower[axis] - whole.lower[axis]; growth > 0)
      view.framed.lower[axis] -= growth / 2 + air;
    if (const float growth = whole.upper[axis] - before.upper[axis]; growth > 0)
      view.framed.upper[axis] += growth / 2 + air;
  }
  view.home = usable(before) ? pose_that_fits(view.home, view.framed, view.home_size, view.navigation.up)
                             : seen_as_chosen(view, first_pose(view.framed, view.home_size, upright_of(view)));
  const Navigation measured = start_navigation(view.rules, whole, view.home);
  view.navigation = travel_to(view.navigation, view.home);
  view.navigation.center = measured.center;
  view.navigation.scene_size = measured.scene_size;
}

}  // namespace

Upright upright_of(const View& view) {
  const Upright of_file = view.document ? view.document->upright : Upright{};
  if (view.style.up != UpAxis::automatic) {
    Upright chosen = upright_of(view.style.up);
    chosen.three_quarter = of_file.three_quarter;
    return chosen;
  }
  return view.viewpoint && view.navigation.up != of_file.up ? upright_along(view.navigation.up) : of_file;
}

void light_objects(const Document& document, render::DrawOptions& draw) {
  if (document.world.authored) return;
  const glm::vec3 above_left(-0.25f, 0.3f, 1);
  draw.headlight_towards = glm::normalize(above_left);
  draw.occlusion = render::Occlusion::hardware;
}

void apply_style(const View& view, render::DrawOptions& draw) {
  if (view.document) light_objects(*view.document, draw);
  draw.display = view.style.display;
  draw.backdrop = view.style.backdrop && view.document && !view.document->world.authored;
}

bool has_faces(const render::RenderList& list) {
  return std::any_of(list.items.begin(), list.items.end(), [](const render::DrawItem& item) {
    return item.mesh && item.mesh->primitive == vrml::Mesh::Primitive::triangles;
  });
}

void choose_up(View& view, UpAxis up) {
  const bool stays = at_home(view);
  view.style.up = up;
  view.navigation.up = upright_of(view).up;
  if (view.viewpoint && *view.viewpoint < view.list->viewpoints.size()) {
    if (up == UpAxis::automatic) view.navigation.up = glm::vec3(view.list->viewpoints[*view.viewpoint].up);
    return;
  }
  choose_home(view, usable(view.framed) ? view.framed : view.list->bounds, view.home_size);
  view.navigation =
      travel_to(view.navigation, stays ? view.home : straightened(view.navigation.pose, view.navigation.up));
}

void choose_parallel(View& view, bool parallel) {
  if (view.style.parallel == parallel) return;
  view.style.parallel = parallel;
  Navigation& navigation = view.navigation;
  if (navigation.transition) navigation.pose = navigation.transition->to;
  navigation.transition.reset();
  const bool stays = at_home(view);
  navigation.pose = with_parallel_rays(navigation.pose, parallel, looked_at_distance(navigation));
  if (view.viewpoint && *view.viewpoint < view.list->viewpoints.size())
    view.home = home_of(view, view.list->viewpoints[*view.viewpoint]);
  else
    choose_home(view, usable(view.framed) ? view.framed : view.list->bounds, view.home_size);
  if (stays) navigation.pose = view.home;
}

namespace {

/// Reports whether a world without a NavigationInfo starts with WALK, the default of VRML97. X3D has EXAMINE instead.
bool walks_at_first(const Document& document, const render::RenderList& list) {
  const vrml::SceneGraph* const scene = document.world.scene.get();
  return !list.viewpoints.empty() && !(scene && scene->language() == vrml::Language::x3d);
}

}  // namespace

View view_of(std::shared_ptr<Document> document, const glm::vec2& viewport, std::string_view viewpoint, bool* found,
             const ViewStyle& style) {
  View view;
  view.document = document;
  view.style = style;
  view.size = viewport;
  view.color_bar = document->world.color_key.has_value();  // colours that stand for values need their colour bar
  view.list = document->list;
  if (document->runtime) {
    note_bound(view);
    // Reuse the document's initial render scene, unless the world depends on the viewer and another view uses the
    // scene.
    view.scene = document->viewer_dependent && document->first_scene.use_count() > 1
                     ? document->runtime->look({0, 0, 10}, true)
                     : document->first_scene;
    view.list = view.scene->scene.shared_list();
  }
  const render::RenderList& list = *view.list;
  view.rules = document->has_navigation_info ? navigation_rules(list.navigation)
                                             : default_navigation_rules(list.bounds, walks_at_first(*document, list));
  view.navigation_info = list.navigation;
  view.headlight = list.navigation.headlight;
  const auto named = viewpoint.empty() ? std::nullopt : find_viewpoint(list.viewpoints, viewpoint);
  view.viewpoint = named ? named : list.viewpoints.empty() ? std::nullopt : std::optional<std::size_t>(0);
  if (!named && view.bound)
    if (const auto bound = index_of(list, view.bound)) view.viewpoint = bound;
  if (view.viewpoint) {
    const render::ViewpointState& bound = list.viewpoints[*view.viewpoint];
    view.world_from_viewpoint = bound.world_from_camera;
    view.home_size = viewport;
    view.home = home_of(view, bound);
  } else {
    choose_home(view, list.bounds, viewport);
    if (usable(list.bounds)) view.first_size = glm::length(list.bounds.size());
  }
  view.navigation = start_navigation(view.rules, list.bounds, view.home);
  view.navigation.up = upright_of(view).up;
  if (view.viewpoint) {
    take_measures(view, list.viewpoints[*view.viewpoint]);
    take_center(view, list.viewpoints[*view.viewpoint]);
  }
  if (found) *found = viewpoint.empty() || named.has_value();
  return view;
}

bool at_home(const View& view) {
  const Pose& pose = view.navigation.pose;
  return pose.position == view.home.position && pose.orientation == view.home.orientation && !view.navigation.moving();
}

void fit_home(View& view, const glm::vec2& viewport) {
  view.size = viewport;
  if (!view.list || view.home_size == viewport) return;
  const bool unmoved = at_home(view);
  if (view.viewpoint) {
    if (*view.viewpoint >= view.list->viewpoints.size()) return;
    const render::ViewpointState& viewpoint = view.list->viewpoints[*view.viewpoint];
    if (viewpoint.extent.x <= 0 && !viewpoint.view_all) return;
    view.home_size = viewport;
    view.home = home_of(view, viewpoint);
    if (unmoved) view.navigation.pose = view.home;
    return;
  }
  choose_home(view, usable(view.framed) ? view.framed : view.list->bounds, viewport);
  if (unmoved) view.navigation.pose = view.home;
}

render::Sight sight_of(const View& view, const render::Camera& camera) {
  render::Sight sight;
  sight.orientation = glm::dmat3(camera.world_from_camera);
  sight.field_of_view = camera.field_of_view;
  sight.height = camera.height;
  if (view.size.x > 0 && view.size.y > 0) sight.pixels = glm::dvec2(view.size);
  sight.pixels_per_point = view.style.pixels_per_point;
  return sight;
}

void lay_out(const View& view, const render::Camera& camera, const glm::vec2& size) {
  if (!view.scene || !view.document || !view.document->runtime) return;
  if (!view.scene->scene.depends_on_viewer() && view.list->layers.empty()) return;
  render::Sight sight = sight_of(view, camera);
  sight.pixels = glm::dvec2(size);
  view.scene->scene.set_sight(sight);
  (void)view.document->runtime->show(*view.scene, glm::dvec3(camera.world_from_camera[3]));
}

bool follow_world(View& view) {
  if (!view.scene || !view.document || !view.document->runtime) return false;
  report_arrival(view);
  view.scene->scene.set_sight(sight_of(view, camera_of(view.navigation.pose)));
  const bool changed = view.document->runtime->show(*view.scene, view.navigation.pose.position);
  if (!changed) return false;
  follow_navigation_info(view);
  const auto& viewpoints = view.list->viewpoints;
  if (view.viewpoint && *view.viewpoint >= viewpoints.size()) view.viewpoint.reset();
  if (!view.viewpoint) {
    follow_growth(view);
    return true;
  }
  const render::ViewpointState& viewpoint = viewpoints[*view.viewpoint];
  if (viewpoint.center_of_rotation != view.center_of_rotation) take_center(view, viewpoint);
  const bool shows_all = viewpoint.view_all;
  const bool same_lens = viewpoint.extent.x > 0 && !shows_all
                             ? height_that_shows(viewpoint.extent, view.home_size) == view.home.height
                             : viewpoint.field_of_view == view.home.field_of_view;
  if (viewpoint.world_from_camera == view.world_from_viewpoint && same_lens) return true;
  const glm::dmat4 moved = viewpoint.world_from_camera * glm::inverse(view.world_from_viewpoint);
  const double growth =
      viewpoint.extent.x > 0 && view.home.height > 0 ? home_of(view, viewpoint).height / view.home.height : 1;
  const auto carry = [&](Pose& pose) {
    const double height = pose.height;
    pose = pose_of(moved * world_from_viewer(pose), viewpoint.field_of_view);
    pose.height = height * growth;
  };
  const bool stays = at_home(view);
  take_measures(view, viewpoint);
  view.world_from_viewpoint = viewpoint.world_from_camera;
  carry(view.navigation.pose);
  if (view.navigation.transition) {
    carry(view.navigation.transition->from);
    carry(view.navigation.transition->to);
  }
  view.home = home_of(view, viewpoint);
  if (stays) view.navigation.pose = view.home;  // set it exactly, because rounding errors would accumulate
  return true;
}

void bind_viewpoint(View& view, std::size_t index) {
  if (index >= view.list->viewpoints.size()) return;
  const render::ViewpointState& viewpoint = view.list->viewpoints[index];
  leave_viewpoint(view);
  view.viewpoint = index;
  view.world_from_viewpoint = viewpoint.world_from_camera;
  view.home = home_of(view, viewpoint);
  take_measures(view, viewpoint);
  travel_to_viewpoint(view, viewpoint, kept_pose(view, viewpoint), false);
  if (!view.document || !view.document->runtime) return;
  (void)view.document->runtime->send(*viewpoint.scene, viewpoint.node, "set_bind", vrml::SFBool{true});
  note_bound(view);
}

bool follow_bound_viewpoint(View& view) {
  if (!view.document || !view.document->runtime) return false;
  const vrml::Node* bound = view.document->runtime->bound().viewpoint;
  if (bound == view.bound) return false;
  const bool popped = view.bound_place.scene && !view.document->runtime->execution().stacks().contains(
                                                    view.bound_place.scene, view.bound_place.node);
  if (!popped) leave_viewpoint(view);
  note_jump(view);
  const bool popped_jump = view.bound_jump;
  note_bound(view);
  const auto index = bound ? index_of(*view.list, bound) : std::nullopt;
  if (!index) return false;
  const render::ViewpointState& viewpoint = view.list->viewpoints[*index];
  view.viewpoint = index;
  view.world_from_viewpoint = viewpoint.world_from_camera;
  view.home = home_of(view, viewpoint);
  take_measures(view, viewpoint);
  // If the removed Viewpoint had `jump` TRUE, return to the pose that the viewer had before that Viewpoint was bound.
  const glm::dmat4 left = take_left(view);
  if (popped && popped_jump)
    travel_to_viewpoint(view, viewpoint, moved_pose(view.home, left), true);
  else if (!popped && viewpoint.jump)
    travel_to_viewpoint(view, viewpoint, viewpoint.retains_offset ? moved_pose(view.home, left) : view.home, true);
  return true;
}

Pose linked_pose(const Pose& pose, const WideBox& from, const WideBox& to) {
  if (!usable(from) || !usable(to) || (from.lower == to.lower && from.upper == to.upper)) return pose;
  const double scale = double{glm::length(to.size())} / double{glm::length(from.size())};
  Pose result = pose;
  result.height *= scale;
  result.position = glm::dvec3(to.center()) + (pose.position - glm::dvec3(from.center())) * scale;
  const double reach =
      std::max({std::abs(result.position.x), std::abs(result.position.y), std::abs(result.position.z)});
  return reach <= kFarthest ? result : pose;
}

void link_view(View& view, const View& leader) {
  if (!view.document || !leader.document || view.navigation.mode == NavigationMode::none) return;
  // Use the bounds of the documents, because those of views may depend on the viewer.
  const WideBox &from = leader.document->list->bounds, &to = view.document->list->bounds;
  view.navigation = with_mode(view.navigation, view.navigation.mode);
  view.navigation.transition.reset();
  view.navigation.pose = linked_pose(leader.navigation.pose, from, to);
  view.style.parallel = leader.style.parallel;
  Pose center;  // centre of rotation in EXAMINE, which is mapped like a pose
  center.position = leader.navigation.center;
  view.navigation.center = linked_pose(center, from, to).position;
}

}  // namespace gs::app
