#pragma once

#include "base/budget.h"
#include "qnv/base/geometry.h"
#include "render/image/image.h"

#include <memory>
#include <vector>

namespace gs::app {

/// Cache of decoded textures of surfaces; each one is decoded once while in use. Use from one thread.
class SurfacePictures {
 public:
  /// Returns the decoded texture. Returns null if it cannot be decoded, for example because too little was received.
  /// Safe for untrusted bytes.
  [[nodiscard]] std::shared_ptr<const render::Image> image_of(const std::shared_ptr<const qnv::SurfacePicture>& picture,
                                                              const WorldBudget& budget);

 private:
  struct Decoded {
    std::weak_ptr<const qnv::SurfacePicture> picture;
    std::weak_ptr<const render::Image> image;
  };
  std::vector<Decoded> decoded_;
};

/// Replaces texture coordinates of vertices by texture colours, for consumers that do not draw textures. Leaves `cloud`
/// unchanged if the texture cannot be decoded.
void color_by_picture(qnv::IndexedMesh& mesh, const WorldBudget& budget);

}  // namespace gs::app
