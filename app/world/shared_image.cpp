#include "app/world/shared_image.h"

#include "app/formats/texture_image.h"

#include <utility>

namespace gs::app {

using SharedImage = WorldLoading::State::SharedImage;

SharedImage::SharedImage(WorldLoading::State& loading, std::string type_name, std::string text, SourceLocation location,
                         vrml::MFString list)
    : world(loading),
      type(std::move(type_name)),
      file(std::move(text)),
      place(location),
      urls(std::move(list)),
      held(loading.budget, Resource::files) {}

bool SharedImage::begin(const Found& where) {
  name = where.path;
  return true;
}

bool SharedImage::whole_file(const net::MappedFile& mapped, const std::string& /*path*/) {
  decode(mapped.bytes());
  return true;
}

void SharedImage::receive(std::span<const std::byte> piece) {
  if (stage != Stage::coming) return;
  if (held.grow(piece.size())) {
    bytes.insert(bytes.end(), piece.begin(), piece.end());
  } else {
    leave_out(world.budget->refusal(Resource::files));
    bytes = {};
  }
}

void SharedImage::end(const std::optional<std::string>& problem) {
  if (problem) world.report(Severity::warning, file, place, type + ": " + *problem);
  if (stage == Stage::coming) decode(bytes);
  bytes = {};
  held.shrink_to(0);
}

void SharedImage::missing(const std::string& why) {
  stage = Stage::none;
  if (!told) world.report(Severity::warning, file, place, type + ": " + why_missing(urls, why));
  world.image_arrived({std::exchange(textures, {}), nullptr});
}

void SharedImage::add(const ResourceUpdates::Place& texture) {
  if (stage == Stage::coming)
    textures.push_back(texture);
  else
    world.image_arrived({{texture}, image.lock()});
}

void SharedImage::leave_out(const std::string& why) {
  stage = Stage::none;
  world.image_arrived({std::exchange(textures, {}), nullptr});
  world.report(Severity::warning, file, place, type + " " + name + ": " + why + "; left out");
}

void SharedImage::decode(std::span<const std::byte> from) {
  stage = Stage::shown;
  auto decoded = decode_texture(from, world.budget);
  if (auto* error = std::get_if<render::ImageError>(&decoded)) return leave_out(error->message);
  Texture& texture = std::get<Texture>(decoded);
  if (!texture.note.empty()) world.report(Severity::warning, file, place, type + " " + name + ": " + texture.note);
  image = texture.image;
  world.image_arrived({std::exchange(textures, {}), std::move(texture.image)});
}

}  // namespace gs::app
