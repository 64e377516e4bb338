#pragma once

#include "qnv/base/geometry.h"

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

/// View of a point set for rasterizing.
struct SplatView {
  glm::mat4 camera_from_node{1.0f};  // any affine matrix
  glm::vec2 tangents{1.0f};          // of the half angles of view, horizontally and vertically
  glm::vec2 center{0.0f};            // tangents of the image centre
  int width = 0, height = 0;         // pixels of the viewport
  float near_plane = 0;
  int supersample = 1;           // samples per pixel edge: 1, 2, 4 or 8
  bool color_by_normal = false;  // node space: x, y, z from -1..1 as red, green, blue, instead of all colours
  unsigned threads = 0;
};

/// Allocator for memory that is written before it is read.
template <class T>
struct SplatAllocator : std::allocator<T> {
  template <class U>
  struct rebind {
    using other = SplatAllocator<U>;
  };
  using std::allocator<T>::allocator;
  /// Leaves new elements of resize() uninitialized: the threads that draw the tiles fill them.
  template <class U>
  void construct(U* at) {
    ::new (static_cast<void*>(at)) U;
  }
  template <class U, class... Args>
  void construct(U* at, Args&&... args) {
    ::new (static_cast<void*>(at)) U(std::forward<Args>(args)...);
  }
};

/// Result of rasterizing a point set in a rectangle of the viewport, rows from the bottom. Coverage is 0 for empty
/// pixels.
struct SplatLayer {
  int x = 0, y = 0, width = 0, height = 0;
  std::vector<float, SplatAllocator<float>> depth;  // distance along the view axis, camera units
  // 4 per pixel: camera space x, y, z as 0..65535 for -1..1; coverage 0..65535.
  std::vector<std::uint16_t, SplatAllocator<std::uint16_t>> normals;
  // 4 per pixel: RGB and unused; empty if the point set has one colour.
  std::vector<std::uint8_t, SplatAllocator<std::uint8_t>> colors;
  std::size_t discs = 0;  // splats in view
  std::size_t drawn = 0;  // splats drawn; fewer if all would cover more than kMaxSplatSamples

  [[nodiscard]] bool empty() const { return depth.empty(); }
};

/// Splats a surface on the CPU. The first pass finds the nearest surface of every sample. The second averages normals
/// and colours of the splats there, weighted by a bell of the distance (paper, section 3; Botsch et al. 2005). Splats
/// from an octree cover only their cube and a small margin. Gives the same bits for any number of threads.
[[nodiscard]] SplatLayer rasterize_surface(const qnv::Splats& splats, const SplatView& view);

/// Range of a point set's splats.
struct SplatPiece {
  const qnv::Splats* splats = nullptr;
  std::size_t first = 0, count = 0;
  float growth = 1;  // factor of their areas, since they represent others that are not drawn
  std::optional<qnv::Rgb8> tint = std::nullopt;  // replaces all colours of the piece
};
/// Rasterizes pieces of one surface: all or none with cells, all or none two-sided.
[[nodiscard]] SplatLayer rasterize_surface(std::span<const SplatPiece> pieces, const SplatView& view);

/// Maximum number of blended samples, counted per splat. Larger point sets would take seconds and are thinned evenly;
/// typical point sets need a hundredth.
inline constexpr std::uint64_t kMaxSplatSamples = 2'000'000'000;

/// Estimates for pieces of point sets in a view, from a sample of their splats.
struct SurfaceMeasure {
  std::size_t discs = 0;  // in view
  bool smooth = false;    // rasterize_surface lets the normals follow the surface between the splats
  double samples = 0;     // covered in total by the bounds of all splats in view
};

/// Estimates from about `most` splats, evenly spread over the pieces. Examines all splats if there are no more.
[[nodiscard]] SurfaceMeasure measure_surface(std::span<const SplatPiece> pieces, const SplatView& view,
                                             std::size_t most);

/// Returns the vector instruction set in use: "AVX-512", "AVX2" or "SSE2".
[[nodiscard]] std::string_view splat_instructions();

}  // namespace gs::render
