#include "app/confined/media_decoding.h"

#include "app/confined/decoder_pool.h"
#include "render/media/midi_reader.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <utility>

namespace gs::app {
namespace {

constexpr std::chrono::seconds kMediaPatience{60};  // for opening, and for a picture
constexpr std::chrono::seconds kSoundPatience{5};   // for a block of samples: other sounds wait meanwhile
constexpr double kLoudest = 16;                     // greatest amplitude of a sample that a child may send

/// Child that works on one file.
class MediaChild : NonCopyable {
 public:
  MediaChild(const EncodedMedia& media, std::function<bool()> stopped) : stopped_(std::move(stopped)) {
    DecoderPool& pool = DecoderPool::of_program();
    bytes_ = media.bytes.size();
    if (media.file >= 0) {
      process_ = std::make_unique<DecoderProcess>(pool.program(), DecoderKind::movies, media.file);
      pooled_ = false;
    } else {
      process_ = pool.take(DecoderKind::movies);
      loaded_ = process_->load(media.bytes);
    }
  }
  ~MediaChild() {
    if (pooled_) DecoderPool::of_program().give_back(DecoderKind::movies, std::move(process_));
  }

  [[nodiscard]] DecodeRequest request(DecodeOperation operation, const render::ImageLimits& limits = {}) const {
    return request_of(operation, bytes_, limits);
  }
  /// Sends a request. Returns the answer, which reports success, or the error.
  [[nodiscard]] std::variant<DecodeAnswer, render::ImageError> ask(const DecodeRequest& request,
                                                                   std::chrono::milliseconds patience,
                                                                   std::size_t result_bytes = 0) {
    if (!loaded_) return render::ImageError{"no memory to decode it"};
    auto answered = process_->ask(request, stopped_, patience, result_bytes);
    if (const auto* const answer = std::get_if<DecodeAnswer>(&answered); answer && answer->good != 1)
      return render::ImageError{error_in(*answer)};
    return answered;
  }
  [[nodiscard]] std::variant<render::Image, render::ImageError> ask_image(const DecodeRequest& request,
                                                                          DecodeAnswer& answer) {
    return process_->ask_image(request, stopped_, kMediaPatience, answer);
  }
  [[nodiscard]] std::span<const std::byte> results(std::size_t bytes) { return process_->results(bytes); }

 private:
  std::function<bool()> stopped_;
  std::unique_ptr<DecoderProcess> process_;
  std::size_t bytes_ = 0;
  bool pooled_ = true, loaded_ = true;
};

/// Movie in this process.
class LocalMovie final : public MovieSource {
 public:
  explicit LocalMovie(std::unique_ptr<render::Movie> movie) : movie_(std::move(movie)) {}
  std::variant<const render::Movie::Frame*, render::ImageError> at(double seconds) override {
    return movie_->at(seconds);
  }

 private:
  std::unique_ptr<render::Movie> movie_;
};

/// Movie in a child.
class RemoteMovie final : public MovieSource {
 public:
  RemoteMovie(std::unique_ptr<MediaChild> child, const render::ImageLimits& limits)
      : child_(std::move(child)), limits_(limits) {}

  std::variant<const render::Movie::Frame*, render::ImageError> at(double seconds) override {
    DecodeRequest request = child_->request(DecodeOperation::movie_at, limits_);
    request.seconds = seconds;
    request.known = frame_ ? frame_->time : -1;
    DecodeAnswer answer;
    auto image = child_->ask_image(request, answer);
    if (auto* const error = std::get_if<render::ImageError>(&image)) {
      if (frame_ && answer.good == 1 && answer.seconds == frame_->time) return &*frame_;
      return std::move(*error);
    }
    if (!std::isfinite(answer.seconds) || answer.seconds < 0)
      return render::ImageError{"the decoder gave an impossible time"};
    frame_ = render::Movie::Frame{std::move(std::get<render::Image>(image)), answer.seconds};
    return &*frame_;
  }

 private:
  std::unique_ptr<MediaChild> child_;
  render::ImageLimits limits_;
  std::optional<render::Movie::Frame> frame_;
};

/// Sound in a child.
class RemoteSamples final : public render::SampleReader {
 public:
  RemoteSamples(std::unique_ptr<MediaChild> child, double rate, int channels)
      : child_(std::move(child)), rate_(rate), channels_(channels) {}

