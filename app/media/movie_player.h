#pragma once

#include "app/base/world_budget.h"
#include "app/formats/media_file.h"
#include "render/image/image.h"

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

namespace gs::app {

/// Shows the pictures of movies at the times that are asked for, decoded on a thread of its own, so that no frame waits
/// for them; or at once, for who wants to see just these. Memory is bounded: of each movie, a picture and what
/// render::Movie keeps. Used by one thread.
class MoviePlayers {
 public:
  class Player;

  MoviePlayers() = default;
  ~MoviePlayers();
  MoviePlayers(const MoviePlayers&) = delete;
  MoviePlayers& operator=(const MoviePlayers&) = delete;

  /// `first`: the picture that it begins with. Null: there is no room for it.
  [[nodiscard]] std::shared_ptr<Player> open(std::shared_ptr<const MediaFile> file, const render::Image& first,
                                             const WorldBudget& budget);
  /// The picture at a time of the movie, in seconds, or with `wait` false a little later, the last one so far. One
  /// player is asked always one way. True when the image is another than before.
  bool show(const std::shared_ptr<Player>& player, double seconds, bool wait);
  /// Whether a picture that was asked for is still to come.
  [[nodiscard]] bool waits(const Player& player);

 private:
  void run(const std::stop_token& stop);

  std::shared_ptr<std::atomic<bool>> over_ = std::make_shared<std::atomic<bool>>(false);  // what is decoded, too
  std::mutex mutex_;
  std::condition_variable_any something_;
  std::vector<std::weak_ptr<Player>> asked_;  // guarded by mutex_
  std::jthread thread_;                       // last: joined before what it uses goes; begins when it is needed
};

/// One movie as one node shows it. The image stays where it is, and its pixels change.
class MoviePlayers::Player {
 public:
  [[nodiscard]] const std::shared_ptr<render::Image>& image() const { return image_; }
  /// Whether others have the image: who draws it.
  [[nodiscard]] bool shown() const { return image_.use_count() > kOwn; }

  Player(std::shared_ptr<const MediaFile> file, std::shared_ptr<render::Image> image, vrml::Share share,
         WorldBudget budget, std::shared_ptr<std::atomic<bool>> over);
  ~Player();

 private:
  friend class MoviePlayers;
  static constexpr long kOwn = 2;  // this one, and the world's list of images
  struct Decoder;

  std::shared_ptr<const MediaFile> file_;
  std::shared_ptr<render::Image> image_;
  vrml::Share share_;
  WorldBudget budget_;
  double shown_time_ = 0;  // of the picture in image_
  std::shared_ptr<std::atomic<bool>> over_;
  std::unique_ptr<Decoder> decoder_;
};

}  // namespace gs::app
