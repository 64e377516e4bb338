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

/// Incremental reader of an outline stream. Adds the polygons to nodes of a scene.
class OutlineReader {
 public:
  /// Creates a reader. The OutlineGroup `node` receives all polygons. If it is null, the reader adds Shapes to the
  /// scene.
  OutlineReader(Loading& loading, vrml::SceneGraph& scene, vrml::NodeId node = {})
      : loading_(loading), outlines_(scene, loading.results.diagnostics(), node) {}

  void receive(std::span<const std::byte> bytes);
  void receive_piece(const net::CellEvent& event);
  /// Decodes the remaining bytes. `whole` is true if the stream is complete.
  void end(const std::string& file, bool whole);
  /// Returns the up axis that the stream defines, or nullopt.
  [[nodiscard]] std::optional<Upright> upright() const {
    return decoder_.header() ? stated_upright(decoder_.header()->description.metadata) : std::nullopt;
  }
  /// Returns the nodes with additional polygons since the last call.
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
