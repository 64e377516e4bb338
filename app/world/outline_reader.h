#pragma once

#include "app/formats/common/upright.h"
#include "app/formats/qnv/outline_scene.h"
#include "app/world/world_loading_state.h"
#include "qnv/outline/outline_stream.h"

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gs::app {

/// Reads a stream of outlines into nodes of a scene, as it comes.
class OutlineReader {
 public:
  /// `node`: an OutlineGroup that takes all polygons; null: Shapes of the scene's own.
  OutlineReader(WorldLoading::State& world, vrml::SceneGraph& scene, vrml::NodeId node = {})
      : world_(world), outlines_(scene, world.world.diagnostics, node) {}

  void receive(std::span<const std::byte> bytes);
  void receive_cells(const net::CellEvent& event);
  /// `whole`: nothing is missing that might still come.
  void end(const std::string& file, bool whole);
  /// How what it shows stands, if the stream says so.
  [[nodiscard]] std::optional<Upright> upright() const {
    return decoder_.header() ? stated_upright(decoder_.header()->description.metadata) : std::nullopt;
  }
  /// Nodes that have got more polygons since this was last asked.
  [[nodiscard]] std::vector<vrml::NodeId> take_changed();
  [[nodiscard]] bool empty() const { return outlines_.nodes().empty(); }

 private:
  void show();

  WorldLoading::State& world_;
  qnv::OutlineDecoder decoder_;
  OutlineScene outlines_;
  bool changed_ = false;
};

}  // namespace gs::app
