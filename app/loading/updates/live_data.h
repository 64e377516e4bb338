#pragma once

#include <string>
#include <string_view>

namespace gs::vrml {
class SceneGraph;
}

namespace gs::app {

/// Returns the relative URL of the JSON resource of a running simulation (docs/insitu.md). A WorldInfo of the world has
/// the URL in its `info`, as "live data: URL". Returns "" if there is none.
[[nodiscard]] std::string live_data_of(const vrml::SceneGraph& scene);

/// Extension of the file in which a running simulation writes the address of its server for `ssh://` (docs/insitu.md).
inline constexpr std::string_view kLiveFileEnding = ".live";
/// Appends a slash to an ssh: URL with kLiveFileEnding, because the resources of the simulation are below it. Returns
/// other URLs unchanged.
[[nodiscard]] std::string live_address(const std::string& url);

}  // namespace gs::app
