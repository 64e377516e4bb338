#pragma once

#include "app/interface/ui_overlay.h"

struct GLFWwindow;

namespace gs::app {

/// For a window whose context is current. It hears of the window's size and cursor alone: events come by UiOverlay.
[[nodiscard]] std::unique_ptr<InterfaceBackend> make_window_backend(GLFWwindow* window);

}  // namespace gs::app
