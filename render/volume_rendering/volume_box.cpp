#include "render/volume_rendering/volume_box.h"

#include <glm/vec3.hpp>

#include <cstdint>

namespace gs::render {

std::shared_ptr<const vrml::Mesh> volume_box() {
  static const std::shared_ptr<const vrml::Mesh> kBox = [] {
    auto mesh = std::make_shared<vrml::Mesh>();
    mesh->lit = false;
    for (std::uint32_t corner = 0; corner < 8; ++corner) {
      const glm::vec3 at(corner & 1 ? 0.5f : -0.5f, corner & 2 ? 0.5f : -0.5f, corner & 4 ? 0.5f : -0.5f);
      mesh->positions.push_back(at);
      mesh->bounds.add(at);
    }
    mesh->indices = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                     2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
    mesh->convex = true;
    return mesh;
  }();
  return kBox;
}

}  // namespace gs::render
