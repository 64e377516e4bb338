#pragma once

#include "vrml/scene/scene_graph.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <variant>

// Values of fields by name, for node types that are too rare for a row of the schema table (collect_schema.h).
namespace gs::render {

/// Returns the value of a field; null if the type has no such field.
template <class T>
const T* field(const vrml::Node& node, std::string_view name) {
  const vrml::InterfaceDeclaration* declaration = node.type->find_field(name);
  return declaration ? std::get_if<T>(&node.values[declaration->slot]) : nullptr;
}

/// Returns an SFFloat within the limits `low` and `high`; `otherwise` if there is none or it is not finite.
inline float number(const vrml::Node& node, std::string_view name, float low, float high, float otherwise) {
  const auto* value = field<vrml::SFFloat>(node, name);
  return value && std::isfinite(*value) ? std::clamp(*value, low, high) : otherwise;
}

/// Row of a table that maps names of the standard to values.
template <class E>
struct Named {
  std::string_view name;
  E value;
};

/// Returns the value of a name in a table; `otherwise` if the table lacks it.
template <class E, std::size_t n>
E named(const std::array<Named<E>, n>& table, std::string_view name, E otherwise) {
  for (const Named<E>& row : table)
    if (row.name == name) return row.value;
  return otherwise;
}

}  // namespace gs::render
