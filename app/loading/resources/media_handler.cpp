#include "app/loading/resources/media_handler.h"

#include "app/formats/texture_image.h"

#include <utility>
#include <variant>

namespace gs::app {

bool MediaHandler::begin(const Found& found) {
  drop_bytes();
  closed_ = false;
  return ResourceHandler::begin(found);
}

bool MediaHandler::take_file(net::MappedFile& file) {
  closed_ = true;
  const std::size_t copied = file.bytes().size() < net::MappedFile::kMappedSize ? file.bytes().size() : 0;
  if (held_.grow(copied))
    examine(std::make_shared<MediaFile>(std::move(file), std::exchange(held_, {loading_.budget, Resource::files})));
  else
    refuse_size();
  return true;
}

void MediaHandler::receive(std::span<const std::byte> bytes) {
  if (!closed_ && !keep(bytes)) refuse_size();
}

void MediaHandler::end(const std::optional<std::string>& problem) {
  if (problem) warn(": " + *problem);
  if (stage_ != Stage::waiting || closed_) return;
  bytes_.shrink_to_fit();
  examine(
      std::make_shared<MediaFile>(std::exchange(bytes_, {}), std::exchange(held_, {loading_.budget, Resource::files})));
}

void MediaHandler::missing(const std::string& why) {
  stage_ = Stage::none;
  if (refused_)
    warn(" " + found_.path + ": " + *refused_ + "; left out");
  else
    ResourceHandler::missing(why);
  give(nullptr, nullptr);
}

void MediaHandler::refuse_size() {
  closed_ = true;
  drop_bytes();
  refused_ = loading_.budget->refusal(Resource::files);
}

void MediaHandler::examine(std::shared_ptr<MediaFile> file) {
  refused_.reset();
  auto info = examine_confined(file->encoded(), [budget = loading_.budget] { return budget->stopped(); });
  const auto* known = std::get_if<render::MediaInfo>(&info);
  std::shared_ptr<const render::Image> first;
  if (request_.content == vrml::UrlContent::movie) {
    // Decodes the first frame of a movie, or the image of any other file.
    auto decoded = decode_texture(file->bytes(), loading_.budget);
    if (auto* texture = std::get_if<Texture>(&decoded)) {
      if (!texture->note.empty()) warn(" " + found_.path + ": " + texture->note);
      first = std::move(texture->image);
    } else if (!known || known->pictures) {
      refused_ = std::get<render::ImageError>(decoded).message;
      return;
    }
  } else if (known && !known->sound) {
    refused_ = "it has no sound";
    return;
  }
  if (auto* wrong = std::get_if<render::MediaError>(&info)) {
    if (!first) {
      refused_ = std::move(wrong->message);
      return;
    }
    file = nullptr;
  } else {
    file->info = std::get<render::MediaInfo>(info);
    file->name = found_.path;
  }
  stage_ = Stage::shown;
  media_ = file;
  image_ = first;
  give(std::move(file), std::move(first));
}

void MediaHandler::give(std::shared_ptr<const MediaFile> media, std::shared_ptr<const render::Image> first) {
  loading_.results.add(ResourceUpdates::Media{std::exchange(players_, {}), std::move(media), std::move(first)});
}

void MediaHandler::add(const ResourceUpdates::Place& player) {
  if (stage_ == Stage::waiting)
    players_.push_back(player);
  else
    loading_.results.add(ResourceUpdates::Media{{player}, media_.lock(), image_.lock()});
}

}  // namespace gs::app
