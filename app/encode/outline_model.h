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

/// Input for the encoder of outline groups: polygons in world space, with their appearances.
struct OutlineModel {
  qnv::PolygonModel model;
  std::vector<qnv::OutlineAppearance> appearances;  // model.appearances has indices into this list
  std::size_t omitted = 0;  // number of lines and points; they are omitted
  bool averaged = false;  // true if some triangles got the average of their corner colours
};

/// URLs of the textures of a world, resolved against the world's URL. Textures without a URL in the world's own file
/// have data: URLs.
using TextureUrls = std::unordered_map<const render::Image*, std::string>;
[[nodiscard]] TextureUrls texture_urls(const LoadedWorld& world);

/// Converts all triangles of a render list. A triangle with different corner colours gets their average. A mesh with
/// smooth normals gets the creaseAngle that fits them best (VRML97 4.6.3.5).
[[nodiscard]] OutlineModel outline_model(const render::RenderList& list, const TextureUrls& textures);

/// Converts triangles with a single appearance, for example an isosurface. `source` returns false if it fails or is
/// cancelled.
[[nodiscard]] OutlineModel outline_model(const std::function<bool(const qnv::TriangleSink&)>& source, bool two_sided);

/// Returns the creaseAngle in radians that fits best: the mesh's normals are smooth at most edges below this angle, and
/// sharp above it. Returns 0 if the mesh is flat-shaded or has no normals.
[[nodiscard]] float crease_angle_of(const vrml::Mesh& mesh);

}  // namespace gs::app
