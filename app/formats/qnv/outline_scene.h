#pragma once

#include "qnv/outline/outline_stream.h"
#include "vrml/scene/diagnostic.h"
#include "vrml/scene/scene_graph.h"

#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

namespace gs::app {

/// Makes OutlineGroup nodes of the polygons of a stream, as they come: a Shape for every appearance, or all polygons in
/// one node. Belongs to the thread that owns the scene.
class OutlineScene {
 public:
  /// `node`: an OutlineGroup that takes everything; null: Shapes of the scene's own.
  OutlineScene(vrml::SceneGraph& scene, vrml::Diagnostics& diagnostics, vrml::NodeId node = {})
      : scene_(scene), diagnostics_(diagnostics), node_(node) {}

  /// Adds polygons of the stream with this header.
  void add(const qnv::OutlineHeader& header, const std::vector<qnv::OutlineBatch>& batches);
  /// No more come.
  void complete();
  /// The nodes that have polygons.
  [[nodiscard]] std::vector<vrml::NodeId> nodes() const;
  /// Whether polygons were left out because the scene's budget is spent.
  [[nodiscard]] bool full() const { return full_; }

 private:
  /// A node that takes polygons. Groups have numbers of their own in it, in the order in which they came.
  struct Target {
    vrml::NodeId node;
    std::unordered_map<std::uint32_t, std::int32_t> groups;
  };
  Target* target_of(const qnv::OutlineHeader& header, std::uint32_t appearance);
  void add(Target& target, const qnv::OutlineBatch& batch);
  std::int32_t group_of(Target& target, std::uint32_t group, std::uint32_t count);

  vrml::SceneGraph& scene_;
  vrml::Diagnostics& diagnostics_;
  vrml::NodeId node_;
  bool full_ = false;
  std::unordered_map<std::uint32_t, Target> targets_;  // by appearance; one at 0 where there is a node for all
};

}  // namespace gs::app
