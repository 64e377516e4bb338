#pragma once

#include "app/control/json_text.h"
#include "vrml/scene/values/field_value.h"

#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace gs::app {

// JSON form of field values (VRML97 clause 5).
//
// SFBool is true or false; SFFloat, SFInt32 and SFTime are a number; SFString is a string. SFColor, SFRotation, SFVec2f
// and SFVec3f are a list of 3, 4, 2 and 3 numbers. SFImage is a list of width, height, components and one number per
// pixel. SFNode has the form of ReadNode and WriteNode, or is null. MF types are lists of these.
//
// Lists of colours, rotations and vectors may also be flat: [1,2,3,4,5,6] for [[1,2,3],[4,5,6]].

/// Function that reads a node from JSON. If there is no valid node, returns nullopt and sets `problem`.
using ReadNode = std::function<std::optional<vrml::NodeId>(JsonCursor& json, std::string& problem)>;
/// Function that appends a node as JSON. Not called for NULL.
using WriteNode = std::function<void(std::string& out, vrml::NodeId node)>;

/// Reads a value of a field type, and moves to its end. Numbers must be finite in that type. If the value is wrong,
/// returns nullopt and sets `problem` to the expected form. The position of the cursor is then undefined.
[[nodiscard]] std::optional<vrml::FieldValue> read_json_value(JsonCursor& json, vrml::FieldType type,
                                                              const ReadNode& node, std::string& problem);
/// Appends a value as JSON on one line.
void append_json_value(std::string& out, const vrml::FieldValue& value, const WriteNode& node);

}  // namespace gs::app
