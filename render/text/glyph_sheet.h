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

/// Atlas of glyphs in one image. Small text needs only two triangles per glyph. At half the size of the atlas, with a
/// linear filter and no mipmaps, edges are as sharp as those of outlines. One thread at a time.
class GlyphSheet {
 public:
  static constexpr std::uint32_t kSide = 1024, kPixelsPerEm = 32;

  /// Adds a glyph and returns its rectangle. The contours are in ems and follow the non-zero winding rule. Returns a
  /// shape without triangles if the glyph is empty. Returns nullopt if the atlas is full.
  [[nodiscard]] std::optional<vrml::GlyphShape> add(const Contours& contours);
  /// Returns a position of the atlas at which all pixels around are 255.
  [[nodiscard]] static glm::vec2 solid() {
    const Grey all = grey(1, glm::vec2(0.25f));
    return (all.lower + all.upper) * 0.5f;
  }
  /// Pattern that imitates an unreadable word, `size` ems long. A share `density` (0 to 1) of its pixels, scattered, is
  /// 255.
  struct Grey {
    glm::vec2 lower, upper;
  };
  [[nodiscard]] static Grey grey(double density, const glm::vec2& size);
  /// Returns the current atlas as an image of one component.
  [[nodiscard]] std::shared_ptr<const Image> image();

 private:
  [[nodiscard]] std::uint8_t* place(std::uint32_t width, std::uint32_t height);

  Image image_;
  std::shared_ptr<const Image> shown_;  // last returned image; null after a change of the atlas
  std::uint32_t x_ = 0, y_ = 0, row_ = 0;  // position of the next glyph, and height of its row
};

}  // namespace gs::render
