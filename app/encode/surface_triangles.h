#pragma once

#include "app/encode/surface_corners.h"
#include "render/scene/render_list.h"

#include <array>
#include <functional>

namespace gs::app {

/// Passes all triangles of a render list to `sink`, in world space relative to `origin`. The corners get the colour
/// under plain white light, from material, vertex colours and textures. Large textured triangles are subdivided, so
/// that their texture stays visible. Closed surfaces stay closed, and new vertices follow the normals that triangles
/// share. Skips lines and points. Returns false if the sink stopped. Deterministic. Does not change the list.
bool for_each_triangle(const render::RenderList& list, const qnv::TriangleSink& sink,
                       const glm::dvec3& origin = glm::dvec3(0));

/// Callback for triangles before subdivision. The texture coordinates are transformed by the TextureUse of the item, or
/// 0 without texture. `item` is the item with the triangle.
using WholeTriangleSink = std::function<void(const render::DrawItem& item, const qnv::Triangle& triangle,
                                             const std::array<glm::vec2, 3>& at)>;
void for_each_whole_triangle(const render::RenderList& list, const WholeTriangleSink& sink, const glm::dvec3& origin);
/// Returns true if the surface of an item shows a texture.
[[nodiscard]] bool shows_picture(const render::DrawItem& item);

/// Summarizes the triangles that for_each_triangle will send.
[[nodiscard]] SurfaceSummary summarize_surface(const render::RenderList& list);

/// Returns true if an item is drawn with triangles.
[[nodiscard]] bool has_surface(const render::DrawItem& item);

}  // namespace gs::app
