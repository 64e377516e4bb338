#pragma once

#include "app/view/derived/volume_derivations.h"
#include "render/scene/render_list.h"

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <cstdint>
#include <memory>
#include <optional>

namespace gs::app {

/// Content that replaces the vectors of a volume, or is drawn beside them.
struct VolumeContent {
  std::shared_ptr<const vrml::Mesh> surface;  // isosurface; null if it is not drawn
  glm::vec3 surface_color{1};
  std::shared_ptr<const VolumeProjection> projection;  // drawn instead of the vectors, or null
  std::shared_ptr<const qnv::Geometry> vectors;        // replaces the vectors, or null
  bool hides_vectors = false;
  std::optional<glm::dvec4> clip;  // world space: hides surface and projection where dot(clip, (point, 1)) < 0
  [[nodiscard]] bool any() const { return surface || projection || vectors || hides_vectors; }
  friend bool operator==(const VolumeContent&, const VolumeContent&) = default;
};

/// Copy of a world's render list with other content of its volume. Unchanged parts are reused. One thread.
class VolumeScene {
 public:
  /// Returns `list` itself if there is no content; otherwise a changed copy, which is valid until the next call.
  const render::RenderList& with_content(const render::RenderList& list, const glm::dmat4& world_from_volume,
                                         const VolumeContent& content);

 private:
  const render::RenderList* of_ = nullptr;
  std::uint64_t generation_ = 0, changes_ = 0;
  glm::dmat4 world_from_volume_{0.0};
  VolumeContent content_;
  render::RenderList list_;
};

}  // namespace gs::app
