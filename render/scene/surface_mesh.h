#pragma once

#include "qnv/base/cloud.h"
#include "qnv/codecs/displaced/tessellation/surface_cut.h"
#include "render/scene/render_list.h"
#include "vrml/mesh/mesh.h"

#include <memory>

namespace gs::render {

/// Returns the mesh of a point set with triangles (qnv::Cloud::triangles). If part of it has a picture, `pictured`
/// selects that part, otherwise the rest. For a surface in patches, it returns one level of all patches for collision
/// detection, not for drawing.
[[nodiscard]] std::shared_ptr<const vrml::Mesh> mesh_of_surface(const qnv::Cloud& cloud, bool pictured = false);

/// Returns the triangles of a cut as a mesh; patches share no vertices. `two_sided` makes back faces visible.
[[nodiscard]] std::shared_ptr<const vrml::Mesh> mesh_of_cut(const qnv::SurfacePatches& surface,
                                                            const qnv::SurfaceCut& cut, bool two_sided,
                                                            const qnv::Rgb8& color);

/// Lights a surface even without a Material; it then has the colour and the shine of its stream.
void dress_surface(DrawItem& item);

}  // namespace gs::render
