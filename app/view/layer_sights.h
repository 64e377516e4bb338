#pragma once

#include "app/view/pose.h"
#include "app/view/viewports.h"
#include "render/scene/render_list.h"

#include <cstddef>
#include <vector>

namespace gs::app {

/// Layer of a world (X3D 35.2.2) in a viewport, as the pointer meets it.
struct LayerSight {
  static constexpr std::size_t kActive = static_cast<std::size_t>(-1);
  std::size_t index = kActive;               // index in RenderList::layers; kActive for the active layer
  const render::RenderList* list = nullptr;  // content of the layer
  Pose pose;                                 // the layer's viewer
  Viewport place;                            // part of the window that the layer fills
};

/// Returns the layers of a world that the pointer can meet, from front to back. `list` is that of the active layer,
/// `pose` its viewer, and `place` the viewport. A world without layers gives one entry. Pointers refer to `list`.
[[nodiscard]] std::vector<LayerSight> layer_sights(const render::RenderList& list, const Pose& pose,
                                                   const Viewport& place);

}  // namespace gs::app
