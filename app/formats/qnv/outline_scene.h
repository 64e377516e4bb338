#pragma once

#include "base/diagnostic.h"
#include "qnv/codecs/outlines/outline_stream.h"
#include "vrml/scene/scene_graph.h"

#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

namespace gs::app {

/// Builder of OutlineGroup nodes from the polygons of a stream, as they are received: one Shape per appearance, or one
/// node for all. Belongs to the thread that owns the scene.
class OutlineScene {
 public:
  /// `node` is an OutlineGroup for all polygons; if null, adds Shapes to the scene.
  OutlineScene(vrml::SceneGraph& scene, Diagnostics& diagnostics, vrml::NodeId node = {})
      : scene_(scene), diagnostics_(diagnostics), node_(node) {}

  /// Adds polygons of the stream with this header.
  void add(const qnv::OutlineHeader& header, const std::vector<qnv::OutlineBatch>& batches);
  /// Marks the end of the stream.
  void complete();
  /// Returns the nodes that have polygons.
  [[nodiscard]] std::vector<vrml::NodeId> nodes() const;
  /// Reports whether polygons were dropped because the scene's budget is spent.
  [[nodiscard]] bool full() const { return full_; }

 private:
  /// Node that receives polygons. It numbers its groups in the order received.
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
  std::unordered_map<std::uint32_t, Target> targets_;  // by appearance; a single entry 0 if one node takes all
};

}  // namespace gs::app
