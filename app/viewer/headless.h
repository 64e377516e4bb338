#pragma once

#include "app/session/session.h"
#include "app/viewer/viewer.h"

#include <glm/vec2.hpp>

#include <cstddef>
#include <string>
#include <variant>
#include <vector>

namespace gs::app {

/// Draws `list` from the camera of a view, and returns the bytes of a PNG file, or an error message. The context of the
/// renderer must be current.
[[nodiscard]] std::variant<std::vector<std::byte>, std::string> paint(render::Renderer& renderer,
                                                                      const ViewerOptions& options, const View& view,
                                                                      const render::RenderList& list,
                                                                      const glm::ivec2& size);

/// Runs a session in real time without a window, until a client, SIGINT or SIGTERM ends it. `backend` is the name of
/// the renderer for pictures that clients request. Returns the exit status. It is 1, with the reason in `error`, if the
/// sockets for clients or the world cannot be opened. Main thread.
[[nodiscard]] int run_headless(const ViewerOptions& options, const LoadOptions& load, const std::string& backend,
                               std::string& error);

}  // namespace gs::app
