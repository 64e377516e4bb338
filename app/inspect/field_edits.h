#pragma once

#include "vrml/events/node_names.h"
#include "vrml/scene/scene_graph.h"

#include <optional>
#include <string>
#include <variant>

// What somebody types in the place of a field's value, and whether it may be sent.
namespace gs::app {

/// The eventIn by which a field or eventIn of the node is set: an exposedField by itself, a field x by `set_x` (VRML97
/// 4.7). Null: by none.
[[nodiscard]] const vrml::InterfaceDeclaration* setter_of(const vrml::NodeType& type,
                                                          const vrml::InterfaceDeclaration& field);
/// Why nobody can set it, in a line; for those whose setter_of is null.
[[nodiscard]] std::string why_not_set(const vrml::InterfaceDeclaration& field);

/// What is wrong with a value for an eventIn or exposedField of this type, which the range that the standard prints
/// beside the field does not allow; nothing: it is fine. Also numbers that are not finite, colours beyond 0 to 1 (5.3)
/// and rotations without an axis (5.8), in fields without a range.
[[nodiscard]] std::optional<std::string> why_not_valid(const vrml::NodeType& type,
                                                       const vrml::InterfaceDeclaration& event_in,
                                                       const vrml::FieldValue& value);
/// The value that a text is, or why it is none.
[[nodiscard]] std::variant<vrml::FieldValue, std::string> read_edit(const vrml::NodeType& type,
                                                                    const vrml::InterfaceDeclaration& event_in,
                                                                    const std::string& text, vrml::NodeNames& names);

}  // namespace gs::app
