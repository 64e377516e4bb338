#include "app/encode/textured_surface.h"
#include "app/encode/surface_triangles.h"
#include "render/image/image.h"

#include <glm/common.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <span>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

namespace gs::app {
namespace {

using render::DrawItem;
using render::Image;

// In pixels: margin around each tile, for mipmaps; size of a tile with a single colour.
constexpr std::uint32_t kMargin = 8, kSolidMargin = 16;
// Limits of the atlas: repetitions of a repeated texture, and pixels per axis.
constexpr float kMaxRepeats = 8;
constexpr std::uint32_t kMaxPixels = 4096;
// If there is only one texture, it keeps its coordinates up to this number of repetitions.
constexpr float kMaxSpan = 16;

// Coarse previews precede the image. The first preview has kCoarsest to 2 * kCoarsest pixels per axis. A preview larger
// than 1/kWorthOfCoarse of the image's bytes is omitted. A PNG is decoded row by row, so it gets several previews, each
// one kFiner times finer.
constexpr std::uint32_t kCoarsest = 48, kFiner = 4;
constexpr std::size_t kWorthOfCoarse = 3;
constexpr int kCoarseQuality = 50, kFullChroma = 95;
// PNG is used only if it is at least this factor smaller than JPEG.
constexpr std::size_t kWorthOfPng = 3;

/// Tile of the texture atlas.
struct TextureTile {
  const Image* image = nullptr;  // texture; null for a tile with a single colour
  bool repeat_s = true, repeat_t = true;
  glm::vec3 color{1};  // the single colour; with an intensity texture, its factor
  glm::vec2 lower{std::numeric_limits<float>::max()}, upper{std::numeric_limits<float>::lowest()};  // used coordinates
  std::uint32_t x = 0, y = 0, width = 0, height = 0;  // rectangle in the atlas in pixels, with margins
};
using TileKey = std::tuple<const Image*, bool, bool, float, float, float>;

bool seen_through(const Image& image) {
  if (!image.has_alpha()) return false;
  for (std::size_t i = image.components - 1; i < image.pixels.size(); i += image.components)
    if (image.pixels[i] != 255) return true;
  return false;
}

glm::vec3 rounded_color(const qnv::Rgb8& c) { return glm::vec3(c.r, c.g, c.b) / 255.0f; }

/// Returns the single colour of an item, which is also the factor of an intensity texture. Returns nullopt if the item
/// has several colours.
std::optional<glm::vec3> one_color_of(const DrawItem& item) {
  const vrml::Mesh& mesh = *item.mesh;
  if (mesh.colors.size() == mesh.positions.size()) {
    const vrml::Color first = mesh.colors[mesh.indices[0]];
    for (const std::uint32_t i : mesh.indices) {
      const vrml::Color& c = mesh.colors[i];
      if (c.r != first.r || c.g != first.g || c.b != first.b) return std::nullopt;
    }
    return glm::vec3(first.r, first.g, first.b);
  }
  if (item.material.lit) return item.material.diffuse + item.material.emissive;
  return mesh.lit ? glm::vec3(1.0f) : item.material.emissive;
}

std::uint32_t pixel(std::int64_t at, std::uint32_t size, bool repeat) {
  const std::int64_t n = size;
  return static_cast<std::uint32_t>(repeat ? ((at % n) + n) % n : std::clamp<std::int64_t>(at, 0, n - 1));
}

/// Returns a pixel of a tile's texture. Pixel (0, 0) is in the lower left corner.
glm::vec3 pixel_of(const TextureTile& tile, std::int64_t x, std::int64_t y) {
  if (!tile.image) return tile.color;
  const Image& image = *tile.image;
  const std::size_t row = image.height - 1 - pixel(y, image.height, tile.repeat_t);
  const std::uint8_t* c =
      image.pixels.data() + (row * image.width + pixel(x, image.width, tile.repeat_s)) * image.components;
  if (image.components < 3) return tile.color * (static_cast<float>(c[0]) / 255.0f);
  return glm::vec3(c[0], c[1], c[2]) / 255.0f;
}

/// Arranges tiles in rows of an atlas with this width. Returns the height of the atlas in pixels.
std::uint32_t lay_out(std::vector<TextureTile>& tiles, std::uint32_t width) {
  std::vector<std::size_t> order(tiles.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::greater<>(), [&](std::size_t i) { return tiles[i].height; });
  std::uint32_t x = 0, y = 0, high = 0;
  for (const std::size_t i : order) {
    TextureTile& tile = tiles[i];
    if (x + tile.width > width) {
      y += std::exchange(high, 0);
      x = 0;
    }
    tile.x = x;
    tile.y = y;
    x += tile.width;
    high = std::max(high, tile.height);
  }
  return y + high;
}

/// Returns the lowest pixel of a tile's texture that is in use, as x and y.
glm::vec2 first_pixel(const TextureTile& tile) {
  return tile.image ? glm::floor(tile.lower * glm::vec2(static_cast<float>(tile.image->width),
                                                        static_cast<float>(tile.image->height)))
                    : glm::vec2(0);
}

class PictureGatherer {
 public:
  explicit PictureGatherer(qnv::TexturedSurface& to) : to_(to) {}

