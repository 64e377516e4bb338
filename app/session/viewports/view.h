#pragma once

#include "app/session/documents/documents.h"
#include "app/view/navigation.h"
#include "app/view/pose_history.h"
#include "app/view/values/slices.h"
#include "render/scene/cloud_look.h"
#include "render/scene/draw_options.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

namespace gs::app {

/// Initial style of a file's view.
struct ViewStyle {
  UpAxis up = UpAxis::automatic;  // chosen by the user
  bool parallel = false;          // orthographic instead of perspective projection
  render::DisplayMode display = render::DisplayMode::surface;
  bool backdrop = false;  // gradient if the world has no Background
  bool axes = false;      // axes in a corner; clicking one turns the view
  bool grid = false;      // on the ground

  bool operator==(const ViewStyle&) const = default;
};

/// Camera and style with which one viewport looks at a document. It shares ownership of the document, as its render
/// lists do.
struct View {
  std::shared_ptr<Document> document;
  std::shared_ptr<RuntimeScene> scene;             // render list of the running world; null before the world starts
  std::shared_ptr<const render::RenderList> list;  // of `scene`, or of the parts received so far
  NavigationRules rules;
  render::NavigationState navigation_info;  // state from which `rules` were last made
  Navigation navigation;
  Pose home;                             // of the bound Viewpoint, or the initial view of the whole
  glm::vec2 home_size{0};                // viewport size for which the initial view was chosen
  WideBox framed;                        // bounds that the initial view shows
  float first_size = 0;                  // diagonal of the whole in the initial view
  std::optional<std::size_t> viewpoint;  // the Viewpoint of the viewer, even after it has moved away
  glm::dmat4 world_from_viewpoint{1.0};  // of that Viewpoint in the last step; the viewer moves with it
  double scale = 1;                      // of that Viewpoint: length of its metre in the world (6.29)
  /// Pose of the viewer relative to a Viewpoint that another was bound over (VRML97 6.53).
  struct Left {
    vrml::NodePlace viewpoint;
    glm::dmat4 viewpoint_from_viewer{1.0};
  };
  std::vector<Left> left;
  const vrml::Node* bound = nullptr;  // Viewpoint that was bound in the world in the last step
  vrml::NodePlace bound_place;        // path of that Viewpoint, which may have been removed since
  bool bound_jump = true;             // its `jump` field in the last step
  bool headlight = true;
  std::size_t budget = 0;  // vectors that a link asks for; 0 means the viewport's budget
  render::SplatStyle look;
  VolumeSlices slices;
  bool color_bar = false;  // visible beside the picture
  ViewStyle style;
  PoseHistory history;  // of the viewer
};

/// Returns the initial view of a document: at the Viewpoint named `viewpoint`, else at the first one, else a view of
/// the whole. Sets `found` to false if no Viewpoint has the given name.
[[nodiscard]] View view_of(std::shared_ptr<Document> document, const glm::vec2& viewport, std::string_view viewpoint,
                           bool* found = nullptr, const ViewStyle& style = {});

/// Returns the up axis of a view: the user's choice, else that of the bound Viewpoint, else that of the file.
[[nodiscard]] Upright upright_of(const View& view);
/// Applies the display mode and backdrop of a view's style.
void apply_style(const View& view, render::DrawOptions& draw);
/// Returns true if the list has triangles, so that display modes change the picture.
[[nodiscard]] bool has_faces(const render::RenderList& list);
/// Changes the up axis. In a world without a Viewpoint, a viewer at the initial view moves to the new initial view.
void choose_up(View& view, UpAxis up);
/// Switches between orthographic and perspective projection. The object in view keeps its size.
void choose_parallel(View& view, bool parallel);

/// Returns the view of a document that was read again: like `before`, as far as the new world allows it.
[[nodiscard]] View renewed(const View& before, std::shared_ptr<Document> document, const glm::vec2& viewport);

/// Returns true while the viewer has not moved from the initial view or the Viewpoint.
[[nodiscard]] bool at_home(const View& view);

/// Chooses the initial view of the whole for another viewport size, and applies it if the viewer has not moved. Does
/// nothing if a Viewpoint is bound.
void fit_home(View& view, const glm::vec2& viewport);

/// Returns the view of a document with new parts: like `before`, but a viewer that has not moved sees the whole.
[[nodiscard]] View grown(const View& before, std::shared_ptr<Document> document, const glm::vec2& viewport);

/// Updates the render list for the running world and the viewer, and moves the viewer with the Viewpoint (VRML97 6.53).
/// In a world without a Viewpoint, the camera re-frames the scene within limits until the user first moves. Returns
/// true if the picture changed. Called on the thread of the world.
bool follow_world(View& view);
/// Binds a Viewpoint of the list in the running world, and moves there.
void bind_viewpoint(View& view, std::size_t index);
/// Moves to the Viewpoint that events have bound since the last call (VRML97 4.6.10, 6.53). If the former Viewpoint has
/// left the stack, restores the viewer's pose relative to the uncovered one. Returns true if there is one.
bool follow_bound_viewpoint(View& view);

/// Maps a pose from bounds `from` to bounds `to`: moves it with the centre and scales it with the diagonal. Returns
/// `pose` if the bounds are equal or one is empty.
[[nodiscard]] Pose linked_pose(const Pose& pose, const WideBox& from, const WideBox& to);

/// Applies the camera of `leader` to `view`, relative to their worlds, and stops its motion. Does nothing if the author
/// of the world forbids navigation.
void link_view(View& view, const View& leader);

}  // namespace gs::app
