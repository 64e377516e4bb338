#pragma once

#include "app/control/json_text.h"
#include "vrml/scene/field_value.h"

#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace gs::app {

// Values of fields (VRML97 clause 5) in JSON: SFBool true or false; SFFloat, SFInt32 and SFTime a number; SFString a
// string; SFColor, SFRotation, SFVec2f and SFVec3f a list of 3, 4, 2 and 3 numbers; SFImage a list of width, height,
// components and a number a pixel; SFNode what the reader and writer of nodes make of it, or null; MF types lists of
// these. Lists of colours, rotations and vectors may also be flat: [1,2,3,4,5,6] for [[1,2,3],[4,5,6]].

/// A node of JSON; nothing, and `problem`, where it is none.
using ReadNode = std::function<std::optional<vrml::NodeId>(JsonCursor& json, std::string& problem)>;
/// Appends a node that is not NULL.
using WriteNode = std::function<void(std::string& out, vrml::NodeId node)>;

/// Reads a value, and goes behind it; numbers must be finite in their type. Nothing, and in `problem` what was
/// expected, where the text is another one: then the place is undefined.
[[nodiscard]] std::optional<vrml::FieldValue> read_json_value(JsonCursor& json, vrml::FieldType type,
                                                              const ReadNode& node, std::string& problem);
/// Appends a value on one line.
void append_json_value(std::string& out, const vrml::FieldValue& value, const WriteNode& node);

}  // namespace gs::app
