#pragma once

#include "app/inspect/event_watch.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace gs::app {

/// Returns the display name of a node: its DEF name, else its type.
[[nodiscard]] std::string label_of(const NodeAt& node);

/// ROUTEs of a world (VRML97 4.10.2), including those in Inlines and PROTO bodies, with their activity. Use on the
/// world's thread.
class RouteList {
 public:
  struct Row {
    NodeAt from, to;
    const vrml::InterfaceDeclaration* event_out = nullptr;
    const vrml::InterfaceDeclaration* event_in = nullptr;
  };
  /// Updates the list, of all ROUTEs or those of the selected node. Rebuilds it only if ROUTEs changed.
  void refresh(const vrml::Execution* world, const NodeAt& selected = {});
  /// Limits the list to ROUTEs of the selected node.
  void set_only_selected(bool only) { only_selected_ = only; }
  [[nodiscard]] bool only_selected() const { return only_selected_; }
  [[nodiscard]] const std::vector<Row>& rows() const { return rows_; }
  /// Returns the number of ROUTEs in the world, even if `rows` shows only those of one node.
  [[nodiscard]] std::size_t all() const { return all_; }
  /// Returns how many times the list was rebuilt.
  [[nodiscard]] std::uint64_t made() const { return made_; }

  /// Returns the highlight of a row: 1 for an event now, fading to 0 after half a second.
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