  double rate() const override { return rate_; }
  int channels() const override { return channels_; }
  std::size_t read(std::span<float> to) override {
    std::size_t done = 0;
    while (to.size() >= 2) {
      const std::size_t pairs = std::min<std::size_t>(to.size() / 2, kMostPairs);
      const std::size_t count = read_block(to.first(pairs * 2));
      done += count;
      if (count < pairs) break;
      to = to.subspan(pairs * 2);
    }
    return done;
  }
  void seek(double seconds) override {
    DecodeRequest request = child_->request(DecodeOperation::seek_sound);
    request.seconds = seconds;
    (void)child_->ask(request, kSoundPatience);
  }

 private:
  std::size_t read_block(std::span<float> to) {
    DecodeRequest request = child_->request(DecodeOperation::read_sound);
    request.count = to.size() / 2;
    const auto answered = child_->ask(request, kSoundPatience, to.size_bytes());
    const auto* const answer = std::get_if<DecodeAnswer>(&answered);
    if (!answer) return 0;
    const std::size_t count = static_cast<std::size_t>(std::min<std::uint64_t>(answer->count, to.size() / 2));
    const auto samples = child_->results(count * 2 * sizeof(float));
    if (samples.size() < count * 2 * sizeof(float)) return 0;
    if (count == 0) return 0;
    std::memcpy(to.data(), samples.data(), samples.size());
    for (float& sample : to.first(count * 2))
      if (!(std::abs(sample) <= kLoudest)) sample = 0;
    return count;
  }

  std::unique_ptr<MediaChild> child_;
  double rate_;
  int channels_;
};

[[nodiscard]] bool in_this_process(const EncodedMedia& media) {
  return DecoderPool::of_program().program().empty() || render::is_midi(media.bytes);
}

}  // namespace

std::variant<render::MediaInfo, render::MediaError> examine_confined(const EncodedMedia& media,
                                                                     const std::function<bool()>& stopped) {
  if (in_this_process(media)) return render::examine_media(media.bytes, stopped);
  MediaChild child(media, stopped);
  const auto answered = child.ask(child.request(DecodeOperation::examine), kMediaPatience);
  if (const auto* const error = std::get_if<render::ImageError>(&answered)) return render::MediaError{error->message};
  const auto& answer = std::get<DecodeAnswer>(answered);
  return render::MediaInfo{std::isfinite(answer.seconds) ? answer.seconds : -1, answer.pictures != 0,
                           answer.sound != 0};
}

std::variant<std::unique_ptr<MovieSource>, render::ImageError> open_movie_confined(const EncodedMedia& media,
                                                                                   const render::ImageLimits& limits) {
  if (in_this_process(media)) {
    auto opened = render::Movie::open(media.bytes, limits);
    if (auto* const error = std::get_if<render::ImageError>(&opened)) return std::move(*error);
    return std::make_unique<LocalMovie>(std::move(std::get<std::unique_ptr<render::Movie>>(opened)));
  }
  auto child = std::make_unique<MediaChild>(media, limits.stopped);
  auto answered = child->ask(child->request(DecodeOperation::open_movie, limits), kMediaPatience);
  if (auto* const error = std::get_if<render::ImageError>(&answered)) return std::move(*error);
  return std::make_unique<RemoteMovie>(std::move(child), limits);
}

std::variant<std::unique_ptr<render::SampleReader>, render::MediaError> open_samples_confined(const EncodedMedia& media,
                                                                                              double synthesis_rate) {
  if (in_this_process(media)) return render::open_samples(media.bytes, synthesis_rate);
  auto child = std::make_unique<MediaChild>(media, std::function<bool()>());
  DecodeRequest request = child->request(DecodeOperation::open_sound);
  request.seconds = synthesis_rate;
  const auto answered = child->ask(request, kSoundPatience);
  if (const auto* const error = std::get_if<render::ImageError>(&answered)) return render::MediaError{error->message};
  const auto& answer = std::get<DecodeAnswer>(answered);
  constexpr double kHighestRate = 1e7;
  if (!(answer.seconds > 0 && answer.seconds <= kHighestRate) || answer.count < 1 || answer.count > 2)
    return render::MediaError{"the decoder gave an impossible sound"};
  return std::make_unique<RemoteSamples>(std::move(child), answer.seconds, static_cast<int>(answer.count));
}

}  // namespace gs::app
