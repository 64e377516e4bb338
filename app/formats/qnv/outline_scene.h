#pragma once

#include "base/diagnostic.h"
#include "qnv/codecs/outlines/outline_stream.h"
#include "vrml/scene/scene_graph.h"

#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

namespace gs::app {

/// Builder of OutlineGroup nodes from the polygons of a stream, while they are received. Makes one Shape per
/// appearance, or adds all polygons to one node. Belongs to the thread of the scene.
class OutlineScene {
 public:
  /// Creates a builder. The OutlineGroup `node` gets all polygons. If it is null, the builder adds Shapes to the scene.
  OutlineScene(vrml::SceneGraph& scene, Diagnostics& diagnostics, vrml::NodeId node = {})
      : scene_(scene), diagnostics_(diagnostics), node_(node) {}

  /// Adds polygons from the stream with this header.
  void add(const qnv::OutlineHeader& header, const std::vector<qnv::OutlineBatch>& batches);
  /// Marks the end of the stream.
  void complete();
  /// Returns all nodes with polygons.
  [[nodiscard]] std::vector<vrml::NodeId> nodes() const;
  /// Returns true if polygons were dropped because the scene's budget is exhausted.
  [[nodiscard]] bool full() const { return full_; }

 private:
  /// Node that gets polygons. It numbers its outline groups in the order of their first polygon.
  struct Target {
    vrml::NodeId node;
    std::unordered_map<std::uint32_t, std::int32_t> groups;
  };
  Target* target_of(const qnv::OutlineHeader& header, std::uint32_t appearance);
  void add(Target& target, const qnv::OutlineBatch& batch);
  std::int32_t group_of(Target& target, std::uint32_t group, std::uint32_t count);

  vrml::SceneGraph& scene_;
  Diagnostics& diagnostics_;
  vrml::NodeId node_;
  bool full_ = false;
  std::unordered_map<std::uint32_t, Target> targets_;  // by appearance; only entry 0 if one node gets all polygons
};

}  // namespace gs::app
