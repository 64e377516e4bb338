#include "app/formats/texture_image.h"
#include "app/media/media_file.h"
#include "app/world/scene_handler.h"

#include <utility>

// Sounds and movies of AudioClips and MovieTextures (VRML97 6.4, 6.28).
namespace gs::app {

/// Content handler for a sound or movie that several nodes may play.
struct WorldLoading::State::SharedMedia final : ContentHandler {
  SharedMedia(State& state, vrml::UrlContent of, std::string type_name, std::string text, SourceLocation location,
              vrml::MFString list)
      : world(state),
        content(of),
        type(std::move(type_name)),
        file(std::move(text)),
        place(location),
        urls(std::move(list)),
        held(state.budget, Resource::files) {}

  bool begin(const Found& where) override {
    name = where.path;
    bytes = {};
    held.shrink_to(0);
    closed = false;
    return true;
  }
  // Takes a file. Long files stay mapped and need no memory.
  bool take_file(net::MappedFile& from) override {
    closed = true;
    const std::size_t copied = from.bytes().size() < net::MappedFile::kMappedSize ? from.bytes().size() : 0;
    if (held.grow(copied))
      examine(std::make_shared<MediaFile>(std::move(from), std::exchange(held, {world.budget, Resource::files})));
    else
      refuse_size();
    return true;
  }
  void receive(std::span<const std::byte> piece) override {
    if (closed) return;
    if (held.grow(piece.size())) {
      bytes.insert(bytes.end(), piece.begin(), piece.end());
      return;
    }
    refuse_size();
  }
  void end(const std::optional<std::string>& problem) override {
    if (problem) world.report(Severity::warning, file, place, type + ": " + *problem);
    if (stage != Stage::coming || closed) return;
    bytes.shrink_to_fit();
    examine(
        std::make_shared<MediaFile>(std::exchange(bytes, {}), std::exchange(held, {world.budget, Resource::files})));
  }
  // Rejects an unreadable file, so that the next url is tried (VRML97 4.5.2).
  std::optional<std::string> wants_next() override { return stage == Stage::coming ? refused : std::nullopt; }
  void missing(const std::string& why) override {
    stage = Stage::none;
    const std::string what = refused ? " " + name + ": " + *refused + "; left out" : ": " + why_missing(urls, why);
    if (refused || !told) world.report(Severity::warning, file, place, type + what);
    give(nullptr, nullptr);
  }

  void refuse_size() {
    closed = true;
    bytes = {};
    held.shrink_to(0);
    refuse(world.budget->refusal(Resource::files));
  }
  void refuse(std::string why) { refused = std::move(why); }
  void examine(std::shared_ptr<MediaFile> found) {
    const auto stopped = [budget = world.budget] { return budget->stopped(); };
    refused.reset();
    auto info = render::examine_media(found->bytes(), stopped);
    std::shared_ptr<const render::Image> first;
    if (content == vrml::UrlContent::movie) {
      // Decodes the first frame, or the only image of a file that is not a movie.
      auto decoded = decode_texture(found->bytes(), world.budget);
      if (auto* texture = std::get_if<Texture>(&decoded)) {
        if (!texture->note.empty())
          world.report(Severity::warning, file, place, type + " " + name + ": " + texture->note);
        first = std::move(texture->image);
      } else if (const auto* known = std::get_if<render::MediaInfo>(&info); !known || known->pictures) {
        return refuse(std::get<render::ImageError>(decoded).message);
      }
    } else if (const auto* known = std::get_if<render::MediaInfo>(&info); known && !known->sound) {
      return refuse("it has no sound");
    }
    if (auto* wrong = std::get_if<render::MediaError>(&info)) {
      if (!first) return refuse(std::move(wrong->message));
      found = nullptr;
    } else {
      found->info = std::get<render::MediaInfo>(info);
      found->name = name;
    }
    stage = Stage::shown;
    media = found;
    image = first;
    give(std::move(found), std::move(first));
  }
  void give(std::shared_ptr<const MediaFile> found, std::shared_ptr<const render::Image> first) {
    world.media_arrived({std::exchange(players, {}), std::move(found), std::move(first)});
  }
  void add(const ResourceUpdates::Place& player) {
    if (stage == Stage::coming)
      players.push_back(player);
    else
      world.media_arrived({{player}, media.lock(), image.lock()});
  }
  [[nodiscard]] bool is_spent() const {
    return stage == Stage::none || (stage == Stage::shown && media.expired() && image.expired());
  }

  State& world;
  vrml::UrlContent content;
  std::string type, file, name;  // type of the first node, file of its text, name of the media file
  SourceLocation place;
  vrml::MFString urls;
  std::vector<std::byte> bytes;
  Share held;           // of `bytes`
  bool closed = false;  // more bytes are ignored
  std::optional<std::string> refused;
  std::vector<ResourceUpdates::Place> players;
  std::weak_ptr<const MediaFile> media;
  std::weak_ptr<const render::Image> image;
  enum class Stage : std::uint8_t { coming, shown, none };
  Stage stage = Stage::coming;
};

void WorldLoading::State::media_arrived(ResourceUpdates::Media media) {
  changed = true;
  if (taken) {
    updates.media.push_back(std::move(media));
    return;
  }
  for (const ResourceUpdates::Place& player : media.players) {
    const vrml::Node* node = &player.scene->node(player.node);
    if (media.media) world.media[node] = media.media;
    if (media.image) world.images[node] = media.image;
    world.durations.push_back({player.scene, player.node, media.media ? media.media->info.duration : -1});
  }
}

void SceneHandler::visit_media(vrml::NodeId id) {
  const vrml::Node& node = scene->node(id);
  const auto& list = scene->get<vrml::MFString>(id, "url");
  if (list.empty()) return;
  UrlRequest request;
  request.place = {scene, id};
  request.node = &node;
  request.content = node.type->url_content;
  request.urls = list;
  request.type = node.type->name;
  request.file = node.text->file_name();
  request.location = node.location;
  load_media(request, refer(id));
}

void SceneHandler::load_media(const UrlRequest& request, Reference reference) {
  if (reference.places.empty()) return world_.media_arrived({{request.place}, nullptr, nullptr});
  std::erase_if(world_.shared_media, [](const auto& one) { return one.second->is_spent(); });
  const std::string key =
      fetch_key(reference.places, reference.from) + (request.content == vrml::UrlContent::movie ? "movie" : "sound");
  auto& shared = world_.shared_media[key];
  const bool fresh = !shared;
  if (fresh)
    shared = std::make_shared<WorldLoading::State::SharedMedia>(world_, request.content, request.type, request.file,
                                                                request.location, request.urls);
  shared->add(request.place);
  if (fresh) ask_for(std::move(reference), request.node, shared, Urgency::texture);
}

}  // namespace gs::app
