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

/// How a file is seen that is seen for the first time.
struct ViewStyle {
  UpAxis up = UpAxis::automatic;  // as the user says
  bool parallel = false;          // by parallel rays, in place of perspective
  render::DisplayMode display = render::DisplayMode::surface;
  bool backdrop = false;  // a gradient where no author has chosen a background
  bool axes = false;      // in a corner: where they lead, and a click there shows that side
  bool grid = false;      // on the ground

  bool operator==(const ViewStyle&) const = default;
};

/// How one viewport looks at a document, which others may look at in other ways. A document lives as long as a view
/// of it, or a list that has it.
struct View {
  std::shared_ptr<Document> document;
  std::shared_ptr<LivingScene> scene;              // what it sees of the living world; null: that does not live yet
  std::shared_ptr<const render::RenderList> list;  // of that, or of what has come so far
  NavigationRules rules;
  render::NavigationState navigation_info;  // that the rules were last made of
  Navigation navigation;
  Pose home;                             // of the bound Viewpoint, or the first view of the whole
  glm::vec2 home_size{0};                // of the viewport for which the latter was chosen
  render::WorldBounds framed;            // what the latter has in view
  float first_size = 0;                  // of the whole as it was first seen: its diagonal
  std::optional<std::size_t> viewpoint;  // the one that it stands at or has moved away from
  glm::dmat4 world_from_viewpoint{1.0};  // of that, when it was last looked at: who moves with it
  double scale = 1;                      // of that: how long its metre is in the world's (6.29)
  /// Where the viewer stood, relative to Viewpoints that others were bound over (VRML97 6.53); the newest behind.
  struct Left {
    vrml::NodePlace viewpoint;
    glm::dmat4 viewpoint_from_viewer{1.0};
  };
  std::vector<Left> left;
  const vrml::Node* bound = nullptr;  // the Viewpoint that was bound in the world when that was last looked at
  vrml::NodePlace bound_place;        // of that; it may have been removed since
  bool bound_jump = true;             // its field, when that was last looked at
  bool headlight = true;
  std::size_t budget = 0;  // vectors that a link asks for; 0: as many as the viewport has
  render::CloudLook look;
  VolumeSlices slices;
  bool color_bar = false;  // beside the picture
  ViewStyle style;
  PoseHistory history;  // of the viewer
};

/// A view from where a document is first seen: at the Viewpoint named `viewpoint`, else at the first one, else so
/// that the whole is in view. `found`: false when a name was given that no Viewpoint has.
[[nodiscard]] View view_of(std::shared_ptr<Document> document, const glm::vec2& viewport, std::string_view viewpoint,
                           bool* found = nullptr, const ViewStyle& style = {});

/// How what it shows stands for who looks at it: as the user says, else as the bound Viewpoint's coordinates do, else
/// as the file does.
[[nodiscard]] Upright upright_of(const View& view);
/// What of a style is for the picture: display mode and backdrop.
void apply_style(const View& view, render::DrawOptions& draw);
/// Whether a display mode changes what is drawn of it: there are triangles.
[[nodiscard]] bool has_faces(const render::RenderList& list);
/// Something else is up from now on; who looks at the first view of a world without a Viewpoint goes to the new one.
void choose_up(View& view, UpAxis up);
/// Sees by parallel rays from now on, or in perspective: what he looks at is as large as before.
void choose_parallel(View& view, bool parallel);

/// The view of a document that was read again: as `before`, as far as the new world allows it.
[[nodiscard]] View renewed(const View& before, std::shared_ptr<Document> document, const glm::vec2& viewport);

/// True while nobody has moved from where the document is first seen, or from the Viewpoint.
[[nodiscard]] bool at_home(const View& view);

/// For a viewport of another size, chooses the first view of the whole anew, and goes there if nobody has moved yet.
/// Does nothing where a Viewpoint is bound.
void fit_home(View& view, const glm::vec2& viewport);

/// The view of a document of which more has come: as `before`; who has not moved sees all of it.
[[nodiscard]] View grown(const View& before, std::shared_ptr<Document> document, const glm::vec2& viewport);

/// Brings the list up to date with the living world and with where the viewer is, and carries him along with the
/// Viewpoint (VRML97 6.53). In a world without one, who has not moved is led back where something leaves the picture,
/// as long as it does not go too far. True when there is something else to be seen than before. On the thread of the
/// world.
bool follow_world(View& view);
/// Binds a Viewpoint of the list in the living world, and goes there.
void bind_viewpoint(View& view, std::size_t index);
/// Goes to the Viewpoint that events have bound in the world since the last time (4.6.10, 6.53); where the one before
/// has left the stack, to where the viewer stood relative to it when it was bound. True when there is one.
bool follow_bound_viewpoint(View& view);

/// The pose that stands to `to` as `pose` stands to `from`: moved with the centre and grown with the diagonal. The
/// same where both bounds are equal, or one of them is empty.
[[nodiscard]] Pose linked_pose(const Pose& pose, const render::WorldBounds& from, const render::WorldBounds& to);

/// Makes `view` look at its world as `leader` looks at the leader's, and stops what it was doing. Does nothing in a
/// world whose author lets nobody move.
void link_view(View& view, const View& leader);

}  // namespace gs::app
