#pragma once

#include "app/session/documents/documents.h"
#include "app/view/navigation.h"
#include "app/view/pose_history.h"
#include "app/view/values/slices.h"
#include "app/view/values/volume_display.h"
#include "render/scene/draw_options.h"
#include "render/scene/sight.h"
#include "render/scene/splat_style.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// Style of a view that the user can change.
struct ViewStyle {
  UpAxis up = UpAxis::automatic;  // up axis that the user chose
  bool parallel = false;          // orthographic projection instead of perspective
  render::DisplayMode display = render::DisplayMode::surface;
  bool backdrop = false;                                   // draw a gradient behind files other than VRML97 worlds
  bool axes = false;                                       // draw axes in a corner; clicking one turns the view
  bool grid = false;                                       // draw a grid on the ground
  double pixels_per_point = render::kUsualPixelsPerPoint;  // of the screen or paper; the user cannot change it

  bool operator==(const ViewStyle&) const = default;
};

/// Camera and style with which one viewport looks at a document. A view and its render lists share ownership of the
/// document.
struct View {
  std::shared_ptr<Document> document;
  std::shared_ptr<RuntimeScene> scene;             // render scene of the running world; null before the world starts
  std::shared_ptr<const render::RenderList> list;  // render list of `scene`, or of the parts received so far
  NavigationRules rules;
  render::NavigationState navigation_info;  // NavigationInfo from which `rules` were derived
  Navigation navigation;
  Pose home;                             // pose of the bound Viewpoint, or of the initial view
  glm::vec2 home_size{0};                // viewport size in pixels for which the initial view was chosen
  glm::vec2 size{0};                     // size of the viewport in pixels
  WideBox framed;                        // bounds that the initial view frames
  float first_size = 0;                  // diagonal of the bounds in the first initial view
  std::optional<std::size_t> viewpoint;  // index of the viewer's Viewpoint, even after the viewer has moved away
  glm::dmat4 world_from_viewpoint{1.0};  // transformation of that Viewpoint in the last step; the viewer moves with it
  double scale = 1;                      // length of a metre of that Viewpoint in world units (6.29)
  /// Pose of the viewer relative to a Viewpoint, stored when another Viewpoint was bound (VRML97 6.53).
  struct Left {
    vrml::NodePlace viewpoint;
    glm::dmat4 viewpoint_from_viewer{1.0};
  };
  std::vector<Left> left;
  const vrml::Node* bound = nullptr;             // Viewpoint that was bound in the last step; may have been removed
  vrml::NodePlace bound_place;                   // scene and ID of that Viewpoint
  bool bound_jump = true;                        // `jump` field of that Viewpoint in the last step
  std::optional<glm::dvec3> center_of_rotation;  // of the viewer's Viewpoint in the last step
  bool travels = false;                          // the viewer moves to a Viewpoint
  bool headlight = true;
  std::size_t budget = 0;  // vector budget that a link sets; 0 means the budget of the viewport
  render::SplatStyle look;
  VolumeSlices slices;
  VolumeDisplay volume;
  bool color_bar = false;  // draw the colour bar beside the picture
  ViewStyle style;
  PoseHistory history;  // earlier poses of the viewer
  /// Other content in the same space, which is drawn but neither picked nor collidable.
  struct Over {
    std::string path;            // entry of the list of files
    std::shared_ptr<View> view;  // null until it is read; its camera is not used
  };
  std::vector<Over> over;
};

/// Makes the initial view of a document: at the Viewpoint with the name `viewpoint`, else at the bound or first one.
/// Without a Viewpoint, the view shows the whole world. Sets `found` to false if no Viewpoint has the name.
[[nodiscard]] View view_of(std::shared_ptr<Document> document, const glm::vec2& viewport, std::string_view viewpoint,
                           bool* found = nullptr, const ViewStyle& style = {});

/// Returns the up axis of a view: the user's choice, else that of the Viewpoint, else that of the file.
[[nodiscard]] Upright upright_of(const View& view);
/// Lights objects that are no VRML97 worlds so that their shape shows: with the headlight from the left and above
/// instead of along the view (VRML97 6.29), and with ambient occlusion. Changes nothing for worlds.
void light_objects(const Document& document, render::DrawOptions& draw);
/// Applies the display mode, backdrop and lighting of a view's style.
void apply_style(const View& view, render::DrawOptions& draw);
/// Returns true if the list has triangles; otherwise display modes have no effect.
[[nodiscard]] bool has_faces(const render::RenderList& list);
/// Changes the up axis of a view. If the world has no Viewpoint and the viewer has not moved, the viewer moves to the
/// new initial view.
void choose_up(View& view, UpAxis up);
/// Switches between orthographic and perspective projection. The object in view keeps its size.
void choose_parallel(View& view, bool parallel);

/// Makes the view of a document that was read again. Keeps the state of `before` as far as the new world allows it.
[[nodiscard]] View renewed(const View& before, std::shared_ptr<Document> document, const glm::vec2& viewport);

/// Returns true if the viewer has not moved away from the Viewpoint or initial view.
[[nodiscard]] bool at_home(const View& view);

/// Adapts the initial view to a new viewport size in pixels, and moves a viewer that has not moved yet. Does nothing if
/// a Viewpoint is bound.
void fit_home(View& view, const glm::vec2& viewport);

/// Makes the view of a document to which parts were added. Keeps the state of `before`; a viewer that has not moved
/// sees the whole world.
[[nodiscard]] View grown(const View& before, std::shared_ptr<Document> document, const glm::vec2& viewport);

/// Returns what content in units of the picture depends on, for a camera in the viewport of a view.
[[nodiscard]] render::Sight sight_of(const View& view, const render::Camera& camera);
/// Places content in units of the picture for a picture of another size or from another camera, until the next call of
/// follow_world() or lay_out().
void lay_out(const View& view, const render::Camera& camera, const glm::vec2& size);
/// Updates the render list of a view to the running world and the viewer. The viewer moves with its Viewpoint (VRML97
/// 6.53). In a world without a Viewpoint, the camera re-frames the scene within limits until the user first moves.
/// Returns true if the picture changed. Call on the thread of the world.
bool follow_world(View& view);
/// Binds the Viewpoint at an index of the list, and moves the viewer there.
void bind_viewpoint(View& view, std::size_t index);
/// Follows a change of the bound Viewpoint by events since the last call (VRML97 4.6.10, 6.53). If the former Viewpoint
/// was removed from the bindable stack, restores the viewer's pose relative to the Viewpoint below. Returns true if the
/// bound Viewpoint changed.
bool follow_bound_viewpoint(View& view);

/// Maps a pose from a world with bounds `from` to one with bounds `to`: the position is moved with the centre and
/// scaled with the diagonal. Returns `pose` unchanged if the bounds are equal or one is empty.
[[nodiscard]] Pose linked_pose(const Pose& pose, const WideBox& from, const WideBox& to);

/// Applies the camera of `leader` to `view`, mapped by the bounds of their worlds. Stops the motion of `view`. Does
/// nothing if the author of the world forbids navigation.
void link_view(View& view, const View& leader);

}  // namespace gs::app
