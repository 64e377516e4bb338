#pragma once

#include "app/formats/texture_image.h"
#include "app/loading/resources/resource_handler.h"

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace gs::app {

/// Content handler for an image. The image is fetched once for all textures that use it.
class ImageHandler final : public ResourceHandler {
 public:
  using ResourceHandler::ResourceHandler;

  bool whole_file(const net::MappedFile& file, const std::string&) override {
    decode(file.bytes());
    return true;
  }
  void receive(std::span<const std::byte> bytes) override;
  void end(const std::optional<std::string>& problem) override;
  void missing(const std::string& why) override;

  /// Adds a texture. The texture gets the image at once, or after the image was received.
  void add(const ResourceUpdates::Place& texture);
  [[nodiscard]] bool has_none() const { return stage_ == Stage::none; }
  /// Returns true if the image was received and no texture uses it any more.
  [[nodiscard]] bool is_spent() const { return stage_ == Stage::shown && image_.expired(); }

 private:
  void refuse(const std::string& why);
  [[nodiscard]] std::variant<Texture, render::ImageError> read_volume(std::span<const std::byte> bytes);
  void decode(std::span<const std::byte> bytes);

  std::vector<ResourceUpdates::Place> textures_;
  std::weak_ptr<const render::Image> image_;
  enum class Stage : std::uint8_t { waiting, shown, none };
  Stage stage_ = Stage::waiting;
};

}  // namespace gs::app
