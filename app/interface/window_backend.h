#pragma once

#include "app/interface/ui_overlay.h"

struct GLFWwindow;

namespace gs::app {

/// Creates the backend of a window with a current OpenGL context. The backend handles only window size and cursor;
/// events are passed through UiOverlay.
[[nodiscard]] std::unique_ptr<InterfaceBackend> make_window_backend(GLFWwindow* window);

}  // namespace gs::app
