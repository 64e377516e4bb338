#pragma once

#include "bench/shared/picture_error.h"
#include "qnv/base/geometry.h"
#include "render/draw/renderer.h"
#include "render/gl/context.h"
#include "render/scene/render_list.h"

#include <memory>
#include <span>
#include <vector>

namespace gs::bench {

/// Direction of a picture in degrees, as in `--orbit`, with the whole object in view.
struct View {
  float azimuth = 0, elevation = 0;
};

/// Renderer for compared pictures: 800x600, headlight, black background. One thread.
class Studio {
 public:
  static constexpr int kWidth = 800, kHeight = 600;

  Studio();
  /// Returns false if no picture can be drawn.
  [[nodiscard]] bool good() const { return renderer_ != nullptr; }
  /// Returns one picture per view of an object with these bounds, or fewer if drawing failed.
  [[nodiscard]] std::vector<render::Image> pictures(const render::RenderList& list, const WideBox& bounds,
                                                    std::span<const View> views);

 private:
  std::unique_ptr<render::GlContext> context_;
  std::unique_ptr<render::Renderer> renderer_;
};

/// Returns a list that shows splats in their own colours.
[[nodiscard]] render::RenderList list_of(qnv::Geometry geometry);

}  // namespace gs::bench
