#pragma once

#include "render/draw/renderer.h"
#include "render/gl/context.h"

#include <memory>
#include <string>

namespace gs::app {

/// Renderer without a window. If there is none, `problem` is the reason.
struct OpenedRenderer {
  std::unique_ptr<render::GlContext> context;
  std::unique_ptr<render::Renderer> renderer;
  std::string problem;

  OpenedRenderer() = default;
  OpenedRenderer(OpenedRenderer&&) = default;
  OpenedRenderer& operator=(OpenedRenderer&&) = delete;
  ~OpenedRenderer() { renderer.reset(); }  // destroys the renderer before its context
};

/// Opens a renderer that can draw with the options `draw`. The caller may be any thread; afterwards the renderer's
/// context is current on no thread.
[[nodiscard]] OpenedRenderer open_renderer(const std::string& backend, const render::DrawOptions& draw);

}  // namespace gs::app
