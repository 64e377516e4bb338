#pragma once

#include "app/loading/updates/loaded_world.h"
#include "qnv/base/triangles.h"
#include "qnv/codecs/outlines/grouping/outline_groups.h"
#include "qnv/container/outline_header.h"
#include "render/scene/render_list.h"

#include <cstddef>
#include <functional>
#include <string>
#include <unordered_map>
#include <vector>

namespace gs::app {

/// Model for outline groups: polygons in world space, and their appearances.
struct OutlineModel {
  qnv::PolygonModel model;
  std::vector<qnv::OutlineAppearance> appearances;  // indexed by model.appearances
  std::size_t left_out = 0;                         // number of lines and points, which have no outline
  bool averaged = false;                            // corner colours were averaged per triangle
};

/// Texture URLs of a world, resolved against the world's URL. Pictures embedded in the world have data: URLs.
using TextureUrls = std::unordered_map<const render::Image*, std::string>;
[[nodiscard]] TextureUrls texture_urls(const LoadedWorld& world);

/// Converts all triangles of a render list. A face with different corner colours gets their mean. A mesh with smooth
/// normals gets the best matching creaseAngle (VRML97 4.6.3.5).
[[nodiscard]] OutlineModel outline_model(const render::RenderList& list, const TextureUrls& textures);

/// Converts triangles of one appearance, for example an isosurface. `source` returns false if it fails or is cancelled.
[[nodiscard]] OutlineModel outline_model(const std::function<bool(const qnv::TriangleSink&)>& source, bool two_sided);

/// Returns the creaseAngle (radians) that best reproduces the smooth and sharp edges of the mesh's normals. Returns 0
/// if the mesh is flat or has no normals.
[[nodiscard]] float crease_angle_of(const vrml::Mesh& mesh);

}  // namespace gs::app
