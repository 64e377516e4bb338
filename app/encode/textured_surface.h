#pragma once

#include "qnv/codecs/shared/encode_options.h"
#include "render/scene/render_list.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <optional>

namespace gs::app {

/// Default JPEG quality of textures.
inline constexpr int kTextureQuality = 92;

/// Converts a textured surface to one mesh with one texture image. The image is the original texture if there is only
/// one, else an atlas of all textures and plain colours. It is encoded as progressive JPEG, or as PNG if that is much
/// smaller. Triangles are relative to `origin`. `quality` is the JPEG quality.
///
/// Returns nullopt if one image cannot represent the surface: without textures, with transparent textures, or with
/// vertex colours beside or multiplied with textures. Also returns nullopt if repeated textures would take too much
/// space. Only reads the list; runs on any thread.
[[nodiscard]] std::optional<qnv::TexturedSurface> textured_surface(const render::RenderList& list,
                                                                   const glm::dvec3& origin,
                                                                   int quality = kTextureQuality);

}  // namespace gs::app
