#pragma once

#include "app/loading/updates/loaded_world.h"
#include "app/media/movie_player.h"
#include "vrml/events/execution.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace gs::app {

/// Movies of a running world, as images with pixels that change in place. Used by the world's thread.
class WorldMovies {
 public:
  WorldMovies(LoadedWorld& world, vrml::Execution& execution) : world_(world), execution_(execution) {}

  /// Gives the movie of a node an own image. Does nothing if its file has no pictures.
  void open(const MediaDuration& of);
  /// Shows the frames of the present time. With `wait`, blocks until they are decoded; otherwise shows them as soon as
  /// they are. Returns true if a frame changed.
  bool show(bool wait);
  /// Returns the number of frames that were shown.
  [[nodiscard]] std::uint64_t pictures() const { return pictures_; }
  /// Returns true if at least one movie is playing.
  [[nodiscard]] bool running() const { return running_; }
  /// Closes the movie of a node.
  void forget(const vrml::Node& node);

 private:
  struct Played {
    vrml::SceneGraph* scene;
    vrml::NodeId id;
    const vrml::Node* node;
    std::shared_ptr<MoviePlayers::Player> player;
  };

  LoadedWorld& world_;
  vrml::Execution& execution_;
  MoviePlayers players_;
  std::vector<Played> movies_;
  std::uint64_t pictures_ = 0;
  bool running_ = false;
};

}  // namespace gs::app
