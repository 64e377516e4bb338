#pragma once

#include "render/gl/gpu.h"
#include "render/image/image.h"

#include <array>
#include <cstdint>
#include <memory>
#include <unordered_map>

namespace gs::render {

/// Caches images as GPU textures with mipmaps.
class TextureStore {
 public:
  enum class Alpha : std::uint8_t { none, cut_out, blended };  // cut_out: each pixel is either opaque or invisible
  struct Entry {
    std::weak_ptr<const Image> image;
    Texture texture;
    bool mask = false;       // used as a mask (alpha)
    bool intensity = false;  // 1 or 2 components: modulates; else replaces the colour (VRML97 Table 4.6)
    Alpha alpha = Alpha::none;
    std::uint64_t version = 0;                            // version of the image in the texture
    std::uint32_t width = 0, height = 0, components = 0;  // of the texture
    std::uint32_t order = 0;                              // unique among present textures; for sorting
  };

  explicit TextureStore(const Gl& gl);

  /// Returns the image's texture and uploads it if needed; null if the image is empty or malformed. Valid until the
  /// next `forget_unused`. Row 0 of the texture is the top of the image.
  const Entry* find(const std::shared_ptr<const Image>& image);
  /// Like find(), for an image of one component that is used as alpha of white; without mipmaps.
  const Entry* find_mask(const std::shared_ptr<const Image>& image);
  void forget_unused();
  /// Binds the texture to unit 0.
  void bind(const Entry& entry, bool repeat_s, bool repeat_t);
  /// Binds a mask to unit 0, with linear filter if `smooth`. Otherwise the nearest pixel, which is faster in software
  /// drivers.
  void bind_mask(const Entry& entry, bool smooth);

 private:
  void upload(const Image& image, Entry& entry);
  void upload_mask(const Image& image, Entry& entry);

  const Gl& gl_;
  std::array<Sampler, 6> samplers_;  // bit 0: repeat S, bit 1: repeat T; then masks: nearest, linear
  std::unordered_map<const Image*, Entry> entries_;
  std::uint32_t next_order_ = 1;
};

}  // namespace gs::render
