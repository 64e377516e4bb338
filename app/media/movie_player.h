#pragma once

#include "app/media/media_file.h"
#include "base/budget.h"
#include "render/image/image.h"

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

namespace gs::app {

/// Decodes movie pictures for requested times: on its own thread so that no frame waits, or synchronously for exact
/// pictures. Memory is bounded: one picture for each movie, plus the state of render::Movie. Use from one thread.
class MoviePlayers {
 public:
  class Player;

  MoviePlayers() = default;
  ~MoviePlayers();
  MoviePlayers(const MoviePlayers&) = delete;
  MoviePlayers& operator=(const MoviePlayers&) = delete;

  /// Opens a movie. `first` is its initial picture. Returns null if the budget has no room for it.
  [[nodiscard]] std::shared_ptr<Player> open(std::shared_ptr<const MediaFile> file, const render::Image& first,
                                             const WorldBudget& budget);
  /// Shows the picture at `seconds` of movie time. If `wait` is false, decodes in the background and shows the last
  /// picture ready so far. Use the same value of `wait` for all calls on one player. Returns true if the image changed.
  bool show(const std::shared_ptr<Player>& player, double seconds, bool wait);
  /// Reports whether a requested picture is still pending.
  [[nodiscard]] bool waits(const Player& player);

 private:
  void run(const std::stop_token& stop);

  std::shared_ptr<std::atomic<bool>> over_ = std::make_shared<std::atomic<bool>>(false);  // stop flag of the decoders
  std::mutex mutex_;
  std::condition_variable_any something_;
  std::vector<std::weak_ptr<Player>> asked_;  // guarded by mutex_
  std::jthread thread_;                       // last member, so that it joins first; starts on demand
};

/// One movie as shown by one node. The image object stays the same; its pixels change.
class MoviePlayers::Player {
 public:
  [[nodiscard]] const std::shared_ptr<render::Image>& image() const { return image_; }
  /// Reports whether anyone else, such as the renderer, holds the image.
  [[nodiscard]] bool shown() const { return image_.use_count() > kOwn; }

  Player(std::shared_ptr<const MediaFile> file, std::shared_ptr<render::Image> image, Share share, WorldBudget budget,
         std::shared_ptr<std::atomic<bool>> over);
  ~Player();

 private:
  friend class MoviePlayers;
  static constexpr long kOwn = 2;  // references held by this player and the world's image list
  struct Decoder;

  std::shared_ptr<const MediaFile> file_;
  std::shared_ptr<render::Image> image_;
  Share share_;
  WorldBudget budget_;
  double shown_time_ = 0;  // movie time of the picture in image_
  std::shared_ptr<std::atomic<bool>> over_;
  std::unique_ptr<Decoder> decoder_;
};

}  // namespace gs::app
