#pragma once

#include "render/draw/renderer.h"
#include "render/gl/context.h"

#include <memory>
#include <string>

namespace gs::app {

/// What draws without a window; `problem` where there is no renderer.
struct OpenedRenderer {
  std::unique_ptr<render::GlContext> context;
  std::unique_ptr<render::Renderer> renderer;
  std::string problem;

  OpenedRenderer() = default;
  OpenedRenderer(OpenedRenderer&&) = default;
  OpenedRenderer& operator=(OpenedRenderer&&) = delete;
  ~OpenedRenderer() { renderer.reset(); }  // while its context is there
};

/// A context that is current nowhere, whose renderer is ready for pictures such as are wanted. Any thread.
[[nodiscard]] OpenedRenderer open_renderer(const std::string& backend, const render::DrawOptions& draw);

}  // namespace gs::app
