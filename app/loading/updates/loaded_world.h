#pragma once

#include "app/formats/common/color_key.h"
#include "app/formats/common/upright.h"
#include "base/diagnostic.h"
#include "render/image/image.h"
#include "render/scene/render_list.h"
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

/// Folder with a file that a world refers to but must not read, unless the user allows it.
struct OutsideFolder {
  std::string folder;
  std::string reference;  // the first one, as the world writes it
  friend bool operator==(const OutsideFolder&, const OutsideFolder&) = default;
};

/// Received fraction of a node's url content, 0 to 1.
struct UrlProgress {
  vrml::SceneGraph* scene = nullptr;
  vrml::NodeId node;
  double fraction = 0;
};

/// Duration of a node's media in seconds; negative if it is unknown or there is none.
struct MediaDuration {
  vrml::SceneGraph* scene = nullptr;
  vrml::NodeId node;
  double seconds = -1;
};

/// Text of a program that a Script's url refers to.
struct ProgramText {
  vrml::SceneGraph* scene = nullptr;
  vrml::NodeId script;
  std::optional<std::string> text;  // nullopt if it is not available
  std::string url;                  // URL that it was read from
};

/// World that was read, with all data that a picture of it needs.
struct LoadedWorld {
  // Defined in the source file because the members are large.
  LoadedWorld();
  LoadedWorld(LoadedWorld&& other) noexcept;
  LoadedWorld& operator=(LoadedWorld&& other) noexcept;
  ~LoadedWorld();

  std::string title;                        // WorldInfo.title or the file's name
  std::string path;                         // as requested
  std::unique_ptr<vrml::SceneGraph> scene;  // null if the world could not be opened; the diagnostics give the reason
  render::Images images;
  render::Geometries clouds;
  std::unordered_map<const vrml::Node*, std::shared_ptr<const MediaFile>> media;  // of AudioClips and MovieTextures
  std::vector<MediaDuration> durations;            // of AudioClips and MovieTextures, not reported to them yet
  std::vector<std::shared_ptr<StreamFeed>> feeds;  // of streams in `clouds` that still grow; see stream_feed.h
  /// Scenes with the budget for the polygons, by OutlineGroup that read polygons from its url.
  std::unordered_map<const vrml::Node*, std::shared_ptr<const vrml::SceneGraph>> outlines;
  std::vector<UrlProgress> progress;  // of QNV nodes
  std::vector<ProgramText> programs;  // of files
  Diagnostics diagnostics;
  std::vector<OutsideFolder> outside;
  bool network_allowed = false;       // --allow-network; see session/documents/network_gate.h
  bool authored = true;               // an authored world; false for a measured or modelled object
  UpRule up = UpRule::y;              // of its format
  std::optional<Upright> stated_up;   // from the file itself
  std::optional<ColorKey> color_key;  // meaning of the colours of its surfaces, if the file gives it
  bool truncated = false;             // the file ends before the world is complete
  std::size_t bytes = 0;              // size of the file itself on disk
  double parse_seconds = 0;           // for the file itself, without its references

  /// Returns the up axis. `size` is the extent of all visible objects along the axes.
  [[nodiscard]] Upright upright(const glm::vec3& size) const { return stated_up.value_or(upright_of(up, size)); }
};

}  // namespace gs::app
