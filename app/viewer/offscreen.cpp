#include "app/viewer/offscreen.h"

#include <utility>
#include <variant>

namespace gs::app {

OpenedRenderer open_renderer(const std::string& backend, const render::DrawOptions& draw) {
  OpenedRenderer result;
  auto opened = render::open_headless_context(backend);
  if (auto* problem = std::get_if<render::ContextError>(&opened)) {
    result.problem = std::move(problem->message);
    return result;
  }
  result.context = std::move(std::get<std::unique_ptr<render::GlContext>>(opened));
  auto created = render::Renderer::create(*result.context);
  if (auto* problem = std::get_if<render::ContextError>(&created)) {
    result.problem = std::move(problem->message);
  } else {
    result.renderer = std::move(std::get<std::unique_ptr<render::Renderer>>(created));
    result.renderer->prepare(draw);
  }
  result.context->release_current();
  return result;
}

}  // namespace gs::app
