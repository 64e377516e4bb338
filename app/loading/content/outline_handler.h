#pragma once

#include "app/loading/content/scene_context.h"
#include "app/loading/resources/outline_reader.h"
#include "app/loading/resources/resource_handler.h"

#include <memory>
#include <optional>
#include <span>
#include <string>

namespace gs::app {

/// Content handler for the url of an OutlineGroup. Collects the polygons in a temporary node and copies that node's
/// fields to the group. A running world gets the fields as updates.
class OutlineHandler final : public ResourceHandler, public std::enable_shared_from_this<OutlineHandler> {
 public:
  /// Creates a handler for the group of `request`. The new polygons follow those of `begin_with`, unless it is null.
  OutlineHandler(SceneContext& context, const UrlRequest& request, const vrml::Node* begin_with);
  ~OutlineHandler() override;
  bool begin(const Found& found) override;
  void receive(std::span<const std::byte> bytes) override;
  void receive_piece(const net::CellEvent& event) override;
  void end(const std::optional<std::string>& problem) override;
  void missing(const std::string& why) override;

  /// Adds the fields with the polygons received so far to the results.
  void give();
  [[nodiscard]] const ResourceUpdates::Place& group() const { return request_.place; }

 private:
  void has_come();

  SceneContext& context_;
  std::shared_ptr<vrml::SceneGraph> own_;
  vrml::NodeId node_;
  OutlineReader reader_;
};

}  // namespace gs::app
