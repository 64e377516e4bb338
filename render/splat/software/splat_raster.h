#pragma once

#include "qnv/base/geometry.h"
#include "render/scene/clip_space.h"

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace gs::render {

/// View of splats for rasterizing.
struct SplatView {
  glm::mat4 camera_from_node{1.0f};  // any affine matrix
  glm::vec2 tangents{1.0f};          // tangents of half the angles of view, horizontal and vertical
  glm::vec2 center{0.0f};            // tangents of the image centre
  int width = 0, height = 0;         // size of the viewport in pixels
  float near_plane = 0;
  int supersample = 1;           // samples along the side of a pixel: 1, 2, 4 or 8
  bool color_by_normal = false;  // shows normals: x, y, z from -1 to 1 are red, green, blue (node space)
  unsigned threads = 0;
  ClipSpace clip;  // in node space; splats with a centre outside are not drawn
};

/// Allocator for arrays that are written before they are read.
template <class T>
struct SplatAllocator : std::allocator<T> {
  template <class U>
  struct rebind {
    using other = SplatAllocator<U>;
  };
  using std::allocator<T>::allocator;
  /// Leaves new elements of resize() uninitialized, because the threads that draw the tiles fill them.
  template <class U>
  void construct(U* at) {
    ::new (static_cast<void*>(at)) U;
  }
  template <class U, class... Args>
  void construct(U* at, Args&&... args) {
    ::new (static_cast<void*>(at)) U(std::forward<Args>(args)...);
  }
};

/// Rasterized splats in a rectangle of the viewport, rows from the bottom. Empty pixels have coverage 0.
struct SplatLayer {
  int x = 0, y = 0, width = 0, height = 0;
  std::vector<float, SplatAllocator<float>> depth;  // distance along the view axis, in camera units
  // 4 per pixel: normal in camera space, x, y, z from -1 to 1 as 0 to 65535; coverage, 0 to 65535.
  std::vector<std::uint16_t, SplatAllocator<std::uint16_t>> normals;
  // 4 per pixel: RGB and an unused byte. Empty if the splats have one colour.
  std::vector<std::uint8_t, SplatAllocator<std::uint8_t>> colors;
  std::size_t discs = 0;  // splats in view
  std::size_t drawn = 0;  // drawn splats; fewer if all splats would cover more than kMaxSplatSamples samples

  [[nodiscard]] bool empty() const { return depth.empty(); }
};

/// Draws the splats of a surface on the CPU. The first pass finds the nearest surface at each sample. The second
/// averages the normals and colours of the splats there, with bells as weights (paper, section 3; Botsch et al. 2005).
/// Splats of an octree cover only their cube and a small margin. Gives identical bits for any number of threads.
[[nodiscard]] SplatLayer rasterize_surface(const qnv::Splats& splats, const SplatView& view);

/// Range of the splats of a geometry.
struct SplatPiece {
  const qnv::Splats* splats = nullptr;
  std::size_t first = 0, count = 0;
  float growth = 1;  // factor of the splats' areas, if they also represent splats that are not drawn
  std::optional<qnv::Rgb8> tint = std::nullopt;  // replaces the colours of the splats
};
/// Draws pieces of one surface. Either all or none may have cells; either all or none may be two-sided.
[[nodiscard]] SplatLayer rasterize_surface(std::span<const SplatPiece> pieces, const SplatView& view);

/// Maximum blended samples, summed over the splats. Larger geometries would take seconds, so their splats are thinned
/// evenly. Typical geometries need a hundredth.
inline constexpr std::uint64_t kMaxSplatSamples = 2'000'000'000;

/// Estimates for the splats of pieces in a view, from a sample.
struct SurfaceMeasure {
  std::size_t discs = 0;  // splats in view
  bool smooth = false;    // rasterize_surface() makes normals follow the surface between the splats
  double samples = 0;     // sum of the samples in the bounding boxes of all splats in view
};

/// Estimates from about `most` splats, evenly spread over the pieces. If there are fewer splats, examines all.
[[nodiscard]] SurfaceMeasure measure_surface(std::span<const SplatPiece> pieces, const SplatView& view,
                                             std::size_t most);

}  // namespace gs::render
