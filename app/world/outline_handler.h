#pragma once

#include "app/world/outline_reader.h"
#include "app/world/world_loading_state.h"

#include <memory>
#include <optional>
#include <span>
#include <string>

namespace gs::app {

/// Content handler for the polygons in the url of an OutlineGroup. It reads them into an own node and passes the node's
/// fields to the group. A running world gets them as updates.
class OutlineHandler final : public ContentHandler, public std::enable_shared_from_this<OutlineHandler> {
 public:
  /// Creates a handler for `group`. `file` and `location` are the group's, for messages. The new polygons follow those
  /// of `begin_with`, unless it is null.
  OutlineHandler(WorldLoading::State& world, ResourceUpdates::Place group, std::string file, SourceLocation location,
                 vrml::MFString urls, const vrml::Node* begin_with);
  ~OutlineHandler() override;
  bool begin(const Found& found) override;
  void receive(std::span<const std::byte> bytes) override;
  void receive_cells(const net::CellEvent& event) override;
  void end(const std::optional<std::string>& problem) override;
  void missing(const std::string& why) override;

  /// Returns the fields with the polygons received so far.
  void give();

 private:
  void has_come();

  WorldLoading::State& world_;
  ResourceUpdates::Place group_;
  std::string file_, name_;  // file of the group's text; name of the stream
  SourceLocation location_;
  vrml::MFString urls_;
  std::shared_ptr<vrml::SceneGraph> own_;
  vrml::NodeId node_;
  OutlineReader reader_;
};

}  // namespace gs::app
