#pragma once

#include "app/world/opened_world.h"
#include "qnv/base/triangles.h"
#include "qnv/outline/outline_groups.h"
#include "qnv/stream/outline_header.h"
#include "render/scene/render_list.h"

#include <cstddef>
#include <functional>
#include <string>
#include <unordered_map>
#include <vector>

namespace gs::app {

/// A model as outline groups need it: its polygons in world space, and how they look.
struct OutlineModel {
  qnv::PolygonModel model;
  std::vector<qnv::OutlineAppearance> appearances;  // of model.appearances
  std::size_t left_out = 0;                         // lines and points, which have no outline
  bool averaged = false;                            // colours of corners became colours of triangles
};

/// Where the textures of a world come from, as it names them: urls resolved against the world's own, those of pictures
/// that lie in the world itself as data: URLs.
using TextureUrls = std::unordered_map<const render::Image*, std::string>;
[[nodiscard]] TextureUrls texture_urls(const OpenedWorld& world);

/// Everything that a render list draws as triangles. A face whose corners differ in colour gets their mean; a mesh
/// whose normals are not flat gets the creaseAngle that gives them best (VRML97 4.6.3.5).
[[nodiscard]] OutlineModel outline_model(const render::RenderList& list, const TextureUrls& textures);

/// Triangles of one look, as an isosurface has them; false of the source: it failed or was cancelled.
[[nodiscard]] OutlineModel outline_model(const std::function<bool(const qnv::TriangleSink&)>& source, bool two_sided);

/// The creaseAngle (radians) with which the edges of a mesh come out as smooth and as sharp as its normals have them;
/// 0 for one that is flat or has none.
[[nodiscard]] float crease_angle_of(const vrml::Mesh& mesh);

}  // namespace gs::app
