#pragma once

#include "render/scene/camera.h"
#include "render/scene/draw_options.h"
#include "render/scene/render_list.h"

#include <cstddef>
#include <optional>

namespace gs::render {

/// Part of a picture that a layer fills, and the camera for it.
struct LayerPart {
  Camera camera;
  DrawOptions options;
};

/// Returns the drawn part of a layer with this clipBoundary (X3D 35.4.4); nullopt if it has no pixel. `options` are
/// those of the picture; `camera` is the layer's, with the drawn part of the picture.
[[nodiscard]] std::optional<LayerPart> part_of(const vrml::ClipBoundary& boundary, const Camera& camera,
                                               const DrawOptions& options);
/// Returns the camera of a layer, for the part of the picture that `camera` draws.
[[nodiscard]] Camera lens_of(const RenderLayer& layer, const Camera& camera, const DrawOptions& options);
/// Returns the options for a layer that is not active.
[[nodiscard]] DrawOptions options_of(const RenderLayer& layer, std::size_t index, const DrawOptions& options);
/// Adds the statistics of a layer to those of its picture.
void add_to(FrameStatistics& sum, const FrameStatistics& layer);

}  // namespace gs::render
