#include "app/picture/picture_marks.h"

#include "render/text/system_fonts.h"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace gs::app {
namespace {

constexpr std::size_t kFine = 1;  // tolerance for glyphs, as an index in vrml::kTextTolerances
constexpr int kSide = 4;  // samples along each axis of a pixel

const vrml::FontRequest& label_font() {
  static const vrml::FontRequest font{{"SANS"}, false, false, {}};
  return font;
}

void blend_pixel(std::uint8_t* pixel, std::uint32_t components, const glm::vec3& color, float opacity) {
  const float below = components == 4 ? static_cast<float>(pixel[3]) / 255 : 1.0f;
  const float alpha = opacity + below * (1 - opacity);
  if (!(alpha > 0)) return;
  for (int c = 0; c < 3; ++c) {
    const float own = static_cast<float>(pixel[c]) / 255;
    const float mixed = (color[c] * opacity + own * below * (1 - opacity)) / alpha;
    pixel[c] = static_cast<std::uint8_t>(std::lround(std::clamp(mixed, 0.0f, 1.0f) * 255));
  }
  if (components == 4) pixel[3] = static_cast<std::uint8_t>(std::lround(std::clamp(alpha, 0.0f, 1.0f) * 255));
}

/// Samples of a rectangle of pixels, each covered by a triangle or not.
class Coverage {
 public:
  Coverage(const glm::ivec2& from, const glm::ivec2& to)
      : from_(from),
        size_((to - from) * kSide),
        samples_(static_cast<std::size_t>(size_.x) * static_cast<std::size_t>(size_.y)) {}

  void add(glm::vec2 a, glm::vec2 b, glm::vec2 c) {
    for (glm::vec2* p : {&a, &b, &c}) *p = (*p - glm::vec2(from_)) * static_cast<float>(kSide) - 0.5f;
    const float area = cross(b - a, c - a);
    if (!(area != 0)) return;
    const glm::vec2 low = glm::min(a, glm::min(b, c)), high = glm::max(a, glm::max(b, c));
    const int x0 = std::max(0, static_cast<int>(std::ceil(low.x))),
              y0 = std::max(0, static_cast<int>(std::ceil(low.y)));
    const int x1 = std::min(size_.x - 1, static_cast<int>(std::floor(high.x)));
    const int y1 = std::min(size_.y - 1, static_cast<int>(std::floor(high.y)));
    const float sign = area > 0 ? 1.0f : -1.0f;
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x) {
        const glm::vec2 p(x, y);
        if (sign * cross(b - a, p - a) >= 0 && sign * cross(c - b, p - b) >= 0 && sign * cross(a - c, p - c) >= 0)
          samples_[static_cast<std::size_t>(y) * static_cast<std::size_t>(size_.x) + static_cast<std::size_t>(x)] =
              true;
      }
  }
  [[nodiscard]] float at(int x, int y) const {
    int count = 0;
    for (int j = 0; j < kSide; ++j)
      for (int i = 0; i < kSide; ++i) {
        const int column = (x - from_.x) * kSide + i, row = (y - from_.y) * kSide + j;
        count += samples_[static_cast<std::size_t>(row) * static_cast<std::size_t>(size_.x) +
                          static_cast<std::size_t>(column)]
                     ? 1
                     : 0;
      }
    return static_cast<float>(count) / (kSide * kSide);
  }

 private:
  static float cross(const glm::vec2& a, const glm::vec2& b) { return a.x * b.y - a.y * b.x; }
  glm::ivec2 from_, size_;
  std::vector<bool> samples_;
};

/// Clips a rectangle of pixels to the band. Returns false if the result is empty.
bool clip_to(const PictureBand& band, glm::ivec2& from, glm::ivec2& to) {
  const int width = static_cast<int>(band.image.width), height = static_cast<int>(band.image.height);
  from = glm::max(from, glm::ivec2(0, band.top));
  to = glm::min(to, glm::ivec2(width, band.top + height));
  return from.x < to.x && from.y < to.y;
}

std::uint8_t* pixel_at(const PictureBand& band, int x, int y) {
  return band.image.pixels.data() +
         (static_cast<std::size_t>(y - band.top) * band.image.width + static_cast<std::size_t>(x)) *
             band.image.components;
}

}  // namespace

void draw_rectangle(const PictureBand& band, const glm::vec2& from, const glm::vec2& to, const glm::vec3& color,
                    float opacity) {
  glm::ivec2 low(std::lround(from.x), std::lround(from.y)), high(std::lround(to.x), std::lround(to.y));
  if (!clip_to(band, low, high)) return;
  for (int y = low.y; y < high.y; ++y)
    for (int x = low.x; x < high.x; ++x) blend_pixel(pixel_at(band, x, y), band.image.components, color, opacity);
}

