#pragma once

#include "qnv/base/cloud.h"
#include "qnv/surface/surface_cut.h"
#include "render/scene/render_list.h"
#include "vrml/mesh/mesh.h"

#include <glm/vec3.hpp>

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace gs::render {

/// The mesh of vectors with triangles between them (qnv::Cloud::triangles): where some of them show a picture, of these
/// if it is `pictured`, else of the others. Of a surface in patches one of them all at a level, for who bumps into it;
/// it is not what is drawn.
[[nodiscard]] std::shared_ptr<const vrml::Mesh> mesh_of_surface(const qnv::Cloud& cloud, bool pictured = false);

/// The triangles of a cut as a mesh; patches do not share vertices. `two_sided`: seen from behind, too.
[[nodiscard]] std::shared_ptr<const vrml::Mesh> mesh_of_cut(const qnv::SurfacePatches& surface,
                                                            const qnv::SurfaceCut& cut, bool two_sided,
                                                            const qnv::Rgb8& color);

/// How a surface shines (VRML97 6.27), which its stream says in its metadata.
struct Shine {
  glm::vec3 specular{0};
  float shininess = 0.2f;
  friend bool operator==(const Shine&, const Shine&) = default;
};
/// Nothing where it does not shine.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> metadata_of(const Shine& shine);
/// What is no number from 0 to 1 is passed over.
[[nodiscard]] Shine shine_of(const qnv::Description& description);

/// A surface is lit even where no Material asks for it; then it has the colour of its stream, and
/// shines as that says.
void dress_surface(DrawItem& item);

}  // namespace gs::render
