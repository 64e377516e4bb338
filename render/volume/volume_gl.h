#pragma once

#include "render/gl/gpu.h"
#include "render/volume/volume_raster.h"
#include "render/volume/volume_sort.h"
#include "render/volume/volume_sort_gl.h"
#include "render/volume/volume_store.h"
#include "render/volume/volume_target.h"

#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

namespace gs::render {

/// Sorting method for volume vectors with OpenGL. automatic: compute shaders if the hardware supports them, else a
/// thread. The thread is also the fallback if compute shaders fail.
enum class VolumeSort : std::uint8_t { automatic, thread, compute };

/// Volume splatting with OpenGL 3.3: the image of rasterize_volumes, up to rounding. It blends instanced rectangles of
/// all volumes from back to front at 16 bits per channel. Each sample is tested against the existing depth. Then it
/// composites the result. Without such a target, it blends into the image directly, with 8-bit rounding. Belongs to the
/// thread of its context.
///
/// With compute shaders, the order is exact for the view; the thread's order may be that of the previous view
/// (VolumeSorter).
class VolumeGl {
 public:
  explicit VolumeGl(const Gl& gl, VolumeSort sort = VolumeSort::automatic);

  struct View {
    SplatView lens;  // camera_from_node and supersample are ignored
    Projection projection;
    TargetRectangle rectangle;  // of the bound framebuffer
    std::uint32_t viewport = 0;
  };
  struct Drawn {
    std::size_t vectors = 0;  // in view, estimated from a sample if there are many
    bool pending = false;     // the order is not exact for this view; draw again
  };
  /// Draws item i with held[i]. Writes no depth; leaves the depth test and blending off and depth writes on. Returns
  /// nullopt if the context lacks memory or the program, or if there are too many vectors, items or lights.
  std::optional<Drawn> draw(std::span<const SharedVolume> held, std::span<const VolumeItem> items, const View& view);

  /// Frees unused copies; call it once per frame.
  void forget_unused() { store_.forget_unused(); }
  /// Returns the method that sorted the last image.
  [[nodiscard]] VolumeSort sorted_by() const { return sorted_by_; }

 private:
  struct Sorted {
    std::weak_ptr<const qnv::Volume> volume;
    std::size_t first = 0, count = 0;
    glm::vec4 row{0};
  };
  struct Viewport {
    std::unique_ptr<VolumeSorter> sorter;
    Buffer order;
    std::uint64_t number = 0;    // serial number of the order in the buffer; 0 means none
    std::vector<Sorted> sorted;  // input of the compute shaders' order
    std::uint64_t used = 0;
  };
  /// Visible part of the items.
  struct Visible {
    std::vector<SharedVolume> held;
    std::vector<VolumeItem> items;
    std::vector<VolumeStore::Place> places;
    std::size_t total = 0;  // vectors
  };

  bool make_program_once();
  bool upload_items(const Visible& visible, const SplatView& lens);
  Viewport& viewport(std::uint32_t number);
  bool sort(const Visible& visible, Viewport& viewport, bool& pending);
  bool sort_with_compute(const Visible& visible, Viewport& viewport);
  void blend(const Visible& visible, const View& view, const Buffer& order);

  const Gl& gl_;
  VolumeStore store_;
  VolumeTarget target_;
  VolumeSort wanted_sort_, sorted_by_ = VolumeSort::thread;
  std::unique_ptr<VolumeGlSort> compute_;
  bool tried_program_ = false, tried_compute_ = false;
  Program program_;
  VertexArray attributes_;
  Buffer item_buffer_;
  Texture items_;
  std::unordered_map<std::uint32_t, Viewport> viewports_;
  std::uint64_t frame_ = 0;
};

}  // namespace gs::render
