#pragma once

#include "app/session/session.h"
#include "app/viewer/viewer.h"

#include <glm/vec2.hpp>

#include <cstddef>
#include <string>
#include <variant>
#include <vector>

namespace gs::app {

/// Draws a view and returns the bytes of a PNG file, or an error. The renderer's context must be current.
[[nodiscard]] std::variant<std::vector<std::byte>, std::string> paint(render::Renderer& renderer,
                                                                      const ViewerOptions& options, const View& view,
                                                                      const glm::ivec2& size);

/// Runs a session without a window in real time, until a client, SIGINT or SIGTERM ends it. `backend` names the
/// renderer for pictures that clients request. Returns the exit status: 0, or 1 with the reason in `error` if control
/// or the world cannot be opened. Main thread.
[[nodiscard]] int run_headless(const ViewerOptions& options, const LoadOptions& load, const std::string& backend,
                               std::string& error);

}  // namespace gs::app
