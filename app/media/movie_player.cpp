#include "app/media/movie_player.h"

#include "app/formats/texture_image.h"
#include "render/media/movie.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>

namespace gs::app {

/// State of a player's decoder. Only the decoding thread uses `movie`, `opened` and `decoded_problem`.
/// MoviePlayers::mutex_ guards the other members.
struct MoviePlayers::Player::Decoder {
  std::unique_ptr<MovieSource> movie;
  bool opened = false;
  double wanted = -1, done = -1;  // seconds of movie time
  bool busy = false;
  std::string problem, decoded_problem;  // for take_problem(); new one of the decoding thread, not published yet
  std::optional<render::Movie::Frame> ready;
  double ready_time = -1;  // requested movie time of the picture decoded last

  /// Decodes the picture at `seconds` of movie time. Returns nullopt if the picture begins at `before`, which the
  /// caller has, or on failure.
  std::optional<render::Movie::Frame> decode(const Player& of, double seconds, double before) {
    if (!std::exchange(opened, true)) {
      render::ImageLimits limits = texture_limits(of.budget_);
      limits.stopped = [over = of.over_] { return over->load(); };
      auto result = open_movie_confined(of.file_->encoded(), limits);
      if (auto* good = std::get_if<std::unique_ptr<MovieSource>>(&result))
        movie = std::move(*good);
      else
        decoded_problem = std::get<render::ImageError>(result).message;
    }
    if (!movie) return std::nullopt;
    const auto found = movie->at(seconds);
    const auto* frame = std::get_if<const render::Movie::Frame*>(&found);
    if (!frame || !*frame) {
      movie.reset();  // the last picture stays
      const auto* const error = std::get_if<render::ImageError>(&found);
      decoded_problem = error ? error->message : "it has no picture";
      return std::nullopt;
    }
    if ((*frame)->time == before) return std::nullopt;
    return **frame;
  }
};

MoviePlayers::Player::Player(std::shared_ptr<const MediaFile> file, std::shared_ptr<render::Image> image, Share share,
                             WorldBudget budget, std::shared_ptr<std::atomic<bool>> over)
    : file_(std::move(file)),
      image_(std::move(image)),
      share_(std::move(share)),
      budget_(std::move(budget)),
      over_(std::move(over)),
      decoder_(std::make_unique<Decoder>()) {}
MoviePlayers::Player::~Player() = default;

MoviePlayers::~MoviePlayers() { *over_ = true; }

std::shared_ptr<MoviePlayers::Player> MoviePlayers::open(std::shared_ptr<const MediaFile> file,
                                                         const render::Image& first, const WorldBudget& budget) {
  // pictures in memory: the visible one, a ready one, one in decoding, and the decoder's reference pictures
  constexpr std::size_t kPictures = 12;
  Share share(budget, Resource::pixels);
  if (!share.grow(kPictures * first.pixels.size())) return nullptr;
  return std::make_shared<Player>(std::move(file), std::make_shared<render::Image>(first), std::move(share), budget,
                                  over_);
}

bool MoviePlayers::show(const std::shared_ptr<Player>& of, double seconds, bool wait) {
  Player& player = *of;
  Player::Decoder& decoder = *player.decoder_;
  std::optional<render::Movie::Frame> frame;
  if (wait) {
    frame = decoder.decode(player, seconds, player.shown_time_);
    const std::lock_guard lock(mutex_);
    if (!decoder.decoded_problem.empty()) decoder.problem = std::exchange(decoder.decoded_problem, {});
  } else {
    if (!thread_.joinable()) thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
    {
      const std::lock_guard lock(mutex_);
      frame = std::exchange(decoder.ready, std::nullopt);
      if (decoder.wanted != seconds) {
        decoder.wanted = seconds;
        const auto same = [&](const std::weak_ptr<Player>& one) {
          return !one.owner_before(of) && !of.owner_before(one);
        };
        if (std::none_of(asked_.begin(), asked_.end(), same)) asked_.push_back(of);
      }
    }
    something_.notify_one();
  }
  if (!frame) return false;
  player.shown_time_ = frame->time;
  render::Image& image = *player.image_;
  const std::uint64_t version = image.version + 1;
  image = std::move(frame->image);
  image.version = version;
  return true;
}

bool MoviePlayers::waits(const Player& player) {
  const std::lock_guard lock(mutex_);
  return player.decoder_->ready || player.decoder_->busy || player.decoder_->wanted != player.decoder_->done;
}

std::string MoviePlayers::take_problem(const Player& player) {
  const std::lock_guard lock(mutex_);
  return std::exchange(player.decoder_->problem, {});
}

void MoviePlayers::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    std::shared_ptr<Player> player;
    double wanted = 0;
    {
      std::unique_lock lock(mutex_);
      const auto next = [&] {
        for (auto one = asked_.begin(); one != asked_.end();) {
          player = one->lock();
          const bool turn = player && player->decoder_->wanted != player->decoder_->done;
          if (turn) {
            std::rotate(one, one + 1, asked_.end());  // serve the other players next
            return true;
          }
          one = asked_.erase(one);
        }
        player = nullptr;
        return false;
      };
      if (!something_.wait(lock, stop, next)) return;
      player->decoder_->busy = true;
      wanted = player->decoder_->wanted;
    }
    Player::Decoder& decoder = *player->decoder_;
    auto frame = decoder.decode(*player, wanted, decoder.ready_time);
    const std::lock_guard lock(mutex_);
    decoder.done = wanted;
    decoder.busy = false;
    if (!decoder.decoded_problem.empty()) decoder.problem = std::exchange(decoder.decoded_problem, {});
    if (!frame) continue;
    decoder.ready_time = frame->time;
    decoder.ready = std::move(frame);
  }
}

}  // namespace gs::app
