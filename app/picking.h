#pragma once

#include "app/navigation.h"
#include "render/render_list.h"

#include <cstddef>
#include <optional>

namespace gs::app {

/// Where a ray meets the world.
struct Hit {
  float distance = 0;    // metres from the ray's origin
  std::size_t item = 0;  // of RenderList::items
};

/// The nearest triangle of `list` that `ray` meets, front or back. Lines and points are too thin to hit.
/// Takes time in proportion to the triangles of the items whose boxes the ray meets; no more than
/// `max_triangles` of them are looked at.
[[nodiscard]] std::optional<Hit> pick(const render::RenderList& list, const Ray& ray,
                                      std::size_t max_triangles = std::size_t{1} << 24);

}  // namespace gs::app
