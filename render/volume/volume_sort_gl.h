#pragma once

#include "render/gl/gpu.h"

#include <cstddef>
#include <memory>
#include <string>

namespace gs::render {

/// Sorts the vectors of volumes by depth with compute shaders (OpenGL 4.3): the order that VolumeSorter makes, but for
/// the rounding of positions to codes, at once. Belongs to the thread of its context.
class VolumeGlSort {
 public:
  /// `defines`: those of kVolumeDataShader. Null when this context has no compute shaders or refuses these.
  static std::unique_ptr<VolumeGlSort> create(const Gl& gl, const std::string& defines);

  /// What kVolumeDataShader reads, as buffer textures.
  struct Data {
    GLuint codes = 0, items = 0;
    int item_count = 0;
  };
  /// Puts the numbers of `total` vectors into `order`, which becomes so large, the farthest first; ready to be read as
  /// attributes. False when there is no memory for it.
  bool sort(const Data& data, std::size_t total, const Buffer& order);

 private:
  explicit VolumeGlSort(const Gl& gl) : gl_(gl) {}
  bool make_room(std::size_t total);
  bool fill(const Buffer& buffer, std::size_t bytes) const;

  const Gl& gl_;
  Program keys_, count_, scan_, scatter_;
  Buffer sorted_keys_, unsorted_keys_, values_, counts_;
  std::size_t room_ = 0;
};

}  // namespace gs::render
