#pragma once

#include "app/world/content_handler.h"
#include "app/world/world_loading.h"
#include "app/world/world_loading_state.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace gs::app {

/// A picture that textures show, which is fetched once for all of them.
struct WorldLoading::State::SharedImage final : ContentHandler {
  /// `type_name`, `text`, `location`: of the node that asks first, and of its text, for messages; `list`: its urls.
  SharedImage(WorldLoading::State& loading, std::string type_name, std::string text, vrml::SourceLocation location,
              vrml::MFString list);

  bool begin(const Found& where) override;
  bool whole_file(const net::MappedFile& mapped, const std::string& path) override;
  void receive(std::span<const std::byte> piece) override;
  void end(const std::optional<std::string>& problem) override;
  void missing(const std::string& why) override;

  /// One more texture shows it: now, or once it is there.
  void add(const Arrivals::Place& texture);
  [[nodiscard]] bool has_none() const { return stage == Stage::none; }
  /// Nobody has what came any more.
  [[nodiscard]] bool is_spent() const { return stage == Stage::shown && image.expired(); }

 private:
  void leave_out(const std::string& why);
  void decode(std::span<const std::byte> from);

  WorldLoading::State& world;
  std::string type, file, name;  // of the node that asked first; of its text; of the picture
  vrml::SourceLocation place;
  vrml::MFString urls;
  std::vector<std::byte> bytes;
  vrml::Share held;  // of these
  std::vector<Arrivals::Place> textures;
  std::weak_ptr<const render::Image> image;
  enum class Stage : std::uint8_t { coming, shown, none };
  Stage stage = Stage::coming;
};

}  // namespace gs::app
