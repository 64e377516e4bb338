#pragma once

#include "app/formats/common/color_key.h"
#include "app/formats/common/time_steps.h"
#include "app/formats/common/upright.h"
#include "base/diagnostic.h"
#include "render/image/image.h"
#include "render/scene/render_list.h"
#include "vrml/scene/scene_graph.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

namespace gs::app {

class MediaFile;
class StreamFeed;

/// Folder that a world refers to but must not read without the user's permission.
struct OutsideFolder {
  std::string folder;
  std::string reference;  // one reference to a file in the folder, as the world writes it
  friend bool operator==(const OutsideFolder&, const OutsideFolder&) = default;
};

/// Received fraction of the resource that a node's url refers to, 0 to 1.
struct UrlProgress {
  vrml::SceneGraph* scene = nullptr;
  vrml::NodeId node;
  double fraction = 0;
};

/// Duration of a node's media in seconds. Negative if the duration is unknown or the node has no media.
struct MediaDuration {
  vrml::SceneGraph* scene = nullptr;
  vrml::NodeId node;
  double seconds = -1;
};

/// Text of a program from the url list of a Script.
struct ProgramText {
  vrml::SceneGraph* scene = nullptr;
  vrml::NodeId script;
  std::optional<std::string> text;  // nullopt if the text is unavailable
  std::string url;  // URL of the text
};

/// World as read from files, with all data that pictures of it need.
struct LoadedWorld {
  // Defined in the source file because the members are large.
  LoadedWorld();
  LoadedWorld(LoadedWorld&& other) noexcept;
  LoadedWorld& operator=(LoadedWorld&& other) noexcept;
  ~LoadedWorld();

  std::string title;  // WorldInfo.title, else META "title" of X3D, else the name of the file
  std::string path;  // path or URL as requested
  std::unique_ptr<vrml::SceneGraph> scene;  // null if the world cannot be shown; see the diagnostics
  render::Images images;
  render::Geometries geometries;
  std::unordered_map<const vrml::Node*, std::shared_ptr<const MediaFile>> media;  // by AudioClip or MovieTexture
  std::vector<MediaDuration> durations;  // durations that the nodes have not got yet
  std::vector<std::shared_ptr<StreamFeed>> feeds;  // streams of `geometries` that still grow
  /// Scenes that hold the memory shares of polygons from urls, by OutlineGroup.
  std::unordered_map<const vrml::Node*, std::shared_ptr<const vrml::SceneGraph>> outlines;
  std::vector<UrlProgress> progress;  // progress of QNV nodes
  std::vector<ProgramText> programs;  // Script programs from separate files
  Diagnostics diagnostics;
  std::vector<OutsideFolder> outside;
  bool network_allowed = false;  // value of --allow-network; see session/documents/network_gate.h
  bool authored = true;  // true for an authored world; false for a measured or modelled object
  std::string type;      // name of the content type of the opened file
  UpRule up = UpRule::y;  // up axis of files in this format
  std::optional<Upright> stated_up;  // up axis that the file itself defines
  std::optional<ColorKey> color_key;  // meaning of the surface colours, if the file defines it
  std::string live;                   // URL of the JSON resource of a running simulation; empty if there is none
  std::optional<TimeSteps> steps;     // of a file with a surface that changes with time
  bool truncated = false;  // the file ends too early
  std::size_t bytes = 0;  // size of the opened file, without references; if read by parts, its first bytes
  std::shared_ptr<const std::atomic<std::uint64_t>> parts;  // counter of further bytes if read by parts, else null
  /// Returns the bytes of the opened file that were read or received so far.
  [[nodiscard]] std::uint64_t received() const { return bytes + (parts ? parts->load() : 0); }
  double parse_seconds = 0;  // parsing time of the opened file, without references

  /// Returns the orientation of the world. `size` is the extent of all visible objects along x, y and z. Objects that
  /// are no authored world are first shown in a three-quarter view, except pictures: flat objects that face the viewer.
  [[nodiscard]] Upright upright(const glm::vec3& size) const;
};

}  // namespace gs::app
