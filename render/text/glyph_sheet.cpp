#include "render/text/glyph_sheet.h"

#include <glm/common.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace gs::render {
namespace {

constexpr std::uint32_t kMaxOfGlyph = 160;  // maximum side of a glyph in pixels: five ems
// Grey patterns for words, one below the other, at the start of the atlas. They have eight pixels per em, as small text
// has.
constexpr std::uint32_t kGreys = 16, kGreyWidth = 256, kGreyHeight = 8, kGreyPixelsPerEm = 8;
constexpr int kLines = 8;  // lines per row of pixels for which coverage is computed

/// Returns a pseudo-random value from 0 to kGreys - 1 for a position. The values are evenly distributed.
std::uint32_t scattered(std::uint32_t x, std::uint32_t y) {
  std::uint32_t hash = x * 0x9E3779B1u ^ y * 0x85EBCA77u;
  hash = (hash ^ hash >> 15) * 0x2C1B3C6Du;
  hash = (hash ^ hash >> 12) * 0x297A2D39u;
  return (hash ^ hash >> 15) % kGreys;
}

/// Adds the coverage by an interval to a row of pixels. `full` is the coverage of a complete pixel.
void cover(std::vector<float>& row, double from, double to, float full) {
  const auto count = static_cast<double>(row.size());
  from = std::clamp(from, 0.0, count);
  to = std::clamp(to, 0.0, count);
  for (auto x = static_cast<std::size_t>(from); x < row.size() && static_cast<double>(x) < to; ++x) {
    const auto left = static_cast<double>(x);
    row[x] += full * static_cast<float>(std::min(to, left + 1) - std::max(from, left));
  }
}

/// Computes how much the contours cover each pixel of a row, in pixel units. `y` is the lower edge of the row.
void fill_row(const Contours& contours, double y, std::vector<float>& row) {
  std::fill(row.begin(), row.end(), 0.0f);
  std::vector<std::pair<double, int>> crossings;
  for (int line = 0; line < kLines; ++line) {
    const double at = y + (line + 0.5) / kLines;
    crossings.clear();
    for (const auto& contour : contours)
      for (std::size_t i = 0, before = contour.size() - 1; i < contour.size(); before = i++) {
        const glm::dvec2 &a = contour[before], &b = contour[i];
        if ((a.y <= at) == (b.y <= at)) continue;
        crossings.emplace_back(a.x + (at - a.y) / (b.y - a.y) * (b.x - a.x), a.y <= at ? 1 : -1);
      }
    std::sort(crossings.begin(), crossings.end());
    int turns = 0;
    for (std::size_t i = 0; i + 1 < crossings.size(); ++i) {
      turns += crossings[i].second;
      if (turns != 0) cover(row, crossings[i].first, crossings[i + 1].first, 1.0f / kLines);
    }
  }
}

}  // namespace

GlyphSheet::Grey GlyphSheet::grey(double density, const glm::vec2& size) {
  const auto row = static_cast<std::uint32_t>(std::clamp(std::lround(density * kGreys), 1L, long{kGreys}) - 1);
  const auto pixels = [](float ems, std::uint32_t most) {
    return std::clamp(ems * float{kGreyPixelsPerEm}, 1.0f, static_cast<float>(most));
  };
  const float top = static_cast<float>(row * kGreyHeight);
  return {glm::vec2(0, 1 - (top + pixels(size.y, kGreyHeight)) / kSide),
          glm::vec2(pixels(size.x, kGreyWidth) / kSide, 1 - top / kSide)};
}

/// Reserves a rectangle in the atlas and returns its first pixel. Returns null if the atlas is full.
std::uint8_t* GlyphSheet::place(std::uint32_t width, std::uint32_t height) {
  if (image_.empty()) {
    image_ = {kSide, kSide, 1, std::vector<std::uint8_t>(std::size_t{kSide} * kSide)};
    for (std::uint32_t y = 0; y < kGreys * kGreyHeight; ++y)
      for (std::uint32_t x = 0; x < kGreyWidth; ++x)
        if (scattered(x, y % kGreyHeight) <= y / kGreyHeight) image_.pixels[std::size_t{y} * kSide + x] = 255;
    x_ = kGreyWidth;
    row_ = kGreys * kGreyHeight;
  }
  if (width > kMaxOfGlyph || height > kMaxOfGlyph) return nullptr;
  if (x_ + width > kSide) {
    x_ = 0;
    y_ += row_;
    row_ = 0;
  }
  if (y_ + height > kSide) return nullptr;
  row_ = std::max(row_, height);
  return image_.pixels.data() + std::size_t{y_} * kSide + x_;
}

std::optional<vrml::GlyphShape> GlyphSheet::add(const Contours& contours) {
  Contours scaled = contours;
  glm::dvec2 least(HUGE_VAL), greatest(-HUGE_VAL);
  for (auto& contour : scaled)
    for (glm::dvec2& point : contour) {
      point *= double{kPixelsPerEm};
      least = glm::min(least, point);
      greatest = glm::max(greatest, point);
    }
  if (!(least.x < greatest.x) || !(least.y < greatest.y)) return vrml::GlyphShape{};
  // Add an empty border, so that the filter does not mix in neighbouring glyphs.
  const glm::dvec2 lower = glm::floor(least) - 1.0, size = glm::ceil(greatest) + 1.0 - lower;
  if (!(size.x <= kMaxOfGlyph) || !(size.y <= kMaxOfGlyph)) return std::nullopt;
  const auto width = static_cast<std::uint32_t>(size.x), height = static_cast<std::uint32_t>(size.y);
  std::uint8_t* to = place(width, height);
  if (!to) return std::nullopt;
  for (auto& contour : scaled)
    for (glm::dvec2& point : contour) point -= lower;
  std::vector<float> row(width);
  for (std::uint32_t y = 0; y < height; ++y) {
    fill_row(scaled, height - 1 - y, row);
    for (std::uint32_t x = 0; x < width; ++x)
      to[std::size_t{y} * kSide + x] = static_cast<std::uint8_t>(std::min(row[x], 1.0f) * 255 + 0.5f);
  }
  shown_ = nullptr;

  const glm::vec2 from(lower / double{kPixelsPerEm}), until((lower + size) / double{kPixelsPerEm});
  const auto part = [](std::uint32_t pixels) { return static_cast<float>(pixels) / kSide; };
  const glm::vec2 low(part(x_), 1 - part(y_ + height)), high(part(x_ + width), 1 - part(y_));
  x_ += width;
  vrml::GlyphShape shape;
  shape.points = {from, {until.x, from.y}, until, {from.x, until.y}};
  shape.coordinates = {low, {high.x, low.y}, high, {low.x, high.y}};
  shape.triangles = {0, 1, 2, 0, 2, 3};
  return shape;
}

std::shared_ptr<const Image> GlyphSheet::image() {
  if (image_.empty()) (void)place(0, 0);
  if (!shown_) shown_ = std::make_shared<const Image>(image_);
  return shown_;
}

}  // namespace gs::render
