#pragma once

#include "qnv/base/cloud.h"
#include "render/scene/render_list.h"
#include "vrml/mesh/mesh.h"

#include <memory>

namespace gs::render {

/// The mesh of vectors with triangles between them (qnv::Cloud::triangles).
[[nodiscard]] std::shared_ptr<const vrml::Mesh> mesh_of_surface(const qnv::Cloud& cloud);

/// A surface is lit even where no Material asks for it; then it has the colour of its stream.
void dress_surface(DrawItem& item);

}  // namespace gs::render
