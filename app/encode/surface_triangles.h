#pragma once

#include "app/encode/surface_corners.h"
#include "render/scene/render_list.h"

#include <array>
#include <functional>

namespace gs::app {

/// Sends all triangles of a render list to `sink`, in world space relative to `origin`. Bakes the colour under plain
/// white light into the corners: material, vertex colours and textures. Subdivides large textured triangles to keep the
/// texture: closed surfaces stay closed, and new vertices follow shared normals. Skips lines and points. Returns false
/// if the sink stopped. Deterministic; only reads the list.
bool for_each_triangle(const render::RenderList& list, const qnv::TriangleSink& sink,
                       const glm::dvec3& origin = glm::dvec3(0));

/// Sink of undivided triangles, with texture coordinates as transformed by the item's TextureUse (0 without a picture).
/// `item` is the owner of the triangle.
using WholeTriangleSink = std::function<void(const render::DrawItem& item, const qnv::Triangle& triangle,
                                             const std::array<glm::vec2, 3>& at)>;
void for_each_whole_triangle(const render::RenderList& list, const WholeTriangleSink& sink, const glm::dvec3& origin);
/// Reports whether the surface of an item shows its picture.
[[nodiscard]] bool shows_picture(const render::DrawItem& item);

/// Summarizes the triangles that for_each_triangle will send.
[[nodiscard]] SurfaceSummary summarize_surface(const render::RenderList& list);

/// Reports whether an item draws triangles.
[[nodiscard]] bool has_surface(const render::DrawItem& item);

}  // namespace gs::app
