#pragma once

#include "qnv/base/geometry.h"
#include "qnv/codecs/displaced/tessellation/surface_cut.h"
#include "render/scene/render_list.h"
#include "vrml/mesh/mesh.h"

#include <memory>

namespace gs::render {

/// Returns the mesh of an indexed mesh or of patches; an empty mesh for other geometry. If part of it has a picture,
/// `pictured` selects that part, otherwise the rest. For patches, it returns one level of all of them for collision
/// detection, not for drawing.
[[nodiscard]] std::shared_ptr<const vrml::Mesh> mesh_of_surface(const qnv::Geometry& geometry, bool pictured = false);

/// Returns the triangles of a cut as a mesh; patches share no vertices.
[[nodiscard]] std::shared_ptr<const vrml::Mesh> mesh_of_cut(const qnv::SurfacePatches& surface,
                                                            const qnv::SurfaceCut& cut);

/// Makes a surface lit even without a Material. Without one, it gets the colour and specular properties of its stream.
void dress_surface(DrawItem& item);

}  // namespace gs::render
