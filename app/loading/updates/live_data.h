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

/// Ending of the file that a running simulation writes for `ssh://` (docs/insitu.md). It has the address of its server.
inline constexpr std::string_view kLiveFileEnding = ".live";
/// Returns the URL with a slash at its end if it names such a file of an account, because the files of the simulation
/// are below it. Returns other URLs unchanged.
[[nodiscard]] std::string live_address(const std::string& url);

}  // namespace gs::app
