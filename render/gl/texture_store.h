#pragma once

#include "render/gl/gpu.h"
#include "render/image/image.h"
#include "render/scene/layered_material.h"

#include <array>
#include <cstdint>
#include <memory>
#include <unordered_map>
#include <utility>
#include <vector>

namespace gs::render {

/// Halves each side of an image that has more than one pixel, by exact area averages. If a side is odd, each output
/// pixel averages parts of three pixels.
[[nodiscard]] Image halved(const Image& image);

/// GPU textures of images, with mipmaps.
class TextureStore {
 public:
  enum class Alpha : std::uint8_t { none, cut_out, blended };  // cut_out: each pixel is opaque or fully transparent
  struct Entry {
    std::weak_ptr<const Image> image;
    Texture texture;
    bool mask = false;       // image used as alpha, see find_mask()
    bool intensity = false;  // 1 or 2 components: modulates the colour; 3 or 4: replaces it (VRML97 Table 4.6)
    Alpha alpha = Alpha::none;
    std::uint64_t version = 0;                            // Image::version at the last upload
    std::uint32_t width = 0, height = 0, components = 0;  // size of the texture
    std::uint32_t order = 0;                              // unique among the stored textures; for sorting
  };

  explicit TextureStore(const Gl& gl);

  /// Returns the texture of an image, and uploads the image if necessary. Returns null if the image is empty or
  /// malformed. Valid until the next `forget_unused`. Row 0 of the texture is the top of the image.
  const Entry* find(const std::shared_ptr<const Image>& image);
  /// Like find(), for an image of one component that is used as the alpha of white. Has no mipmaps.
  const Entry* find_mask(const std::shared_ptr<const Image>& image);
  void forget_unused();
  /// Binds the texture to unit 0.
  void bind(const Entry& entry, bool repeat_s, bool repeat_t);
  /// Binds the texture to a unit, with the sampler of `sampling`. Leaves unit 0 active.
  void bind(const Entry& entry, const Sampling& sampling, GLuint unit);
  /// Binds the sampler of `sampling` to a unit.
  void bind_sampler(const Sampling& sampling, GLuint unit);
  /// Binds a mask to unit 0. Uses a linear filter if `smooth`, otherwise the nearest pixel, which is faster in software
  /// drivers.
  void bind_mask(const Entry& entry, bool smooth);

 private:
  void upload(const Image& image, Entry& entry);
  void upload_mask(const Image& image, Entry& entry);

  const Gl& gl_;
  std::array<Sampler, 6> samplers_;  // index: bit 0 repeats S, bit 1 repeats T; last two: masks, nearest and linear
  std::vector<std::pair<Sampling, Sampler>> own_samplers_;  // of TextureProperties
  std::unordered_map<const Image*, Entry> entries_;
  std::uint32_t next_order_ = 1;
};

}  // namespace gs::render
