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

/// What sorts the vectors of volumes for OpenGL. automatic: compute shaders where OpenGL has them and is hardware, else
/// a thread. What compute shaders cannot do, the thread does.
enum class VolumeSort : std::uint8_t { automatic, thread, compute };

/// Volume splatting with OpenGL 3.3: the picture of rasterize_volumes, up to rounding. Instanced rectangles of all
/// volumes in one order are blended over one another from back to front in 16 bits a channel, against the depth that
/// has been drawn, sample by sample, and then laid over the picture. Where such a target cannot be had, they are
/// blended into the picture itself, with the rounding of its eight bits. Belongs to the thread of its context.
///
/// The order is that of the view, with compute shaders; the thread's may be that of the view before (VolumeSorter).
class VolumeGl {
 public:
  explicit VolumeGl(const Gl& gl, VolumeSort sort = VolumeSort::automatic);

  struct View {
    SplatView lens;  // camera_from_node and supersample are left aside
    Projection projection;
    TargetRectangle rectangle;  // of the framebuffer that is bound
    std::uint32_t viewport = 0;
  };
  struct Drawn {
    std::size_t vectors = 0;  // in view, told from some of them when there are many
    bool pending = false;     // the order is not quite that of this view: drawn again it is
  };
  /// Item i is one of held[i]. Writes no depth; leaves the depth test and blending off and depth writable. Empty when
  /// this context cannot: no memory, too many vectors, items or lights, no program.
  std::optional<Drawn> draw(std::span<const SharedVolume> held, std::span<const VolumeItem> items, const View& view);

  /// To be called once a frame.
  void forget_unused() { store_.forget_unused(); }
  /// What sorted the last picture.
  [[nodiscard]] VolumeSort sorted_by() const { return sorted_by_; }

 private:
  struct Sorted {
    std::weak_ptr<const qnv::Cloud> cloud;
    std::size_t first = 0, count = 0;
    glm::vec4 row{0};
  };
  struct Viewport {
    std::unique_ptr<VolumeSorter> sorter;
    Buffer order;
    std::uint64_t number = 0;    // of the thread's order that lies there; 0: none
    std::vector<Sorted> sorted;  // what the order of the compute shaders was made for
    std::uint64_t used = 0;
  };
  /// What of the items can be seen at all.
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
