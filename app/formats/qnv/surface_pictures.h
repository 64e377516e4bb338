#pragma once

#include "base/budget.h"
#include "qnv/base/geometry.h"
#include "render/image/image.h"

#include <memory>
#include <vector>

namespace gs::app {

/// Cache of decoded surface textures. A texture that is in use is not decoded again. One thread.
class SurfacePictures {
 public:
  /// Returns the decoded texture. Returns null if decoding fails, for example because too few bytes were received. Safe
  /// for untrusted bytes.
  [[nodiscard]] std::shared_ptr<const render::Image> image_of(const std::shared_ptr<const qnv::SurfacePicture>& picture,
                                                              const WorldBudget& budget);

 private:
  struct Decoded {
    std::weak_ptr<const qnv::SurfacePicture> picture;
    std::weak_ptr<const render::Image> image;
  };
  std::vector<Decoded> decoded_;
};

/// Replaces the texture coordinates of vertices by colours from the texture, for consumers that do not draw textures.
/// Does not change `mesh` if the texture cannot be decoded.
void color_by_picture(qnv::IndexedMesh& mesh, const WorldBudget& budget);

}  // namespace gs::app
