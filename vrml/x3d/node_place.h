#pragma once

#include "vrml/scene/node_type.h"

#include <array>
#include <string>
#include <string_view>

namespace gs::vrml::x3d {

/// Returns the default field of the parent for nodes of a type (`containerField` of ISO/IEC 19776-1). For PROTOs, the
/// first node of the body decides. Returns an empty text if it is unknown.
[[nodiscard]] std::string_view default_container(const NodeType& type);

/// Returns the field of `parent` that takes a node of `type`: `container` if it is set and fits, then the default
/// field, then the only field that accepts the type, then `children`. `type` may be null. Returns null if there is
/// none.
[[nodiscard]] const InterfaceDeclaration* place_of(const NodeType& parent, const NodeType* type,
                                                   std::string_view container);

/// Results of place_of() that were found last. One thread.
class RecentPlaces {
 public:
  /// Returns the result of place_of().
  [[nodiscard]] const InterfaceDeclaration* find(const NodeType& parent, const NodeType* type,
                                                 std::string_view container);

 private:
  /// Field for nodes of a built-in type in nodes of a built-in type. Such types never change.
  struct Place {
    const NodeType* parent = nullptr;
    const NodeType* type = nullptr;
    std::string container;
    const InterfaceDeclaration* field = nullptr;
  };
  std::array<Place, 64> places_{};
};

}  // namespace gs::vrml::x3d
