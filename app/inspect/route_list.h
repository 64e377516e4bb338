#pragma once

#include "app/inspect/event_watch.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace gs::app {

/// Returns the name of a node for display: its DEF name, else its type.
[[nodiscard]] std::string label_of(const NodeAt& node);

/// List of the ROUTEs of a world (VRML97 4.10.2), with their activity. Includes ROUTEs in Inlines and in PROTO bodies.
/// World's thread.
class RouteList {
 public:
  struct Row {
    NodeAt from, to;
    const vrml::InterfaceDeclaration* event_out = nullptr;
    const vrml::InterfaceDeclaration* event_in = nullptr;
  };
  /// Updates the list, which has all ROUTEs or only those of the selected node. Rebuilds it only after ROUTEs have
  /// changed.
  void refresh(const vrml::Execution* world, const NodeAt& selected = {});
  /// Sets whether the list has only ROUTEs of the selected node.
  void set_only_selected(bool only) { only_selected_ = only; }
  [[nodiscard]] bool only_selected() const { return only_selected_; }
  [[nodiscard]] const std::vector<Row>& rows() const { return rows_; }
  /// Returns the number of ROUTEs in the world, even if `rows` has only those of one node.
  [[nodiscard]] std::size_t all() const { return all_; }
  /// Returns the number of times that the list was rebuilt.
  [[nodiscard]] std::uint64_t made() const { return made_; }

  /// Returns the highlight of a row. It is 1 at an event, and falls to 0 within half a second.
  [[nodiscard]] static float light_of(const Row& row, const EventWatch& watch, double now);

 private:
  const vrml::Execution* world_ = nullptr;
  NodeAt only_;
  bool only_selected_ = false;
  std::uint64_t revision_ = 0, made_ = 0;
  std::size_t all_ = 0;
  std::vector<Row> rows_;
};

}  // namespace gs::app
