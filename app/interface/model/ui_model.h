#pragma once

#include "app/interface/model/ui_data.h"
#include "app/interface/model/ui_splats.h"
#include "app/interface/model/ui_tools.h"
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
#include "render/scene/splat_style.h"
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

/// Visible viewport.
struct UiViewport {
  std::size_t pane = 0;  // index of the viewport, from 0
  Viewport place;
  std::string label;             // name of the displayed file; empty if the viewport is empty
  std::string loading;           // name and progress of the file that is loading; empty if no file is
  std::optional<double> loaded;  // received fraction of the file that is loading, 0 to 1; nullopt if unknown
  bool active = false;
  double weight = 1;           // weight of the viewport when budget and bandwidth are divided
  double vectors = 0;          // share of all drawn vectors, 0 to 1; 0 if no vectors are drawn
  std::size_t budget = 0;      // vector budget of this viewport
  double reading = 0;          // share of the network bandwidth, 0 to 1; 0 if no stream is loading
  std::uint64_t rate = 0;      // bandwidth limit in bits/s; 0 means unlimited
  double arriving = 0;         // measured receive rate in bits/s
  std::string failed, reason;  // name of the file that failed to open, and the error; empty if none failed
  std::string stopped;         // why Scripts or events of the displayed world have ended; empty while they go on
  bool axes = false;           // the axes widget is visible
  Pose pose;                   // pose of the viewer
};

/// Question to the user: about a permission of a world, or before data are lost.
struct UiQuestion {
  enum class Kind : std::uint8_t {
    folder,   // read a folder outside the world's own folder
    network,  // let Scripts use the network, although they have read another local file
    replace,  // replace an existing file
    unsaved,  // lose the edits of a world
  };
  Kind kind = Kind::folder;
  std::string world;    // name of the world's file
  std::string subject;  // the folder, the first requested URL, or the file to replace
  std::string reason;   // the world's reference to the folder, or the local file that the Script read
};

/// Answer to a question before data are lost.
enum class UiAnswer : std::uint8_t { cancel, discard, save };

/// State that the user interface shows. Rebuilt for each frame; pointers are valid for that frame only.
struct UiModel {
  std::vector<std::string> files;   // names of the opened files
  std::vector<std::string> paths;   // paths or URLs of `files`
  std::optional<std::size_t> file;  // index of the selected file in `files`

  std::vector<UiViewport> viewports;
  std::optional<ViewportLayout> layout = ViewportLayout::one;  // nullopt if no layout button corresponds to the split
  std::size_t panes = 1;                                       // number of viewports, visible and hidden
  bool maximised = false;
  std::vector<std::pair<std::size_t, std::string>> pane_labels;  // index from 0 and file name of every viewport
  std::vector<SplitDivider> dividers;                            // between visible viewports
  bool linked = false;                                           // all viewports share one camera movement
  std::optional<UiQuestion> question;

  // Data of the user.
  UserSettings settings;
  std::vector<std::string> recent;  // paths and URLs of recent files, newest first
  std::vector<Bookmark> bookmarks;
  std::vector<std::string> to_restore;  // files that were open when the last run crashed

  // The fields from here on describe the active viewport.
  std::string address;                  // path or URL of the displayed or loading file
  std::optional<std::size_t> bookmark;  // index in `bookmarks` of the bookmark of this file and viewpoint
  bool can_go_back = false, can_go_forward = false;
  bool loading = false;
  bool has_world = false;
  bool first_steps = false;  // show the hints for beginners over the start world

  std::vector<std::string> viewpoints;   // names of the listed viewpoints
  std::optional<std::size_t> viewpoint;  // index of the bound one in `viewpoints`
  NavigationMode mode = NavigationMode::none;
  NavigationRules rules;
  float speed = 1;  // metres/s
  bool headlight = false;
  ViewStyle style;
  Pose pose;                                // of the viewer
  Upright upright;                          // up axis of the displayed file
  std::string grid_text;                    // how large the squares on the ground are; empty: there are none
  bool can_undo = false, can_redo = false;  // a movement of the viewer or an edit
  bool has_sounds = false, muted = false;

  // Vectors and volumes of the world.
  render::SplatStyle look;
  bool has_surface_vectors = false, has_volumes = false;
  WideBox bounds;                                           // world space, of the whole world
  std::vector<std::shared_ptr<const qnv::Volume>> volumes;  // input of the panel's summary, which is computed only once
  glm::vec3 looking{0, 0, -1};                              // world space, viewing direction

  render::FrameStatistics statistics;
  double frame_ms = 0, frames_a_second = 0;
  std::string gl_renderer;
  const SessionLog* log = nullptr;
  Inspection* inspection = nullptr;  // inspection of the world in this viewport; panels send their requests to it

  bool over_sensor = false;                // the pointer is over a sensor or Anchor in the world
  std::string link;                        // description of that Anchor; may be empty
  std::optional<glm::vec2> travel_anchor;  // framebuffer pixels; where a drag that moves the viewer began
  glm::vec2 pointer{0};

  UiTools tools;
  UiData data;
  UiSplats splats;
};

/// Requests of the user in this frame.
struct UiActions {
  std::optional<std::string> open;
  std::optional<std::size_t> file, viewpoint;
  std::optional<NavigationMode> mode;
  std::optional<Action> run;
  std::optional<ViewportLayout> layout;
  std::optional<PaneRequest> pane;  // command for one viewport
  struct DividerMove {
    SplitDivider divider;
    int place = 0, least = 1;  // framebuffer pixels: new x or y of the divider, and min size of a viewport
    bool ended = false;        // the user released the divider
  };
  std::optional<DividerMove> divider;
  std::optional<bool> allow_question;         // answer to UiModel::question about a permission
  std::optional<UiAnswer> answer;             // answer to another UiModel::question
  std::optional<std::string> save;            // path at which to save the world, from the built-in dialog
  std::optional<std::size_t> cancel_loading;  // index in UiModel::viewports
  std::optional<render::SplatStyle> look;     // replaces UiModel::look
  std::optional<UserSettings> settings;       // replaces UiModel::settings
  std::optional<std::size_t> open_bookmark, remove_bookmark;  // indices in UiModel::bookmarks
  std::optional<bool> restore;                                // answer to the question whether to open the lost files
  UiToolActions tools;
  UiDataActions data;
  UiSplatActions splats;
};

}  // namespace gs::app
