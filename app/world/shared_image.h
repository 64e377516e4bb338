#pragma once

#include "app/world/content_handler.h"
#include "app/world/world_loading.h"
#include "app/world/world_loading_state.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace gs::app {

/// Content handler for an image that is fetched once for all textures that show it.
struct WorldLoading::State::SharedImage final : ContentHandler {
  /// Creates a handler. `type_name` is the type of the first texture, `text` and `location` are its position for
  /// messages; `list` has its urls.
  SharedImage(WorldLoading::State& loading, std::string type_name, std::string text, SourceLocation location,
              vrml::MFString list);

  bool begin(const Found& where) override;
  bool whole_file(const net::MappedFile& mapped, const std::string& path) override;
  void receive(std::span<const std::byte> piece) override;
  void end(const std::optional<std::string>& problem) override;
  void missing(const std::string& why) override;

  /// Adds a texture, which gets the image now or when it is available.
  void add(const ResourceUpdates::Place& texture);
  [[nodiscard]] bool has_none() const { return stage == Stage::none; }
  /// Returns true if the image was shown but no texture uses it any more.
  [[nodiscard]] bool is_spent() const { return stage == Stage::shown && image.expired(); }

 private:
  void leave_out(const std::string& why);
  void decode(std::span<const std::byte> from);

  WorldLoading::State& world;
  std::string type, file, name;  // type of the first texture, file of its text, name of the image
  SourceLocation place;
  vrml::MFString urls;
  std::vector<std::byte> bytes;
  Share held;  // of `bytes`
  std::vector<ResourceUpdates::Place> textures;
  std::weak_ptr<const render::Image> image;
  enum class Stage : std::uint8_t { coming, shown, none };
  Stage stage = Stage::coming;
};

}  // namespace gs::app
