#pragma once

#include "app/loading/updates/loaded_world.h"
#include "app/media/movie_player.h"
#include "vrml/events/execution.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace gs::app {

/// Movies of a running world. Each movie is an image with pixels that change in place. Use on the world's thread.
class WorldMovies {
 public:
  WorldMovies(LoadedWorld& world, vrml::Execution& execution) : world_(world), execution_(execution) {}

  /// Opens the movie of a node and gives it its own image. Does nothing if the file has no pictures.
  void open(const MediaDuration& of);
  /// Updates all movies to the present time. If `wait`, blocks until the pictures are decoded; otherwise a picture
  /// appears later, when it is ready. Returns true if a picture changed.
  bool show(bool wait);
  /// Returns the number of pictures that were shown so far.
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