  /// Starts an item; its triangles follow. Returns false if an atlas cannot represent the item.
  bool begin(const DrawItem& item) {
    TextureTile tile;
    if (shows_picture(item)) {
      tile.image = item.texture.image.get();
      tile.repeat_s = item.texture.repeat_s;
      tile.repeat_t = item.texture.repeat_t;
      const auto [at, fresh] = seen_through_.try_emplace(tile.image, false);
      if (fresh) at->second = seen_through(*tile.image);
      if (at->second) return false;
    }
    if (!tile.image || tile.image->components < 3) {
      const auto color = one_color_of(item);
      if (!color) return false;
      tile.color = rounded_color(to_rgb8(*color));
    }
    const auto [at, fresh] = keys_.try_emplace(
        TileKey(tile.image, tile.repeat_s, tile.repeat_t, tile.color.r, tile.color.g, tile.color.b), tiles.size());
    if (fresh) tiles.push_back(tile);
    now_ = at->second;
    return true;
  }
  void add(const qnv::Triangle& triangle, const std::array<glm::vec2, 3>& at) {
    to_.triangles.push_back(triangle);
    to_.coordinates.push_back(at);
    of.push_back(now_);
    TextureTile& tile = tiles[now_];
    for (const glm::vec2& p : at) {
      tile.lower = glm::min(tile.lower, p);
      tile.upper = glm::max(tile.upper, p);
    }
  }
  /// Shifts the texture coordinates of each triangle by whole repetitions, so that they start in the first repetition.
  void shift() {
    for (TextureTile& tile : tiles) {
      tile.lower = glm::vec2(std::numeric_limits<float>::max());
      tile.upper = glm::vec2(std::numeric_limits<float>::lowest());
    }
    for (std::size_t t = 0; t < of.size(); ++t) {
      TextureTile& tile = tiles[of[t]];
      auto& at = to_.coordinates[t];
      const glm::vec2 whole = glm::floor(glm::min(at[0], glm::min(at[1], at[2])));
      for (glm::vec2& p : at) {
        p -= glm::vec2(tile.repeat_s ? whole.x : 0, tile.repeat_t ? whole.y : 0);
        tile.lower = glm::min(tile.lower, p);
        tile.upper = glm::max(tile.upper, p);
      }
    }
  }

  std::vector<TextureTile> tiles;
  std::vector<std::size_t> of;  // index in `tiles` for each triangle

