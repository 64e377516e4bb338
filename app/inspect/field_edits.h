#pragma once

#include "vrml/scene/node_names.h"
#include "vrml/scene/scene_graph.h"

#include <optional>
#include <string>
#include <variant>

// Parsing and validation of field values that the user enters.
namespace gs::app {

/// Returns the eventIn that sets a field: the exposedField itself, or `set_x` for a field x (VRML97 4.7). Returns null
/// if nothing sets the field.
[[nodiscard]] const vrml::InterfaceDeclaration* setter_of(const vrml::NodeType& type,
                                                          const vrml::InterfaceDeclaration& field);
/// Returns the field that keeps the value of an eventIn: the exposedField itself, or the field x of a built-in node for
/// `set_x`. Returns null if the eventIn sets no field.
[[nodiscard]] const vrml::InterfaceDeclaration* field_set_by(const vrml::NodeType& type,
                                                             const vrml::InterfaceDeclaration& event_in);
/// Returns one line of text that explains why a field without setter cannot be set.
[[nodiscard]] std::string why_not_set(const vrml::InterfaceDeclaration& field);

/// Checks a value for an eventIn or exposedField. If the standard defines a range, the value must be inside it.
/// Otherwise, numbers must be finite, colours within 0..1 (5.3), and rotations need an axis (5.8). Returns a message if
/// the value is invalid.
[[nodiscard]] std::optional<std::string> why_not_valid(const vrml::NodeType& type,
                                                       const vrml::InterfaceDeclaration& event_in,
                                                       const vrml::FieldValue& value);
/// Parses a text that the user has entered, and checks the value. Returns the value, or an error message.
[[nodiscard]] std::variant<vrml::FieldValue, std::string> read_edit(const vrml::NodeType& type,
                                                                    const vrml::InterfaceDeclaration& event_in,
                                                                    const std::string& text, vrml::NodeNames& names);

}  // namespace gs::app