float text_width(std::string_view text) {
  return static_cast<float>(render::system_fonts().shape(label_font(), text, vrml::TextDirection::right, kFine).extent);
}

void draw_text(const PictureBand& band, std::string_view text, const glm::vec2& at, float size,
               const glm::vec3& color) {
  const vrml::ShapedText line = render::system_fonts().shape(label_font(), text, vrml::TextDirection::right, kFine);
  for (const vrml::PlacedGlyph& glyph : line.glyphs) {
    if (!glyph.shape || glyph.shape->points.empty()) continue;
    const auto place = [&](std::uint32_t index) {
      const glm::vec2 ems = glyph.at + glyph.shape->points[index];
      return glm::vec2(at.x + ems.x * size, at.y - ems.y * size);
    };
    glm::vec2 low = place(0), high = low;
    for (std::uint32_t i = 1; i < glyph.shape->points.size(); ++i) {
      low = glm::min(low, place(i));
      high = glm::max(high, place(i));
    }
    glm::ivec2 from(static_cast<int>(std::floor(low.x)), static_cast<int>(std::floor(low.y)));
    glm::ivec2 to(static_cast<int>(std::ceil(high.x)), static_cast<int>(std::ceil(high.y)));
    if (!clip_to(band, from, to)) continue;
    Coverage coverage(from, to);
    const auto& triangles = glyph.shape->triangles;
    for (std::size_t t = 0; t + 2 < triangles.size(); t += 3)
      coverage.add(place(triangles[t]), place(triangles[t + 1]), place(triangles[t + 2]));
    for (int y = from.y; y < to.y; ++y)
      for (int x = from.x; x < to.x; ++x)
        if (const float part = coverage.at(x, y); part > 0)
          blend_pixel(pixel_at(band, x, y), band.image.components, color, part);
  }
}

void draw_color_bar(const PictureBand& band, const glm::ivec2& size, const ColorBar& bar) {
  constexpr glm::vec3 kPanel(0.07f, 0.08f, 0.09f), kText(0.93f, 0.94f, 0.95f);
  const float em = std::clamp(static_cast<float>(std::min(size.x, size.y)) / 40, 9.0f, 400.0f);
  const float height = std::min(static_cast<float>(size.y) * 0.5f, 24 * em), width = 1.2f * em;
  const auto most = static_cast<std::size_t>(std::max(2.0f, height / (2 * em)));
  const std::vector<Tick> ticks = nice_ticks(bar.range, most);
  float labels = 0;
  for (const Tick& tick : ticks) labels = std::max(labels, text_width(tick.label));
  const float inner = std::max(width + (labels + 0.9f) * em, bar.title.empty() ? 0.0f : text_width(bar.title) * em);
  const glm::vec2 panel_size(inner + 1.4f * em, height + 1.6f * em + (bar.title.empty() ? 0 : 1.6f * em));
  const glm::vec2 corner(static_cast<float>(size.x) - panel_size.x - em,
                         (static_cast<float>(size.y) - panel_size.y) / 2);
  draw_rectangle(band, corner, corner + panel_size, kPanel, 0.72f);
  glm::vec2 at = corner + glm::vec2(0.7f * em, 0.8f * em);
  if (!bar.title.empty()) {
    draw_text(band, bar.title, at + glm::vec2(0, 0.75f * em), em, kText);
    at.y += 1.6f * em;
  }
  const int rows = static_cast<int>(std::lround(height));
  for (int row = 0; row < rows; ++row) {
    const float place = 1 - (static_cast<float>(row) + 0.5f) / static_cast<float>(rows);
    const qnv::Rgb8 color = transfer_at(bar.colors, place).color;
    const float y = at.y + static_cast<float>(row);
    draw_rectangle(band, {at.x, y}, {at.x + width, y + 1}, glm::vec3(color.r, color.g, color.b) / 255.0f);
  }
  const float line = std::max(1.0f, em / 12);
  for (const Tick& tick : ticks) {
    const float y = at.y + height * static_cast<float>(1 - tick.place);
    draw_rectangle(band, {at.x + width, y - line / 2}, {at.x + width + 0.4f * em, y + line / 2}, kText);
    draw_text(band, tick.label, {at.x + width + 0.7f * em, y + 0.35f * em}, em, kText);
  }
}

}  // namespace gs::app