 private:
  qnv::TexturedSurface& to_;
  std::map<TileKey, std::size_t> keys_;
  std::map<const Image*, bool> seen_through_;
  std::size_t now_ = 0;
};

/// Paints all tiles into one atlas and adapts the texture coordinates. Returns nullopt if the tiles do not fit.
std::optional<Image> painted(PictureGatherer& gathered, qnv::TexturedSurface& surface) {
  std::vector<TextureTile>& tiles = gathered.tiles;
  double pixels = 0;
  std::uint32_t widest = 0;
  for (TextureTile& tile : tiles) {
    glm::vec2 size(kSolidMargin);
    if (tile.image) {
      // Outside a texture without repetition, the border colour continues, so coordinates may exceed 0..1.
      const glm::vec2 shown = tile.upper - tile.lower;
      if (!(shown.x * shown.y <= kMaxRepeats) || !(std::max(shown.x, shown.y) <= kMaxSpan)) return std::nullopt;
      const glm::vec2 of(static_cast<float>(tile.image->width), static_cast<float>(tile.image->height));
      size = glm::ceil(tile.upper * of) - first_pixel(tile) + 1.0f;
    }
    if (!(std::max(size.x, size.y) + 2 * kMargin <= static_cast<float>(kMaxPixels))) return std::nullopt;
    tile.width = static_cast<std::uint32_t>(size.x) + 2 * kMargin;
    tile.height = static_cast<std::uint32_t>(size.y) + 2 * kMargin;
    pixels += static_cast<double>(tile.width) * tile.height;
    widest = std::max(widest, tile.width);
  }
  if (pixels > static_cast<double>(kMaxPixels) * kMaxPixels) return std::nullopt;
  Image image;
  image.components = 3;
  image.width = std::clamp(static_cast<std::uint32_t>(std::sqrt(pixels) * 1.05) + 1, widest, kMaxPixels);
  image.height = lay_out(tiles, image.width);
  if (image.height > kMaxPixels) {
    image.width = kMaxPixels;
    image.height = lay_out(tiles, image.width);
  }
  if (image.height > kMaxPixels) return std::nullopt;
  image.pixels.resize(std::size_t{3} * image.width * image.height);
  for (const TextureTile& tile : tiles) {
    const glm::vec2 first = first_pixel(tile);
    for (std::uint32_t y = 0; y < tile.height; ++y)
      for (std::uint32_t x = 0; x < tile.width; ++x) {
        const qnv::Rgb8 c = to_rgb8(pixel_of(tile, static_cast<std::int64_t>(first.x) + x - kMargin,
                                             static_cast<std::int64_t>(first.y) + tile.height - 1 - y - kMargin));
        std::uint8_t* to = image.pixels.data() + 3 * (std::size_t{tile.y + y} * image.width + tile.x + x);
        to[0] = c.r;
        to[1] = c.g;
        to[2] = c.b;
      }
  }
  const glm::vec2 all(static_cast<float>(image.width), static_cast<float>(image.height));
  for (std::size_t t = 0; t < gathered.of.size(); ++t) {
    const TextureTile& tile = tiles[gathered.of[t]];
    const glm::vec2 corner(static_cast<float>(tile.x + kMargin),
                           static_cast<float>(image.height - tile.y - tile.height + kMargin));
    for (glm::vec2& p : surface.coordinates[t]) {
      glm::vec2 at(0.5f * kSolidMargin);
      if (tile.image)
        at = p * glm::vec2(static_cast<float>(tile.image->width), static_cast<float>(tile.image->height)) -
             first_pixel(tile);
      p = (corner + at) / all;
    }
  }
  return image;
}

Image without_alpha(const Image& image) {
  Image plain;
  plain.width = image.width;
  plain.height = image.height;
  plain.components = image.components < 3 ? 1 : 3;
  plain.pixels.reserve(std::size_t{plain.width} * plain.height * plain.components);
  for (std::size_t i = 0; i < image.pixels.size(); i += image.components)
    plain.pixels.insert(plain.pixels.end(), image.pixels.begin() + static_cast<std::ptrdiff_t>(i),
                        image.pixels.begin() + static_cast<std::ptrdiff_t>(i + plain.components));
  return plain;
}

/// Downsamples an image. Each pixel is the average of a square with `by` pixels per side.
Image smaller(const Image& image, std::uint32_t by) {
  Image out;
  out.components = image.components;
  out.width = std::max(1u, image.width / by);
  out.height = std::max(1u, image.height / by);
  out.pixels.reserve(std::size_t{out.width} * out.height * out.components);
  for (std::uint32_t y = 0; y < out.height; ++y)
    for (std::uint32_t x = 0; x < out.width; ++x)
      for (std::uint32_t k = 0; k < out.components; ++k) {
        std::uint32_t sum = 0, count = 0;
        for (std::uint32_t v = y * by; v < std::min((y + 1) * by, image.height); ++v)
          for (std::uint32_t u = x * by; u < std::min((x + 1) * by, image.width); ++u, ++count)
            sum += image.pixels[(std::size_t{v} * image.width + u) * image.components + k];
        out.pixels.push_back(static_cast<std::uint8_t>((sum + count / 2) / count));
      }
  return out;
}

/// Returns the error of a coarse image against the fine image, at the resolution of the fine one.
double error_of(const Image& coarse, const Image& fine) {
  double sum = 0;
  for (std::uint32_t y = 0; y < fine.height; ++y) {
    const std::size_t row = std::size_t{y} * coarse.height / fine.height;
    for (std::uint32_t x = 0; x < fine.width; ++x) {
      const std::size_t column = std::size_t{x} * coarse.width / fine.width;
      for (std::uint32_t k = 0; k < fine.components; ++k) {
        const double off = fine.pixels[(std::size_t{y} * fine.width + x) * fine.components + k] -
                           coarse.pixels[(row * coarse.width + column) * coarse.components + k];
        sum += off * off;
      }
    }
  }
  return sum;
}

/// Quality of an image file: number of first bytes that give a smaller error than a given one, and the error of the
/// whole file.
struct Enough {
  std::size_t bytes = 0;
  double error = 0;
};
Enough enough_of(std::span<const std::byte> jpeg, const Image& image, double error) {
  const auto error_at = [&](std::size_t bytes) {
    const auto shown = render::decode_image(jpeg.first(bytes));
    const auto* part = std::get_if<Image>(&shown);
    return part && part->components == image.components ? error_of(*part, image)
                                                        : std::numeric_limits<double>::infinity();
  };
  Enough enough{jpeg.size(), error_at(jpeg.size())};
  for (const std::size_t end : render::scan_ends(jpeg))
    if (error_at(end) < error) {
      enough.bytes = end;
      break;
    }
  return enough;
}

/// Encodes an image with coarse previews before it, so that the first received bytes already show the texture.
void pack(const Image& image, int quality, qnv::TexturedSurface& surface) {
  surface.width = image.width;
  surface.height = image.height;
  std::vector<std::byte> fine = render::encode_jpeg(image, {quality, quality >= kFullChroma});
  std::vector<std::byte> png = render::encode_png(image);
  const bool as_png = fine.empty() || (!png.empty() && png.size() < fine.size() / kWorthOfPng);
  if (as_png) fine = std::move(png);
  double error = std::numeric_limits<double>::infinity();  // error of the last preview so far
  std::uint32_t by = std::bit_floor(std::max(image.width, image.height) / kCoarsest);
  for (; by > 1; by = as_png ? by / kFiner : 0) {
    // Reduced chroma would mix the colours of adjacent tiles, so keep full chroma resolution.
    std::vector<std::byte> coarse = render::encode_jpeg(smaller(image, by), {kCoarseQuality, true});
    if (coarse.empty() || coarse.size() > fine.size() / kWorthOfCoarse) break;
    // The first preview is small, and its first scans have almost no colour. So all of it is required.
    const Enough all = enough_of(coarse, image, error);
    const std::size_t enough = surface.picture.empty() ? coarse.size() : all.bytes;
    error = all.error;
    surface.picture.push_back({std::move(coarse), enough});
  }
  const std::size_t enough = as_png ? fine.size() : enough_of(fine, image, error).bytes;
  surface.picture.push_back({std::move(fine), enough});
}

}  // namespace

std::optional<qnv::TexturedSurface> textured_surface(const render::RenderList& list, const glm::dvec3& origin,
                                                     int quality) {
  qnv::TexturedSurface surface;
  PictureGatherer gathered(surface);
  bool good = true;
  const DrawItem* before = nullptr;
  for_each_whole_triangle(
      list,
      [&](const DrawItem& item, const qnv::Triangle& triangle, const std::array<glm::vec2, 3>& at) {
        if (&item != before) good = good && gathered.begin(item);
        before = &item;
        if (good) gathered.add(triangle, at);
      },
      origin);
  const auto pictures =
      std::ranges::count_if(gathered.tiles, [](const TextureTile& tile) { return tile.image != nullptr; });
  if (!good || pictures == 0) return std::nullopt;
  const TextureTile& first = gathered.tiles.front();
  if (gathered.tiles.size() == 1 && (first.image->components >= 3 || first.color == glm::vec3(1))) {
    const glm::vec2 span = first.upper - first.lower;
    if (!(std::max(span.x, span.y) <= kMaxSpan)) gathered.shift();
    surface.repeat_s = first.repeat_s;
    surface.repeat_t = first.repeat_t;
    pack(first.image->components == 2 || first.image->components == 4 ? without_alpha(*first.image) : *first.image,
         quality, surface);
  } else {
    gathered.shift();
    const auto image = painted(gathered, surface);
    if (!image) return std::nullopt;
    pack(*image, quality, surface);
    surface.repeat_s = surface.repeat_t = false;
  }
  if (surface.picture.empty()) return std::nullopt;
  return surface;
}

}  // namespace gs::app
