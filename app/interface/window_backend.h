#pragma once

#include "app/interface/ui_overlay.h"

struct GLFWwindow;

namespace gs::app {

/// Creates the backend for a window with a current context. It handles only window size and cursor; events come through
/// UiOverlay.
[[nodiscard]] std::unique_ptr<InterfaceBackend> make_window_backend(GLFWwindow* window);

}  // namespace gs::app
