#pragma once

#include "qnv/base/geometry.h"
#include "render/gl/gpu.h"
#include "render/gl/range_allocator.h"

#include <glm/vec2.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <vector>

namespace gs::render {

/// Texel of a Gaussian in the vertex shader's format. Texels 0 and 1 of a splat, 16-bit parts from the lowest bits on:
/// position as three floats, opacity, red; scales x, y, z, green, blue, three components of the rotation. Each further
/// texel has two coefficients of the harmonics as red, green, blue and an unused part.
///
/// Opacities are unsigned fractions; scales are logarithmic (0 means zero); colours and coefficients are signed
/// fractions of a limit. The rotation lacks its largest component; bits 15 of its first two parts are the index of that
/// component.
using GaussianTexel = std::array<std::uint32_t, 4>;

/// Parameters that decode the texels of Gaussians.
struct GaussianCoding {
  int degree = 0;          // of the harmonics
  std::size_t texels = 2;  // per splat
  glm::vec2 scale{0};      // log2 of a scale: x + code * y
  float base_limit = 1, harmonic_limit = 1;
  bool surfels = false;  // some splats are flat
};

/// Returns the parameters for Gaussians. Accepts any numbers.
[[nodiscard]] GaussianCoding gaussian_coding(const qnv::Gaussians& gaussians);
/// Encodes the splats from index `first` on, as many as `texels` can hold. Splats with numbers that are not finite get
/// the opacity 0.
void encode_gaussians(const qnv::Gaussians& gaussians, const GaussianCoding& coding, std::size_t first,
                      std::span<GaussianTexel> texels);

/// Gaussians in GPU memory, in one buffer texture, so that several scenes can be drawn in one order. A splat takes 32
/// bytes, and 128 more with harmonics of degree 3. Keeps data while the Gaussians have other owners. So a changed
/// cut of a stream uploads only its new clusters. Runs on the thread of its context.
class GaussianStore {
 public:
  /// Creates an empty store that uses at most `most_bytes` of GPU memory.
  explicit GaussianStore(const Gl& gl, std::size_t most_bytes = std::size_t{1} << 31);

  struct Place {
    std::size_t first = 0;  // texel of splat 0
    GaussianCoding coding;
  };
  /// Uploads the Gaussians that are not in the store. Returns their locations, in order, or an empty list if memory
  /// does not suffice. Valid until the next call.
  std::vector<Place> place(std::span<const std::shared_ptr<const qnv::Gaussians>> scenes);
  /// Frees the data of Gaussians that have no other owners. Call it once per frame.
  void forget_unused();

  [[nodiscard]] const Texture& codes() const { return codes_; }  // texture format GL_RGBA32UI
  [[nodiscard]] std::size_t bytes() const { return capacity_ * sizeof(GaussianTexel); }

 private:
  struct Entry {
    std::size_t count = 0;  // texels
    Place place;
    bool present = false;  // the data is in the buffer
    std::uint64_t used = 0, placed = 0;
  };
  using Entries = std::map<std::weak_ptr<const qnv::Gaussians>, Entry, std::owner_less<>>;
  using Held = Entries::value_type;
  void release(const Entry& entry);
  bool resize(std::size_t capacity);
  bool allocate(Entry& entry);
  void upload(std::vector<Held*> fresh);

  const Gl& gl_;
  std::size_t most_, capacity_ = 0;  // texels
  std::uint64_t frame_ = 0, placing_ = 0;
  Buffer buffer_;
  Texture codes_;
  RangeAllocator free_{0};
  Entries entries_;
};

}  // namespace gs::render
