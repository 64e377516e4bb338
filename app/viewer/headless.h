#pragma once

#include "app/session/session.h"
#include "app/viewer/viewer.h"

#include <glm/vec2.hpp>

#include <cstddef>
#include <string>
#include <variant>
#include <vector>

namespace gs::app {

[[nodiscard]] SessionOptions session_options(const ViewerOptions& options);
/// A picture of a view, as a file of PNG. The renderer's context must be current.
[[nodiscard]] std::variant<std::vector<std::byte>, std::string> paint(render::Renderer& renderer,
                                                                      const ViewerOptions& options, const View& view,
                                                                      const glm::ivec2& size);

/// A session without a window that others control, in real time: until one of them ends it, or SIGINT or SIGTERM does.
/// `backend`: what draws when a picture is asked for. Main thread. Returns the exit status: 0, or 1 with the reason in
/// `error`: it cannot be controlled, or there is no world.
[[nodiscard]] int run_headless(const ViewerOptions& options, const LoadOptions& load, const std::string& backend,
                               std::string& error);

}  // namespace gs::app
