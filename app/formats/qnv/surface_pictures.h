#pragma once

#include "app/base/world_budget.h"
#include "qnv/base/cloud.h"
#include "render/image/image.h"

#include <memory>
#include <vector>

namespace gs::app {

/// Pictures of textured surfaces, each decoded once for as long as anybody has it. One thread.
class SurfacePictures {
 public:
  /// Null where it cannot be decoded, as when too little of it has come. Safe for untrusted bytes.
  [[nodiscard]] std::shared_ptr<const render::Image> image_of(const std::shared_ptr<const qnv::SurfacePicture>& picture,
                                                              const WorldBudget& budget);

 private:
  struct Decoded {
    std::weak_ptr<const qnv::SurfacePicture> picture;
    std::weak_ptr<const render::Image> image;
  };
  std::vector<Decoded> decoded_;
};

/// Gives vertices that show a picture its colour there, for who does not show it; as it is where it cannot be decoded.
void color_by_picture(qnv::Cloud& cloud, const WorldBudget& budget);

}  // namespace gs::app
