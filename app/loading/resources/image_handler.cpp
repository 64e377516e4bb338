#include "app/loading/resources/image_handler.h"

#include "app/base/temporary_file.h"
#include "app/formats/texture_image.h"
#include "app/formats/volume_texture.h"

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

// Reads a volume from its file. Writes received bytes to a temporary file, because volumes are read slice by slice.
std::variant<Texture, render::ImageError> ImageHandler::read_volume(std::span<const std::byte> from) {
  net::Url as_file = found_.url;
  as_file.scheme = "file";
  const std::string name = found_.local ? found_.path : net::path_of_url(as_file);
  const VolumeOrigin origin{loading_.fetcher.reader_of(found_.origin), name.substr(name.rfind('/') + 1)};
  if (found_.local) return read_volume_texture(found_.path, origin, loading_.budget);
  const TemporaryFile file(origin.name, from);
  if (!file.problem().empty()) return render::ImageError{file.problem()};
  return read_volume_texture(file.path(), origin, loading_.budget);
}

void ImageHandler::decode(std::span<const std::byte> from) {
  stage_ = Stage::shown;
  auto decoded = is_volume_texture(from) ? read_volume(from) : decode_texture(from, loading_.budget);
  if (auto* error = std::get_if<render::ImageError>(&decoded)) return refuse(error->message);
  Texture& texture = std::get<Texture>(decoded);
  if (!texture.note.empty()) warn(" " + found_.path + ": " + texture.note);
  image_ = texture.image;
  loading_.results.add(ResourceUpdates::Image{std::exchange(textures_, {}), std::move(texture.image)});
}

}  // namespace gs::app
