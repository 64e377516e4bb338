#include "app/formats/texture_image.h"

#include "app/confined/image_decoding.h"

#include <algorithm>
#include <cstdint>
#include <utility>

namespace gs::app {
namespace {

// Bytes per pixel. kMaxPixelBytes: 4 components and the renderer's copy. kCopyBytes: only that copy, with its mipmaps.
constexpr std::uint64_t kMaxPixelBytes = 10, kCopyBytes = 6;
// Minimum number of pixels. A smaller image is useless.
constexpr std::uint64_t kMinPixels = 64 * 64;

std::string size_of(std::uint32_t width, std::uint32_t height) {
  return std::to_string(width) + "x" + std::to_string(height);
}

}  // namespace

render::ImageLimits texture_limits(const WorldBudget& budget) {
  const Limits& limits = budget->limits();
  const std::uint64_t left = budget->left(Resource::pixels) / 2 / kMaxPixelBytes;
  render::ImageLimits image_limits;
  image_limits.file_pixels = limits.image_pixels;
  image_limits.kept_pixels = static_cast<std::size_t>(std::min<std::uint64_t>(limits.texture_pixels, left));
  image_limits.working_bytes = static_cast<std::size_t>(budget->left(Resource::pixels) / 2);
  image_limits.stopped = [budget] { return budget->stopped(); };
  return image_limits;
}

std::variant<Texture, render::ImageError> decode_texture(std::span<const std::byte> bytes, const WorldBudget& budget) {
  const render::ImageLimits image_limits = texture_limits(budget);
  if (image_limits.kept_pixels < kMinPixels) return render::ImageError{budget->refusal(Resource::pixels)};
  auto decoded = decode_confined(bytes, image_limits);
  if (auto* error = std::get_if<render::ImageError>(&decoded)) return std::move(*error);
  return hold_texture(std::move(std::get<render::Image>(decoded)), budget);
}

std::variant<Texture, render::ImageError> hold_texture(render::Image given, const WorldBudget& budget) {
  struct Held {
    render::Image image;
    Share share;
  };
  auto held = std::make_shared<Held>(Held{std::move(given), Share(budget, Resource::pixels)});
  const render::Image& image = held->image;
  const std::uint64_t cost = image.pixels.size() + kCopyBytes * image.width * image.height;
  if (!held->share.grow(cost)) return render::ImageError{budget->refusal(Resource::pixels)};
  Texture texture;
  if (image.reduction > 1)
    texture.note =
        "is shown as " +
        (image.slices > 1 && !image.cube
             ? size_of(image.width, image.height / image.slices) + "x" + std::to_string(image.slices) + " voxels, "
             : size_of(image.width, image.height) + " pixels, ") +
        std::to_string(image.reduction) + " times smaller in each direction: " +
        (texture_limits(budget).kept_pixels < budget->limits().texture_pixels
             ? budget->refusal(Resource::pixels)
             : "more than the limit for one texture, " + std::to_string(budget->limits().texture_pixels) + " pixels");
  texture.image = {held, &held->image};
  return texture;
}

}  // namespace gs::app
