#pragma once

#include "base/diagnostic.h"
#include "vrml/scene/values/field_value.h"

#include <string>
#include <string_view>
#include <vector>

namespace gs::vrml {

/// Statements of an X3D text besides nodes, PROTOs and ROUTEs (ISO/IEC 19775-1 7.2.5): what the text needs, its
/// metadata, units, and the nodes that it shares with other texts. Refers to nodes only by id.
struct X3DStatements {
  struct Component {
    std::string name;
    int level = 1;
  };
  struct Meta {
    std::string name, content;
  };
  struct Unit {
    std::string category, name;
    double factor = 1;  // size of the unit, in units of the standard (4.3.6): metres, radians, kilograms, newtons
  };
  /// IMPORT inline.exported AS local (4.4.6.2).
  struct Import {
    NodeId inline_node;
    std::string inline_name;  // DEF name of the Inline
    std::string exported, local;
    SourceLocation location;
  };
  /// EXPORT local AS exported (4.4.6.3).
  struct Export {
    NodeId node;  // null if `local` is an imported name
    std::string local, exported;
    SourceLocation location;
  };
  /// End of a ROUTE from or to an imported node. The node's type is unknown until its Inline is loaded.
  struct RouteEnd {
    NodeId node;       // null for an imported node
    std::string name;  // DEF name or imported name; for an imported node of a PROTO instance, its exported name
    std::string event;
    NodeId inline_node{};  // for an imported node of a PROTO instance: the Inline in this instance
  };
  struct ImportedRoute {
    RouteEnd from, to;
    SourceLocation location;
  };

  /// Returns the content of the first META with this name; empty if there is none.
  [[nodiscard]] std::string_view meta(std::string_view name) const {
    for (const Meta& each : metas)
      if (each.name == name) return each.content;
    return {};
  }
  /// Returns the size of the unit of a category: `length`, `angle`, `mass` or `force`. 1 without a UNIT statement.
  [[nodiscard]] double unit(std::string_view category) const {
    for (const Unit& each : units)
      if (each.category == category) return each.factor;
    return 1;
  }

  std::string profile;  // empty if the text states none
  std::vector<Component> components;
  std::vector<Meta> metas;
  std::vector<Unit> units;  // at most one of each category
  std::vector<Import> imports;
  std::vector<Export> exports;
  std::vector<ImportedRoute> routes;  // ROUTEs with an imported node
};

}  // namespace gs::vrml
