#pragma once

#include "qnv/codecs/shared/encode_options.h"
#include "render/scene/render_list.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <optional>

namespace gs::app {

/// Default JPEG quality of textures.
inline constexpr int kTextureQuality = 92;

/// Converts a textured surface to one mesh with one texture image. With one texture, that is the original texture.
/// Otherwise it is an atlas of all textures and plain colours. The image is encoded as progressive JPEG, or as PNG if
/// that is much smaller. Triangles are relative to `origin`. `quality` is the JPEG quality.
///
/// Returns nullopt if one image cannot represent the surface. That is so without textures, with transparent textures,
/// and with vertex colours beside or multiplied with textures. Also returns nullopt if repeated textures would take too
/// much space. Does not change the list. Any thread.
[[nodiscard]] std::optional<qnv::TexturedSurface> textured_surface(const render::RenderList& list,
                                                                   const glm::dvec3& origin,
                                                                   int quality = kTextureQuality);

}  // namespace gs::app
