#pragma once

#include "app/session/documents/documents.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <variant>

/// VRML97 text of an opened world with the edits of the user.
namespace gs::app {

/// Returns the decompressed text of a local VRML97 file. Returns null for other files, and if the file does not have
/// `bytes` bytes, as when it was opened; 0 means any size.
[[nodiscard]] std::shared_ptr<const std::string> source_text(const std::string& path, std::size_t bytes = 0);

/// Stores the source text of a world in its WorldEdits. Call before the first edit. Later calls do nothing.
void keep_source_text(Document& document);

/// Text of a world to be saved.
struct WorldText {
  std::string text;
  bool is_source = false;    // the text of the file, in which only edited values differ; otherwise printed nodes
  std::size_t left_out = 0;  // edits of nodes that the file does not contain, such as the nodes of Inlines
};

/// Returns the text of a world for a file `target`, or an error message. It is the text of the world's file with the
/// edited values. If the file is no VRML97 text, or cannot be changed so, the nodes of the world are printed. Relative
/// URLs of existing files are adapted to the folder of `target`. World's thread.
[[nodiscard]] std::variant<WorldText, std::string> world_text(Document& document, const std::string& target);

}  // namespace gs::app
