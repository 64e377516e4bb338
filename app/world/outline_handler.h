#pragma once

#include "app/world/outline_reader.h"
#include "app/world/world_loading_state.h"

#include <memory>
#include <optional>
#include <span>
#include <string>

namespace gs::app {

/// Reads the polygons that the url of an OutlineGroup names, into a node of its own, whose fields the group gets: at
/// once, or where it lives already, with the arrivals.
class OutlineHandler final : public ContentHandler, public std::enable_shared_from_this<OutlineHandler> {
 public:
  /// `file`, `location`: of the group, for messages. `begin_with`: whose polygons stand in front; null: there are none.
  OutlineHandler(WorldLoading::State& world, Arrivals::Place group, std::string file, vrml::SourceLocation location,
                 vrml::MFString urls, const vrml::Node* begin_with);
  ~OutlineHandler() override;
  bool begin(const Found& found) override;
  void receive(std::span<const std::byte> bytes) override;
  void receive_cells(const net::CellEvent& event) override;
  void end(const std::optional<std::string>& problem) override;
  void missing(const std::string& why) override;

  /// What has come so far.
  void give();

 private:
  void has_come();

  WorldLoading::State& world_;
  Arrivals::Place group_;
  std::string file_, name_;  // of the group's text; of the stream
  vrml::SourceLocation location_;
  vrml::MFString urls_;
  std::shared_ptr<vrml::SceneGraph> own_;
  vrml::NodeId node_;
  OutlineReader reader_;
};

}  // namespace gs::app
