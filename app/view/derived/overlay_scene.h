#pragma once

#include "render/scene/render_list.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace gs::app {

/// Copy of a world's render list with the content of other worlds in the same space. That content is drawn, but neither
/// picked nor collidable. Unchanged parts are reused. One thread.
class OverlayScene {
 public:
  /// Returns `list` itself without other lists; otherwise a changed copy, which is valid until the next call.
  const render::RenderList& with(const render::RenderList& list, std::span<const render::RenderList* const> others);

 private:
  using Version = std::pair<const render::RenderList*, std::pair<std::uint64_t, std::uint64_t>>;
  [[nodiscard]] static Version version_of(const render::RenderList& list) {
    return {&list, {list.generation, list.changes}};
  }
  std::vector<Version> of_;
  render::RenderList list_;
};

}  // namespace gs::app
