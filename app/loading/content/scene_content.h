#pragma once

#include "app/formats/content_types.h"
#include "app/loading/fetch/content_handler.h"
#include "vrml/scene/scene_graph.h"

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gs::app {

class SceneTarget;

/// Reader of one kind of file into the nodes of a scene.
class SceneContent {
 public:
  SceneContent() = default;
  SceneContent(const SceneContent&) = delete;
  SceneContent& operator=(const SceneContent&) = delete;
  virtual ~SceneContent() = default;

  /// Reads a local file as a whole. Returns false to receive it in pieces instead.
  virtual bool whole_file(const net::MappedFile&, const std::string&) { return false; }
  virtual void receive(std::span<const std::byte> bytes) = 0;
  /// Ends the file. `damaged` is true if bytes are missing for a problem; `cut` if they are on purpose.
  virtual void end(bool damaged) = 0;
  virtual void receive_piece(const net::CellEvent&) {}
  /// See ContentHandler.
  [[nodiscard]] virtual bool has_more() const { return false; }
  virtual void read_more() {}
  virtual std::shared_ptr<StreamFeed> feed() { return nullptr; }
  virtual bool take_parts(const PartsOffer&) { return false; }
  /// Returns the nodes with incomplete fields.
  [[nodiscard]] virtual std::vector<vrml::NodeId> open_nodes() const { return {}; }

  bool cut = false;  // see ContentHandler
};

/// Creates the reader for a file of this type. `first` are its first bytes.
[[nodiscard]] std::unique_ptr<SceneContent> content_for(SceneTarget& target, const ContentType& type,
                                                        std::span<const std::byte> first);

}  // namespace gs::app
