#pragma once

#include "render/gl/gpu.h"
#include "render/image/image.h"

#include <array>
#include <cstdint>
#include <memory>
#include <unordered_map>

namespace gs::render {

/// Keeps images in the memory of the GPU, with mipmaps.
class TextureStore {
 public:
  enum class Alpha : std::uint8_t { none, cut_out, blended };  // cut_out: every pixel is opaque or invisible
  struct Entry {
    std::weak_ptr<const Image> image;
    Texture texture;
    bool mask = false;       // its alpha
    bool intensity = false;  // 1 or 2 components: multiplies; else replaces the colour (VRML97 Table 4.6)
    Alpha alpha = Alpha::none;
    std::uint64_t version = 0;                            // of the image, that is there
    std::uint32_t width = 0, height = 0, components = 0;  // of the texture
    std::uint32_t order = 0;                              // unique among the textures that live; for sorting
  };

  explicit TextureStore(const Gl& gl);

  /// The texture of the image, uploading it if need be; null when the image is empty or malformed.
  /// Valid until the next call of `forget_unused`. Row 0 of the texture is the top of the image.
  const Entry* find(const std::shared_ptr<const Image>& image);
  /// Likewise, of an image of one component, which is its alpha; its colour is white. Without mipmaps.
  const Entry* find_mask(const std::shared_ptr<const Image>& image);
  void forget_unused();
  /// Binds to texture unit 0.
  void bind(const Entry& entry, bool repeat_s, bool repeat_t);
  /// Likewise a mask: the nearest pixel, which drivers on the processor are quicker with, or between four.
  void bind_mask(const Entry& entry, bool smooth);

 private:
  void upload(const Image& image, Entry& entry);
  void upload_mask(const Image& image, Entry& entry);

  const Gl& gl_;
  std::array<Sampler, 6> samplers_;  // bit 0: repeat S, bit 1: repeat T; then of masks: as they are, smooth
  std::unordered_map<const Image*, Entry> entries_;
  std::uint32_t next_order_ = 1;
};

}  // namespace gs::render
