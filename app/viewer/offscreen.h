#pragma once

#include "render/draw/renderer.h"
#include "render/gl/context.h"

#include <memory>
#include <string>

namespace gs::app {

/// Renderer without a window; `problem` is set if there is none.
struct OpenedRenderer {
  std::unique_ptr<render::GlContext> context;
  std::unique_ptr<render::Renderer> renderer;
  std::string problem;

  OpenedRenderer() = default;
  OpenedRenderer(OpenedRenderer&&) = default;
  OpenedRenderer& operator=(OpenedRenderer&&) = delete;
  ~OpenedRenderer() { renderer.reset(); }  // destroyed while its context exists
};

/// Opens a renderer that can draw pictures with `draw`. Its context is not current on any thread afterwards. Any
/// thread.
[[nodiscard]] OpenedRenderer open_renderer(const std::string& backend, const render::DrawOptions& draw);

}  // namespace gs::app
