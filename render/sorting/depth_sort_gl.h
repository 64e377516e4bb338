#pragma once

#include "render/gl/gpu.h"

#include <cstddef>
#include <memory>
#include <string>

namespace gs::render {

/// Compiles a compute program. Returns an empty program if the driver rejects it.
[[nodiscard]] Program compute_program(const Gl& gl, const std::string& source);

/// Sorts vectors by depth with compute shaders (OpenGL 4.3), within the frame. The order is that of DepthSorter, except
/// for the rounding of positions to codes. Runs on the thread of its context.
class DepthGlSort {
 public:
  /// Compiles the shaders. `keys` decodes the positions of vectors and calls write_key (depth_sort_shaders.h). Returns
  /// null if the context has no compute shaders or rejects these.
  static std::unique_ptr<DepthGlSort> create(const Gl& gl, const std::string& keys);

  /// Buffer textures that kItemsShader reads.
  struct Data {
    GLuint codes = 0, items = 0;
    int item_count = 0;
  };
  /// Writes the indexes of `total` vectors to `order`, farthest first, and resizes it. The buffer can then serve as
  /// vertex attributes or as a buffer texture. Returns false if memory does not suffice.
  bool sort(const Data& data, std::size_t total, const Buffer& order);

 private:
  explicit DepthGlSort(const Gl& gl) : gl_(gl) {}
  bool make_room(std::size_t total);
  bool fill(const Buffer& buffer, std::size_t bytes) const;

  const Gl& gl_;
  Program keys_, count_, scan_, scatter_;
  Buffer sorted_keys_, unsorted_keys_, values_, counts_;
  std::size_t room_ = 0;
};

}  // namespace gs::render
