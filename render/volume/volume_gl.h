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

/// Method that sorts volume vectors for OpenGL. automatic: compute shaders if the hardware supports them, otherwise a
/// thread. If compute shaders fail, the thread replaces them.
enum class VolumeSort : std::uint8_t { automatic, thread, compute };

/// Draws volumes with OpenGL 3.3. The image equals that of rasterize_volumes(), except for rounding. Blends the
/// instanced rectangles of all volumes from back to front, in 16 bits per channel. Tests each sample against the
/// existing depth. Then composites the result over the image. If no such target is possible, blends directly into the
/// image, rounded to 8 bits.
///
/// Compute shaders sort exactly for the view. The order of the thread may be that of the previous view (VolumeSorter).
/// Runs on the thread of its context.
class VolumeGl {
 public:
  explicit VolumeGl(const Gl& gl, VolumeSort sort = VolumeSort::automatic);

  struct View {
    SplatView lens;  // `camera_from_node` and `supersample` are ignored
    Projection projection;
    TargetRectangle rectangle;  // rectangle of the bound framebuffer
    std::uint32_t viewport = 0;
  };
  struct Drawn {
    std::size_t vectors = 0;  // vectors in view; estimated if there are many
    bool pending = false;  // the order is that of an earlier view: draw again
  };
  /// Draws the volumes `items`; held[i] owns the data of items[i]. Writes no depth. Leaves depth test and blending off
  /// and depth writes on. Returns nullopt if memory or the program is missing, or if there are too many vectors, items
  /// or lights.
  std::optional<Drawn> draw(std::span<const SharedVolume> held, std::span<const VolumeItem> items, const View& view);

  /// Frees volumes that have no other owners. Call it once per frame.
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
    std::uint64_t number = 0;  // serial number of the order in the buffer; 0 means that the buffer is empty
    std::vector<Sorted> sorted;  // volumes that the compute shaders sorted
    std::uint64_t used = 0;
  };
  /// Items that are visible.
  struct Visible {
    std::vector<SharedVolume> held;
    std::vector<VolumeItem> items;
    std::vector<VolumeStore::Place> places;
    std::size_t total = 0;  // number of vectors
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
