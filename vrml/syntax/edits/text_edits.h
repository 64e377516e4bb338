#pragma once

#include "base/diagnostic.h"

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace gs::vrml {

/// New value of one field in a VRML97 text.
struct TextEdit {
  SourceLocation location;  // of the type name of a node, or of the name in a PROTO or EXTERNPROTO
  std::string name;         // name that the text has there
  std::string field;        // field of the node, or field of the PROTO; empty means the url list of the EXTERNPROTO
  std::string value;        // VRML97 text
};

/// Returns the text with new values of fields. Other text stays as it is, comments included. Adds a field to a node
/// that does not set the field. Leaves a field with IS alone. Returns nullopt if the text has another name at a
/// location, if a node is malformed, or if one edit is inside the value of another edit.
[[nodiscard]] std::optional<std::string> edited_text(std::string_view text, std::span<const TextEdit> edits);

}  // namespace gs::vrml
