#pragma once

#include "render/image/image.h"
#include "render/text/glyph_outline.h"
#include "vrml/mesh/text_shaper.h"

#include <glm/vec2.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

namespace gs::render {

/// Atlas of glyphs in one image, for small text of two triangles per glyph. At half its size, with a linear filter and
/// no mipmaps, edges are as sharp as those of outlines. Used by one thread at a time.
class GlyphSheet {
 public:
  static constexpr std::uint32_t kSide = 1024, kPixelsPerEm = 32;

  /// Adds a glyph, given its contours in ems under the non-zero winding rule, and returns its rectangle; without
  /// triangles if the glyph is empty. Returns nullopt if the atlas is full.
  [[nodiscard]] std::optional<vrml::GlyphShape> add(const Contours& contours);
  /// Returns a position at which the atlas is 255 all around.
  [[nodiscard]] static glm::vec2 solid() {
    const Grey all = grey(1, glm::vec2(0.25f));
    return (all.lower + all.upper) * 0.5f;
  }
  /// Rectangle of the atlas that looks like the letters of an unreadable word of `size` ems. A fraction `density` (0 to
  /// 1) of its pixels, scattered, is 255.
  struct Grey {
    glm::vec2 lower, upper;
  };
  [[nodiscard]] static Grey grey(double density, const glm::vec2& size);
  /// Returns the present atlas, of one component.
  [[nodiscard]] std::shared_ptr<const Image> image();

 private:
  [[nodiscard]] std::uint8_t* place(std::uint32_t width, std::uint32_t height);

  Image image_;
  std::shared_ptr<const Image> shown_;     // last returned image; null if the atlas has changed since
  std::uint32_t x_ = 0, y_ = 0, row_ = 0;  // position of the next glyph; height of its row
};

}  // namespace gs::render
