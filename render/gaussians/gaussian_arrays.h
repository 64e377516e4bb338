#pragma once

#include "base/noncopyable.h"
#include "render/gaussians/gaussian_order.h"
#include "render/gaussians/gaussian_raster.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace gs::render {

/// Tiles that a splat touches, inclusive.
struct TileRange {
  std::uint16_t left, right, bottom, top;
};

/// Data of a splat for the lists.
struct PlacedGaussian {
  TileRange tiles;
  float depth;          // along the view axis
  std::uint32_t index;  // kProjectedRange * task + index in the task
};

/// Splat in the list of a region.
struct ListedGaussian {
  std::uint32_t index;                    // as in PlacedGaussian
  std::uint8_t left, right, bottom, top;  // tiles of the region that it touches, inclusive
};

/// Returns the bytes that an array occupies.
template <class T>
[[nodiscard]] std::size_t capacity_bytes(const std::vector<T>& array) {
  return array.capacity() * sizeof(T);
}

/// Splats of one projection task.
struct ProjectedPart {
  ProjectedGaussians projected;
  std::vector<PlacedGaussian> places;

  void clear() {
    projected.splats.clear();
    projected.distances.clear();
    projected.surfels.clear();
    places.clear();
  }
  [[nodiscard]] std::size_t bytes() const {
    return capacity_bytes(projected.splats) + capacity_bytes(projected.distances) + capacity_bytes(projected.surfels) +
           capacity_bytes(places);
  }
};

/// Arrays of a picture. The next picture reuses them, because the system must clear the pages of new arrays.
struct GaussianArrays {
  std::vector<ProjectedPart> parts;
  std::size_t used_parts = 0;  // parts of this picture
  std::vector<GaussianKey> keys, moved_keys;
  std::vector<PlacedGaussian> ordered;
  std::vector<std::uint32_t> counts;  // entries of each region, for each range of splats
  std::vector<ListedGaussian> listed;

  [[nodiscard]] std::size_t bytes() const {
    std::size_t sum = capacity_bytes(keys) + capacity_bytes(moved_keys) + capacity_bytes(ordered) +
                      capacity_bytes(counts) + capacity_bytes(listed);
    for (const ProjectedPart& part : parts) sum += part.bytes();
    return sum;
  }
};

/// Arrays of the last picture, unless they are large. Any thread.
class KeptGaussianArrays : NonCopyable {
 public:
  static constexpr std::size_t kMost = std::size_t{320} << 20;  // bytes
  static constexpr int kMostIdle = 16;                          // pictures without Gaussians until the arrays are freed

  /// Returns the arrays of the last picture, or empty ones.
  [[nodiscard]] std::unique_ptr<GaussianArrays> take() {
    const std::lock_guard lock(mutex_);
    idle_ = 0;
    return kept_ ? std::move(kept_) : std::make_unique<GaussianArrays>();
  }
  /// Keeps arrays for the next picture.
  void give_back(std::unique_ptr<GaussianArrays> arrays) {
    if (arrays->bytes() > kMost) return;
    const std::lock_guard lock(mutex_);
    kept_ = std::move(arrays);
  }
  /// Records a picture without Gaussians.
  void note_idle() {
    const std::lock_guard lock(mutex_);
    if (++idle_ >= kMostIdle) kept_ = nullptr;
  }

 private:
  std::mutex mutex_;
  int idle_ = 0;  // pictures since the last one with Gaussians
  std::unique_ptr<GaussianArrays> kept_;
};

}  // namespace gs::render
