#pragma once

#include "app/interface/base/ui_tools.h"
#include "app/session/documents/session_log.h"
#include "app/session/viewports/view.h"
#include "app/settings/app_state.h"
#include "app/settings/user_settings.h"
#include "app/view/actions.h"
#include "app/view/navigation.h"
#include "app/view/panes/pane_request.h"
#include "app/view/panes/split_tree.h"
#include "qnv/base/geometry.h"
#include "render/draw/renderer.h"
#include "render/scene/cloud_look.h"
#include "vrml/mesh/mesh.h"

#include <glm/vec2.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace gs::app {

class Inspection;

/// A viewport in sight.
struct UiViewport {
  std::size_t pane = 0;  // its number, from 0
  Viewport place;
  std::string label;    // of the file it shows; empty: none
  std::string loading;  // label of what is being read for it, or empty
  bool active = false;
  double weight = 1;           // of its shares
  double vectors = 0;          // its share of the budget of vectors, 0 to 1; 0: it shows none
  std::size_t budget = 0;      // that many
  double reading = 0;          // its share of what is read over the network; 0: it waits for nothing there
  std::uint64_t rate = 0;      // bits a second that may come for it at most; 0: any
  double arriving = 0;         // that do
  std::string failed, reason;  // label of a file that it could not show, and why; empty: none
  bool axes = false;           // are shown in a corner
  Pose pose;                   // of its viewer
};

/// A question to the user about what a world may do.
struct UiQuestion {
  enum class Kind : std::uint8_t {
    folder,   // may it read a folder that is not its own?
    network,  // may its Scripts, which have read another local file, use the network?
  };
  Kind kind = Kind::folder;
  std::string world;    // label
  std::string subject;  // the folder, or the first URL
  std::string reason;   // the reference to the folder, or the file that was read
};

/// State that the user interface shows. Made again for each frame; pointers are valid for that frame only.
struct UiModel {
  std::vector<std::string> files;   // labels
  std::vector<std::string> paths;   // of these
  std::optional<std::size_t> file;  // of these, the chosen one

  std::vector<UiViewport> viewports;
  std::optional<ViewportLayout> layout = ViewportLayout::one;  // nullopt for a split without a button
  std::size_t panes = 1;                                       // those out of sight beside a maximised one, too
  bool maximised = false;
  std::vector<std::pair<std::size_t, std::string>> pane_labels;  // of all of them, with their numbers from 0
  std::vector<SplitDivider> dividers;                            // between those in sight
  bool linked = false;                                           // all viewports move as one
  std::optional<UiQuestion> question;

  // Of the user.
  UserSettings settings;
  std::vector<std::string> recent;  // paths and URLs, the newest first
  std::vector<Bookmark> bookmarks;
  std::size_t to_restore = 0;  // files of a window that ended by itself; 0: nothing is asked

  // From here on: the active viewport.
  std::string address;                  // path or URL of what it shows or waits for
  std::optional<std::size_t> bookmark;  // of that file and viewpoint
  bool can_go_back = false, can_go_forward = false;
  bool loading = false;
  bool has_world = false;
  bool first_steps = false;  // it is what a program without arguments shows, to whom has not closed the first steps

  std::vector<std::string> viewpoints;   // labels
  std::optional<std::size_t> viewpoint;  // of these, the bound one
  NavigationMode mode = NavigationMode::none;
  NavigationRules rules;
  float speed = 1;  // metres a second
  bool headlight = false;
  ViewStyle style;
  Pose pose;              // of the viewer
  Upright upright;        // of the viewed file
  std::string grid_text;  // how large the squares on the ground are; empty: there are none
  bool can_undo_move = false, can_redo_move = false;
  bool has_sounds = false, muted = false;

  // Its clouds.
  render::SplatStyle look;
  bool has_surface_clouds = false, has_volumes = false;
  WideBox bounds;                                          // world space, of everything
  std::vector<std::shared_ptr<const qnv::Volume>> volumes;  // of which the panel takes a summary, once
  glm::vec3 looking{0, 0, -1};                             // world space, along the middle of the view

  render::FrameStatistics statistics;
  double frame_ms = 0, frames_a_second = 0;
  std::string gl_renderer;
  const SessionLog* log = nullptr;
  Inspection* inspection = nullptr;  // into the world, where the user looks; what he wants of it goes there

  bool over_sensor = false;                // the pointer is over something in the world that can be clicked or dragged
  std::string link;                        // its target; may be empty
  std::optional<glm::vec2> travel_anchor;  // framebuffer pixels
  glm::vec2 pointer{0};

  UiTools tools;
};

/// Actions that the user started in it.
struct UiActions {
  std::optional<std::string> open;
  std::optional<std::size_t> file, viewpoint;
  std::optional<NavigationMode> mode;
  std::optional<Action> run;
  std::optional<ViewportLayout> layout;
  std::optional<PaneRequest> pane;  // request to a viewport
  struct DividerMove {
    SplitDivider divider;
    int place = 0, least = 1;  // framebuffer pixels: its column or row, and what every viewport keeps
    bool ended = false;        // it has been let go
  };
  std::optional<DividerMove> divider;
  std::optional<bool> allow_question;                         // the answer to UiModel::question
  std::optional<std::size_t> cancel_loading;                  // of UiModel::viewports
  std::optional<render::SplatStyle> look;                     // instead of the model's
  std::optional<UserSettings> settings;                       // replaces the model's
  std::optional<std::size_t> open_bookmark, remove_bookmark;  // of UiModel::bookmarks
  std::optional<bool> restore;                                // the answer about UiModel::to_restore
  UiToolActions tools;
};

}  // namespace gs::app
