#pragma once

#include "app/inspect/event_watch.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace gs::app {

/// What lines call a node: its DEF name, else its type.
[[nodiscard]] std::string label_of(const NodeAt& node);

/// The ROUTEs of a world (VRML97 4.10.2), of its Inlines and of bodies of PROTO instances among them, and which of them
/// events go by. One thread, that of the world.
class RouteList {
 public:
  struct Row {
    NodeAt from, to;
    const vrml::InterfaceDeclaration* event_out = nullptr;
    const vrml::InterfaceDeclaration* event_in = nullptr;
  };
  /// All of the world, or those of one node; made anew only where they are others than before.
  void refresh(const vrml::Execution* world, const NodeAt& only = {});
  [[nodiscard]] const std::vector<Row>& rows() const { return rows_; }
  /// Of the world; more than `rows` where only those of a node are shown.
  [[nodiscard]] std::size_t all() const { return all_; }
  /// How often the list was made.
  [[nodiscard]] std::uint64_t made() const { return made_; }

  /// "Clock.fraction_changed -> Door.set_fraction"
  [[nodiscard]] static std::string text_of(const Row& row);
  /// How lately an event went by, 1 now to 0 half a second ago and before.
  [[nodiscard]] static float light_of(const Row& row, const EventWatch& watch, double now);

 private:
  const vrml::Execution* world_ = nullptr;
  NodeAt only_;
  std::uint64_t revision_ = 0, made_ = 0;
  std::size_t all_ = 0;
  std::vector<Row> rows_;
};

}  // namespace gs::app
