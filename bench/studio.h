#pragma once

#include "bench/picture_error.h"
#include "qnv/base/cloud.h"
#include "render/draw/renderer.h"
#include "render/gl/context.h"
#include "render/scene/render_list.h"

#include <memory>
#include <span>
#include <vector>

namespace gs::bench {

/// From where a picture is taken, in degrees, as `--orbit` has it; the whole of the object is in view.
struct View {
  float azimuth = 0, elevation = 0;
};

/// Draws pictures that are compared: 800x600, headlight, black background. One thread.
class Studio {
 public:
  static constexpr int kWidth = 800, kHeight = 600;

  Studio();
  /// False where nothing can be drawn.
  [[nodiscard]] bool good() const { return renderer_ != nullptr; }
  /// One picture a view, of an object with these bounds; fewer where drawing failed.
  [[nodiscard]] std::vector<render::Image> pictures(const render::RenderList& list, const render::WorldBounds& bounds,
                                                    std::span<const View> views);

 private:
  std::unique_ptr<render::GlContext> context_;
  std::unique_ptr<render::Renderer> renderer_;
};

/// A list that shows a cloud in its own colours.
[[nodiscard]] render::RenderList list_of(qnv::Cloud cloud);

}  // namespace gs::bench
