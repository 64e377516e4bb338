#pragma once

#include "app/session/documents/documents.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

/// Text of an opened world with the edits of the user.
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
  std::vector<std::string> losses = {};  // properties that the format lacks, as messages for the user
};

/// Returns the text of a world for a file `target`, or an error message. If both files are VRML97, it is the text of
/// the world's file with the edited values. Otherwise, or if this text cannot be changed so, the nodes of the world are
/// printed in the format of `target`. Relative URLs of existing files are adapted to the folder of `target`. World's
/// thread.
[[nodiscard]] std::variant<WorldText, std::string> world_text(Document& document, const std::string& target);

}  // namespace gs::app
