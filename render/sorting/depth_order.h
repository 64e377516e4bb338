#pragma once

#include "render/gl/gpu.h"
#include "render/sorting/depth_sort.h"
#include "render/sorting/depth_sort_gl.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

namespace gs::render {

/// Method that sorts vectors for OpenGL. automatic: compute shaders if the hardware supports them, otherwise a thread.
/// If compute shaders fail, the thread replaces them.
enum class SortMethod : std::uint8_t { automatic, thread, compute };

/// Orders of vectors by depth for the successive views of several viewports, as buffers of OpenGL. Compute shaders sort
/// exactly for the view. The order of the thread may be that of the previous view (DepthSorter). A view for which the
/// order holds is not sorted again. Runs on the thread of its context.
class DepthOrder {
 public:
  /// `keys` is the shader of DepthGlSort.
  DepthOrder(const Gl& gl, SortMethod method, std::string keys);

  struct Result {
    const Buffer& far_first;  // numbers of the vectors, farthest first
    bool pending = false;     // the order is that of an earlier view: draw again
  };
  /// Returns the order of all vectors of `parts`, which `data` describes for the shader. Returns nullopt if memory does
  /// not suffice. Valid until the next call.
  std::optional<Result> order(std::uint32_t viewport, std::span<const SortPart> parts, const DepthGlSort::Data& data);

  /// Returns the method that made the last order.
  [[nodiscard]] SortMethod sorted_by() const { return sorted_by_; }

 private:
  struct Viewport {
    std::unique_ptr<DepthSorter> sorter;
    Buffer order;
    std::uint64_t number = 0;             // serial number of the thread's order in the buffer; 0 means none
    std::vector<DepthSorter::Seen> seen;  // view for which the compute shaders sorted
    std::uint64_t used = 0;
  };
  Viewport& viewport(std::uint32_t number);
  bool sort_with_compute(std::span<const SortPart> parts, std::size_t total, const DepthGlSort::Data& data,
                         Viewport& viewport);

  const Gl& gl_;
  SortMethod wanted_, sorted_by_ = SortMethod::thread;
  std::string keys_;
  std::unique_ptr<DepthGlSort> compute_;
  bool tried_compute_ = false;
  std::unordered_map<std::uint32_t, Viewport> viewports_;
  std::uint64_t frame_ = 0;
};

}  // namespace gs::render
