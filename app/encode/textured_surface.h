#pragma once

#include "qnv/encode/encode_surface.h"
#include "render/scene/render_list.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <optional>

namespace gs::app {

/// Of the JPEG files of textures where nobody asked for the mesh itself.
inline constexpr int kTextureQuality = 92;

/// A surface with textures as one mesh with one picture, progressive JPEG, or PNG where that is much smaller: the
/// texture itself where there is one, else all of them, and colours without one, side by side. Triangles count from
/// `origin`. Nothing where a picture cannot stand for all: without textures, with textures that can be seen through,
/// with colours of vertices beside pictures or multiplied with them, or where what repeats would have to be painted too
/// often. `quality`: of the JPEG file. Reads the list only; any thread.
[[nodiscard]] std::optional<qnv::TexturedSurface> textured_surface(const render::RenderList& list,
                                                                   const glm::dvec3& origin,
                                                                   int quality = kTextureQuality);

}  // namespace gs::app
