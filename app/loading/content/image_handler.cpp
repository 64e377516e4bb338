#include "app/loading/content/image_handler.h"

#include "app/formats/texture_image.h"

#include <utility>

namespace gs::app {

void ImageHandler::receive(std::span<const std::byte> bytes) {
  if (stage_ != Stage::waiting || keep(bytes)) return;
  refuse(loading_.budget->refusal(Resource::files));
  bytes_ = {};
}

void ImageHandler::end(const std::optional<std::string>& problem) {
  if (problem) warn(": " + *problem);
  if (stage_ == Stage::waiting) decode(bytes_);
  drop_bytes();
}

void ImageHandler::missing(const std::string& why) {
  stage_ = Stage::none;
  ResourceHandler::missing(why);
  loading_.results.add(ResourceUpdates::Image{std::exchange(textures_, {}), nullptr});
}

void ImageHandler::add(const ResourceUpdates::Place& texture) {
  if (stage_ == Stage::waiting)
    textures_.push_back(texture);
  else
    loading_.results.add(ResourceUpdates::Image{{texture}, image_.lock()});
}

void ImageHandler::refuse(const std::string& why) {
  stage_ = Stage::none;
  loading_.results.add(ResourceUpdates::Image{std::exchange(textures_, {}), nullptr});
  warn(" " + found_.path + ": " + why + "; left out");
}

void ImageHandler::decode(std::span<const std::byte> from) {
  stage_ = Stage::shown;
  auto decoded = decode_texture(from, loading_.budget);
  if (auto* error = std::get_if<render::ImageError>(&decoded)) return refuse(error->message);
  Texture& texture = std::get<Texture>(decoded);
  if (!texture.note.empty()) warn(" " + found_.path + ": " + texture.note);
  image_ = texture.image;
  loading_.results.add(ResourceUpdates::Image{std::exchange(textures_, {}), std::move(texture.image)});
}

}  // namespace gs::app
