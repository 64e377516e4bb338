#pragma once

#include "vrml/scene/scene_graph.h"
#include "vrml/syntax/edits/text_edits.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// Returns a relative URL of a world in `source`, so that it leads to the same file from a world in the file `target`.
/// Returns other URLs unchanged, and those of local files that do not exist. `source` is a path or URL.
[[nodiscard]] std::string moved_url(std::string_view url, const std::string& source, const std::string& target);

/// Returns a list with moved_url() of each URL, or nullopt if no URL changes.
[[nodiscard]] std::optional<vrml::MFString> moved_list(const vrml::MFString& urls, const std::string& source,
                                                       const std::string& target);

/// Reports whether relative URLs in both files lead to the same files. `source` is a path or URL.
[[nodiscard]] bool have_one_folder(const std::string& source, const std::string& target);

/// Returns the changes of a world's text that adapt its URLs with moved_url(). They concern nodes, EXTERNPROTOs and the
/// defaults of PROTOs. `scene` is the parsed text. Returns no changes if both files are in one folder.
[[nodiscard]] std::vector<vrml::TextEdit> moved_urls(const vrml::SceneGraph& scene, const std::string& source,
                                                     const std::string& target);

}  // namespace gs::app
