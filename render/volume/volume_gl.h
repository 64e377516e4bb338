#pragma once

#include "render/gl/gpu.h"
#include "render/sorting/depth_order.h"
#include "render/volume/volume_raster.h"
#include "render/volume/volume_store.h"
#include "render/volume/volume_target.h"

#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gs::render {

/// Draws volumes with OpenGL 3.3. The image equals that of rasterize_volumes(), except for rounding. A VolumeTarget
/// blends the instanced rectangles of all volumes in 16 bits per channel. If no such target is possible, it blends
/// directly into the image, rounded to 8 bits.
///
/// Compute shaders sort exactly for the view. The order of the thread may be that of the previous view (DepthOrder).
/// Runs on the thread of its context.
class VolumeGl {
 public:
  explicit VolumeGl(const Gl& gl, SortMethod sort = SortMethod::automatic);

  using View = BlendedView;
  /// Prepares the drawing of the volumes `items`; held[i] owns the data of items[i]. Returns nullopt if memory or the
  /// program is missing, or if there are too many vectors, items or lights.
  std::optional<PreparedSplats> prepare(std::span<const SharedVolume> held, std::span<const VolumeItem> items,
                                        const View& view);

  /// Frees volumes that have no other owners. Call it once per frame.
  void forget_unused() { store_.forget_unused(); }
  /// Returns the method that sorted the last image.
  [[nodiscard]] SortMethod sorted_by() const { return order_.sorted_by(); }

 private:
  /// Items that are visible.
  struct Visible {
    std::vector<SharedVolume> held;
    std::vector<VolumeItem> items;
    std::vector<VolumeStore::Place> places;
    std::size_t total = 0;  // number of vectors
  };

  bool make_program_once();
  bool upload_items(const Visible& visible, const SplatView& lens);
  std::optional<DepthOrder::Result> sort(const Visible& visible, std::uint32_t viewport);
  void draw_range(const Visible& visible, const View& view, const SplatRange& range);

  const Gl& gl_;
  VolumeStore store_;
  DepthOrder order_;
  bool tried_program_ = false;
  Program program_;
  VertexArray attributes_;
  Buffer item_buffer_;
  Texture items_, order_texture_;
};

}  // namespace gs::render
