#pragma once

#include "app/formats/common/mesh_asset.h"
#include "base/noncopyable.h"
#include "vrml/scene/scene_graph.h"

#include <string>
#include <string_view>
#include <unordered_set>
#include <utility>

namespace gs::app {

/// Factory of nodes for importers, with diagnostics. Returns null nodes after the scene's node limit is reached. All
/// functions accept null NodeIds and ignore them.
class SceneBuilder : public ImportContext, NonCopyable {
 public:
  SceneBuilder(vrml::SceneGraph& scene, Diagnostics& diagnostics)
      : ImportContext(scene.file_name(), scene.budget(), diagnostics), scene_(scene) {}
  /// Passes the charged memory to the scene.
  ~SceneBuilder();

  [[nodiscard]] vrml::SceneGraph& scene() { return scene_; }

  /// Creates a node. At the node limit, returns null and adds a diagnostic the first time.
  vrml::NodeId make(vrml::NodeKind kind) { return make(vrml::built_in_node_type(kind)); }
  vrml::NodeId make(const vrml::NodeType& type);
  template <class T>
  void set(vrml::NodeId node, std::string_view field, T value) {
    if (node) scene_.set<T>(node, field, std::move(value));
  }
  /// Gives the node a unique DEF name derived from `text`. Replaces forbidden characters by '_'.
  void name(vrml::NodeId node, std::string_view text);
  void add_root(vrml::NodeId node) {
    if (node) scene_.add_root(node);
  }

  [[nodiscard]] vrml::NodeId appearance(const Look& look);
  /// Creates a geometry node. Drops faces, lines and points with missing or non-finite coordinates, and adds one
  /// warning per kind of loss. Returns null if no element remains.
  [[nodiscard]] vrml::NodeId geometry(Geometry data);
  /// Creates a geometry node of data that `keep_drawable` has accepted.
  [[nodiscard]] vrml::NodeId checked_geometry(Geometry data);
  [[nodiscard]] vrml::NodeId shape(vrml::NodeId geometry, vrml::NodeId appearance);

 private:
  vrml::SceneGraph& scene_;
  std::unordered_set<std::string> names_;
  bool full_ = false;
};

/// Converts linear light to display sRGB (IEC 61966-2-1); argument and result are 0..1.
[[nodiscard]] float display_of_linear(float linear);

}  // namespace gs::app
