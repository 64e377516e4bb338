#pragma once

#include "qnv/base/cloud.h"

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

/// Where and how a cloud is rasterised.
struct SplatView {
  glm::mat4 camera_from_node{1.0f};  // any affine matrix
  glm::vec2 tangents{1.0f};          // of half the angles of view, horizontally and vertically
  glm::vec2 center{0.0f};            // tangents of what is in the middle of the picture
  int width = 0, height = 0;         // pixels of the viewport
  float near_plane = 0;
  int supersample = 1;           // 2: four samples a pixel; 1, 2, 4 or 8
  bool color_by_normal = false;  // node space: -1..1 of x, y, z as red, green, blue, in place of all colours
  unsigned threads = 0;
};

/// Memory whose numbers are written before they are read.
template <class T>
struct SplatAllocator : std::allocator<T> {
  template <class U>
  struct rebind {
    using other = SplatAllocator<U>;
  };
  using std::allocator<T>::allocator;
  /// resize() does nothing to new elements: the threads that draw the tiles fill them.
  template <class U>
  void construct(U* at) {
    ::new (static_cast<void*>(at)) U;
  }
  template <class U, class... Args>
  void construct(U* at, Args&&... args) {
    ::new (static_cast<void*>(at)) U(std::forward<Args>(args)...);
  }
};

/// What a cloud leaves in the pixels of a rectangle of the viewport, rows from the bottom. Where nothing is,
/// coverage is 0.
struct SplatLayer {
  int x = 0, y = 0, width = 0, height = 0;
  std::vector<float, SplatAllocator<float>> depth;  // distance along the view axis, camera units
  // 4 a pixel: camera space x, y, z as 0..65535 for -1..1; coverage 0..65535.
  std::vector<std::uint16_t, SplatAllocator<std::uint16_t>> normals;
  // 4 a pixel: RGB and unused; empty when the cloud has one colour.
  std::vector<std::uint8_t, SplatAllocator<std::uint8_t>> colors;
  std::size_t discs = 0;  // that lay in view
  std::size_t drawn = 0;  // of them; fewer where they would cover more than kMostSplatSamples

  [[nodiscard]] bool empty() const { return depth.empty(); }
};

/// Surface splatting on the processor: the nearest surface of every sample first, then normals and colours averaged
/// over the discs that lie about there, weighted by a bell of the distance in the disc (paper, section 3; two passes as
/// in Botsch et al. 2005). Discs that came from an octree cover only their cube and a little more. The same bits
/// whatever the number of threads.
[[nodiscard]] SplatLayer rasterize_surface(const qnv::Cloud& cloud, const SplatView& view);

/// Some discs of a cloud.
struct SplatPiece {
  const qnv::Cloud* cloud = nullptr;
  std::size_t first = 0, count = 0;
  float growth = 1;  // by which their areas are multiplied: they stand for others that are not drawn
  std::optional<qnv::Rgb8> tint = std::nullopt;  // in place of all colours of the piece
};
/// The same for pieces of clouds that make up one surface: all of them with cells or none, seen from both sides or
/// none.
[[nodiscard]] SplatLayer rasterize_surface(std::span<const SplatPiece> pieces, const SplatView& view);

/// Clouds whose discs would be blended with more samples than this, counted once a disc, are thinned out evenly: they
/// would take seconds. Clouds that are drawn as they were meant come to a hundredth.
inline constexpr std::uint64_t kMostSplatSamples = 2'000'000'000;

/// What can be told of pieces of clouds in a view from some of their discs.
struct SplatSurvey {
  std::size_t discs = 0;  // in view
  bool smooth = false;    // whether rasterize_surface would let the normals follow the surface between the discs
  double samples = 0;     // that the bounds of all discs in view cover together
};

/// Looks at about `most` discs, evenly spread over the pieces; exact when they have no more.
[[nodiscard]] SplatSurvey survey_surface(std::span<const SplatPiece> pieces, const SplatView& view, std::size_t most);

/// The vector instructions that are used here: "AVX-512", "AVX2" or "SSE2".
[[nodiscard]] std::string_view splat_instructions();

}  // namespace gs::render
