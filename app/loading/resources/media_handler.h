#pragma once

#include "app/loading/resources/resource_handler.h"
#include "app/media/media_file.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gs::app {

/// Content handler for a sound or movie of AudioClips or MovieTextures (VRML97 6.4, 6.28), which several nodes may
/// play.
class MediaHandler final : public ResourceHandler {
 public:
  using ResourceHandler::ResourceHandler;

  bool begin(const Found& found) override;
  // Takes ownership of a local file. A long file stays mapped and needs no memory.
  bool take_file(net::MappedFile& file) override;
  void receive(std::span<const std::byte> bytes) override;
  void end(const std::optional<std::string>& problem) override;
  // Returns the reason why the file is unreadable, so that the next url is tried (VRML97 4.5.2).
  std::optional<std::string> wants_next() override { return stage_ == Stage::waiting ? refused_ : std::nullopt; }
  void missing(const std::string& why) override;

  /// Adds a node, which gets the media now or when it is available.
  void add(const ResourceUpdates::Place& player);
  /// Returns true if no node uses the media any more.
  [[nodiscard]] bool is_spent() const {
    return stage_ == Stage::none || (stage_ == Stage::shown && media_.expired() && image_.expired());
  }

 private:
  void refuse_size();
  void examine(std::shared_ptr<MediaFile> file);
  void give(std::shared_ptr<const MediaFile> media, std::shared_ptr<const render::Image> first);

  bool closed_ = false;  // further bytes are ignored
  std::optional<std::string> refused_;
  std::vector<ResourceUpdates::Place> players_;
  std::weak_ptr<const MediaFile> media_;
  std::weak_ptr<const render::Image> image_;
  enum class Stage : std::uint8_t { waiting, shown, none };
  Stage stage_ = Stage::waiting;
};

}  // namespace gs::app
