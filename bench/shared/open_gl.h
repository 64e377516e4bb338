#pragma once

#include "render/gl/context.h"
#include "render/gl/gl.h"

#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <variant>

namespace gs::bench {

/// OpenGL context without a window, and its functions. Prints a problem, and has no context then.
struct OpenGl {
  explicit OpenGl(const std::string& backend) {
    auto opened = render::open_headless_context(backend);
    if (auto* error = std::get_if<render::ContextError>(&opened)) {
      std::fprintf(stderr, "%s\n", error->message.c_str());
      return;
    }
    auto loaded = render::Gl::load(*std::get<std::unique_ptr<render::GlContext>>(opened));
    if (auto* error = std::get_if<render::ContextError>(&loaded)) {
      std::fprintf(stderr, "%s\n", error->message.c_str());
      return;
    }
    context = std::move(std::get<std::unique_ptr<render::GlContext>>(opened));
    gl = std::move(std::get<render::Gl>(loaded));
  }
  std::unique_ptr<render::GlContext> context;
  render::Gl gl;
};

}  // namespace gs::bench
