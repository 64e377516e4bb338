#include "app/formats/qnv/surface_pictures.h"
#include "app/formats/texture_image.h"

#include <glm/vec2.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <variant>

namespace gs::app {

std::shared_ptr<const render::Image> SurfacePictures::image_of(
    const std::shared_ptr<const qnv::SurfacePicture>& picture, const WorldBudget& budget) {
  std::erase_if(decoded_, [](const Decoded& one) { return one.picture.expired() || one.image.expired(); });
  for (const Decoded& one : decoded_)
    if (one.picture.lock() == picture) return one.image.lock();
  auto texture = decode_texture(picture->bytes, budget);
  if (!std::holds_alternative<Texture>(texture)) return nullptr;
  decoded_.push_back({picture, std::get<Texture>(texture).image});
  return std::move(std::get<Texture>(texture).image);
}

void color_by_picture(qnv::IndexedMesh& mesh, const WorldBudget& budget) {
  if (!mesh.picture || mesh.texture_coordinates.empty()) return;
  const auto texture = decode_texture(mesh.picture->bytes, budget);
  if (!std::holds_alternative<Texture>(texture)) return;
  const render::Image& image = *std::get<Texture>(texture).image;
  const auto pixel = [](float at, std::uint32_t size, bool repeat) {
    if (!std::isfinite(at)) return std::uint32_t{0};
    at = repeat ? at - std::floor(at) : std::clamp(at, 0.0f, 1.0f);
    return std::min(static_cast<std::uint32_t>(at * static_cast<float>(size)), size - 1);
  };
  mesh.colors.resize(mesh.size(), mesh.color);
  for (std::size_t i = 0, v = mesh.first_textured(); v < mesh.size(); ++v, ++i) {
    const glm::vec2& at = mesh.texture_coordinates[i];
    const std::uint32_t x = pixel(at.x, image.width, mesh.picture->repeat_s),
                        row = image.height - 1 - pixel(at.y, image.height, mesh.picture->repeat_t);
    const std::uint8_t* c = image.pixels.data() + (std::size_t{row} * image.width + x) * image.components;
    mesh.colors[v] = image.components < 3 ? qnv::Rgb8{c[0], c[0], c[0]} : qnv::Rgb8{c[0], c[1], c[2]};
  }
}

}  // namespace gs::app
