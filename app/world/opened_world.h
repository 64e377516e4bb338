#pragma once

#include "app/formats/common/color_key.h"
#include "app/formats/common/upright.h"
#include "render/image/image.h"
#include "render/scene/render_list.h"
#include "vrml/scene/diagnostic.h"
#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

namespace gs::app {

class MediaFile;
class StreamFeed;

/// A folder with something that a world refers to and may not read; the user may allow it.
struct OutsideFolder {
  std::string folder;
  std::string reference;  // the first, as the world has it
  friend bool operator==(const OutsideFolder&, const OutsideFolder&) = default;
};

/// How much of what a node's url names has come: 0 to 1.
struct UrlProgress {
  vrml::SceneGraph* scene = nullptr;
  vrml::NodeId node;
  double fraction = 0;
};

/// How long what a node plays is, in seconds; negative: that is not known, or there is none.
struct MediaDuration {
  vrml::SceneGraph* scene = nullptr;
  vrml::NodeId node;
  double seconds = -1;
};

/// The text of a program that a Script's url names.
struct ProgramText {
  vrml::SceneGraph* scene = nullptr;
  vrml::NodeId script;
  std::optional<std::string> text;  // none: it cannot be had
  std::string url;                  // where it was found
};

/// A world that was read, with everything a picture of it needs.
struct OpenedWorld {
  // Not in each file that has a world: they are long.
  OpenedWorld();
  OpenedWorld(OpenedWorld&& other) noexcept;
  OpenedWorld& operator=(OpenedWorld&& other) noexcept;
  ~OpenedWorld();

  std::string title;                        // WorldInfo.title or the file's name
  std::string path;                         // as it was asked for
  std::unique_ptr<vrml::SceneGraph> scene;  // null: it could not be opened, and the diagnostics say why
  render::Images images;
  render::Clouds clouds;
  std::unordered_map<const vrml::Node*, std::shared_ptr<const MediaFile>> media;  // of AudioClips and MovieTextures
  std::vector<MediaDuration> durations;                                           // likewise, that are to be told
  std::vector<std::shared_ptr<StreamFeed>> feeds;  // of streams among `clouds` that grow; see stream_feed.h
  /// By OutlineGroup with polygons that its url names: from whose budget these are drawn.
  std::unordered_map<const vrml::Node*, std::shared_ptr<const vrml::SceneGraph>> outlines;
  std::vector<UrlProgress> progress;  // of QNV nodes
  std::vector<ProgramText> programs;  // of files
  vrml::Diagnostics diagnostics;
  std::vector<OutsideFolder> outside;
  bool network_allowed = false;       // --allow-network, see session/documents/network_gate.h
  bool authored = true;               // a world with a look of its own; else a thing that a file has measured or made
  UpRule up = UpRule::y;              // of its format
  std::optional<Upright> stated_up;   // by the file itself
  std::optional<ColorKey> color_key;  // what the colours of its surfaces stand for, where it says so
  bool truncated = false;             // the file ends before the world does
  std::size_t bytes = 0;              // of the file itself, as it lies on disk
  double parse_seconds = 0;           // of the file itself, without what it refers to

  /// How it stands; `size`: of all that it shows, along the axes.
  [[nodiscard]] Upright upright(const glm::vec3& size) const { return stated_up.value_or(upright_of(up, size)); }
};

}  // namespace gs::app
