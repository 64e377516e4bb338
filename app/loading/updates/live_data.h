#pragma once

#include <string>

namespace gs::vrml {
class SceneGraph;
}

namespace gs::app {

/// Returns the relative URL of the JSON resource of a running simulation (docs/insitu.md). A WorldInfo of the world has
/// the URL in its `info`, as "live data: URL". Returns "" if there is none.
[[nodiscard]] std::string live_data_of(const vrml::SceneGraph& scene);

}  // namespace gs::app
