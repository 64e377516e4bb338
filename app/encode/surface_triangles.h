#pragma once

#include "qnv/base/cloud.h"
#include "qnv/base/triangles.h"
#include "render/scene/render_list.h"
#include "render/scene/surface_mesh.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>

namespace gs::app {

/// The triangles of everything that a render list draws, in world space from `origin`, with the colour that a viewer
/// would see under plain white light baked into the corners: material, vertex colours and textures (large textured
/// triangles are divided so that the texture is not lost: closed surfaces stay closed, and where triangles share their
/// normals what is put between is as curved as they say). Lines and points have no surface and are left out. False
/// when the sink wanted no more. Deterministic; reads the list only.
bool for_each_triangle(const render::RenderList& list, const qnv::TriangleSink& sink,
                       const glm::dvec3& origin = glm::dvec3(0));

/// The same, not divided, with the texture coordinates that the item's TextureUse leads to; 0 where it shows no
/// picture. `item`: to which they belong.
using WholeTriangleSink = std::function<void(const render::DrawItem& item, const qnv::Triangle& triangle,
                                             const std::array<glm::vec2, 3>& at)>;
void for_each_whole_triangle(const render::RenderList& list, const WholeTriangleSink& sink, const glm::dvec3& origin);
/// Whether the surface of an item shows its picture.
[[nodiscard]] bool shows_picture(const render::DrawItem& item);

/// What for_each_triangle is about to give.
struct SurfaceSummary {
  qnv::WideBox box;           // of the corners that are used
  std::size_t triangles = 0;  // before division
  bool two_sided = false;     // some mesh is to be seen from behind too
  bool textured = false;
  std::optional<render::Shine> shine;  // of all of it; nothing where shapes differ
};
[[nodiscard]] SurfaceSummary summarize_surface(const render::RenderList& list);

/// Whether an item draws triangles.
[[nodiscard]] bool has_surface(const render::DrawItem& item);
/// 0..1 as 0..255, and a colour of such components, to the nearest.
[[nodiscard]] std::uint8_t to_byte(float value);
[[nodiscard]] qnv::Rgb8 to_rgb8(const glm::vec3& color);

}  // namespace gs::app
