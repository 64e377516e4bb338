#pragma once

#include "app/media/media_file.h"
#include "base/budget.h"
#include "base/noncopyable.h"
#include "render/image/image.h"

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace gs::app {

/// Decoder of movie pictures for requested times. It decodes on its own thread, so that no frame waits, or
/// synchronously if exact pictures are needed. Memory is bounded: a few pictures for each movie, and the state of
/// render::Movie. The interface is for one thread.
class MoviePlayers : NonCopyable {
 public:
  class Player;

  ~MoviePlayers();

  /// Opens a movie. `first` is its first picture. Returns null if the budget has no room for the decoder's pictures.
  [[nodiscard]] std::shared_ptr<Player> open(std::shared_ptr<const MediaFile> file, const render::Image& first,
                                             const WorldBudget& budget);
  /// Shows the picture at `seconds` of movie time. If `wait` is false, decodes it in the background and shows the last
  /// picture that is ready. All calls for one player need the same `wait`. Returns true if the pixels of the image
  /// changed.
  bool show(const std::shared_ptr<Player>& player, double seconds, bool wait);
  /// Reports whether a requested picture still has to be decoded or shown.
  [[nodiscard]] bool waits(const Player& player);
  /// Returns the reason why a movie shows no further pictures, the first time; else an empty text.
  [[nodiscard]] std::string take_problem(const Player& player);

 private:
  void run(const std::stop_token& stop);

  std::shared_ptr<std::atomic<bool>> over_ = std::make_shared<std::atomic<bool>>(false);  // true stops decoding
  std::mutex mutex_;
  std::condition_variable_any something_;
  std::vector<std::weak_ptr<Player>> asked_;  // guarded by mutex_
  std::jthread thread_;  // last member, so that it joins first; starts at the first request
};

/// Movie of one node. The image object remains the same; its pixels change.
class MoviePlayers::Player {
 public:
  [[nodiscard]] const std::shared_ptr<render::Image>& image() const { return image_; }
  /// Reports whether the image has other owners, such as the renderer.
  [[nodiscard]] bool shown() const { return image_.use_count() > kOwn; }

  Player(std::shared_ptr<const MediaFile> file, std::shared_ptr<render::Image> image, Share share, WorldBudget budget,
         std::shared_ptr<std::atomic<bool>> over);
  ~Player();

 private:
  friend class MoviePlayers;
  static constexpr long kOwn = 2;  // owners of an unused image: this player and the world's list of images
  struct Decoder;

  std::shared_ptr<const MediaFile> file_;
  std::shared_ptr<render::Image> image_;
  Share share_;
  WorldBudget budget_;
  double shown_time_ = 0;  // movie time of the picture in image_, in seconds
  std::shared_ptr<std::atomic<bool>> over_;
  std::unique_ptr<Decoder> decoder_;
};

}  // namespace gs::app
