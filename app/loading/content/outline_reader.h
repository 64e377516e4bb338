#pragma once

#include "app/formats/common/upright.h"
#include "app/formats/qnv/outline_scene.h"
#include "app/loading/fetch/loading.h"
#include "qnv/codecs/outlines/outline_stream.h"

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gs::app {

/// Incremental reader that adds the polygons of a stream of outlines to nodes of a scene.
class OutlineReader {
 public:
  /// Creates a reader. `node` is the OutlineGroup that receives all polygons; null adds Shapes to the scene.
  OutlineReader(Loading& loading, vrml::SceneGraph& scene, vrml::NodeId node = {})
      : loading_(loading), outlines_(scene, loading.results.diagnostics(), node) {}

  void receive(std::span<const std::byte> bytes);
  void receive_cells(const net::CellEvent& event);
  /// Reads the bytes received so far. `whole` is true if no more can follow.
  void end(const std::string& file, bool whole);
  /// Returns the up axis that the stream gives, or nullopt.
  [[nodiscard]] std::optional<Upright> upright() const {
    return decoder_.header() ? stated_upright(decoder_.header()->description.metadata) : std::nullopt;
  }
  /// Returns the nodes that got more polygons since the last call.
  [[nodiscard]] std::vector<vrml::NodeId> take_changed();
  [[nodiscard]] bool empty() const { return outlines_.nodes().empty(); }

 private:
  void show();

  Loading& loading_;
  qnv::OutlineDecoder decoder_;
  OutlineScene outlines_;
  bool changed_ = false;
};

}  // namespace gs::app
