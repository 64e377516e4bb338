#include "render/media/sample_reader.h"

#include "render/media/media_input.h"
#include "render/media/midi_reader.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace gs::render {
namespace {

constexpr int kMaxChannels = 8;
constexpr int kHighestRate = 768'000;

/// Returns the value of a sample of one channel, from about -1 to 1.
float value_of_sample(const AVFrame& frame, bool planar, int channels, int channel, int index) {
  const std::uint8_t* plane = planar ? frame.extended_data[channel] : frame.extended_data[0];
  const std::size_t at =
      planar ? static_cast<std::size_t>(index)
             : static_cast<std::size_t>(index) * static_cast<std::size_t>(channels) + static_cast<std::size_t>(channel);
  switch (frame.format) {
    case AV_SAMPLE_FMT_U8:
    case AV_SAMPLE_FMT_U8P:
      return (static_cast<float>(plane[at]) - 128) / 128;
    case AV_SAMPLE_FMT_S16:
    case AV_SAMPLE_FMT_S16P:
      return static_cast<float>(reinterpret_cast<const std::int16_t*>(plane)[at]) / 32768;
    case AV_SAMPLE_FMT_S32:
    case AV_SAMPLE_FMT_S32P:
      return static_cast<float>(reinterpret_cast<const std::int32_t*>(plane)[at]) / 2147483648.0f;
    case AV_SAMPLE_FMT_FLT:
    case AV_SAMPLE_FMT_FLTP:
      return reinterpret_cast<const float*>(plane)[at];
    case AV_SAMPLE_FMT_DBL:
    case AV_SAMPLE_FMT_DBLP:
      return static_cast<float>(reinterpret_cast<const double*>(plane)[at]);
    default:
      return 0;
  }
}

/// Weights of one input channel in left and right output. The input channels have FFmpeg's usual order: left, right,
/// centre, low frequency, back or side left, back or side right, and so on.
struct Fold {
  float left, right;
};
constexpr Fold kFolds[kMaxChannels] = {{1, 0},       {0, 1},       {0.7071f, 0.7071f}, {0, 0},
                                       {0.7071f, 0}, {0, 0.7071f}, {0.7071f, 0},       {0, 0.7071f}};

/// Reader of sound that FFmpeg decodes.
class LibavReader final : public SampleReader {
 public:
  LibavReader(std::span<const std::byte> bytes, const MediaContainer& container, std::function<bool()> stopped)
      : input_(bytes, container, std::move(stopped)) {}
  ~LibavReader() override {
    close();
    if (frame_) libav().av_frame_free(&frame_);
  }

  std::optional<std::string> open() {
    close();
    if (auto wrong = input_.open()) return wrong;
    if (!frame_) frame_ = libav().av_frame_alloc();
    if (!frame_) return input_.error("not enough memory");
    stream_ = input_.find_stream(AVMEDIA_TYPE_AUDIO);
    if (stream_ < 0) return input_.error("it has no sound");
    const AVCodecParameters& chosen = *input_.stream(stream_).codecpar;
    if (chosen.sample_rate <= 0 || chosen.sample_rate > kHighestRate)
      return input_.error("expected 1 to " + std::to_string(kHighestRate) + " samples per second");
    const int channels = chosen.ch_layout.nb_channels;
    if (channels < 1 || channels > kMaxChannels)
      return input_.error("expected 1 to " + std::to_string(kMaxChannels) + " channels");
    std::string wrong;
    decoder_ = input_.open_decoder(stream_, wrong);
    if (!decoder_) return wrong;
    rate_ = chosen.sample_rate;
    channels_ = std::min(channels, 2);
    samples_.clear();
    next_ = 0;
    skip_ = 0;
    silence_ = 0;
    seeking_ = false;
    return std::nullopt;
  }

  [[nodiscard]] double rate() const override { return rate_; }
  [[nodiscard]] int channels() const override { return channels_; }

  std::size_t read(std::span<float> to) override {
    std::size_t pairs = 0;
    const std::size_t wanted = to.size() / 2;
    while (pairs < wanted) {
      if (silence_ > 0) {
        const std::size_t count = std::min(wanted - pairs, silence_);
        std::fill_n(to.begin() + static_cast<std::ptrdiff_t>(2 * pairs), 2 * count, 0.0f);
        silence_ -= count;
        pairs += count;
        continue;
      }
      if (next_ == samples_.size() && !decode()) break;
      const std::size_t count = std::min(wanted - pairs, (samples_.size() - next_) / 2);
      std::copy_n(samples_.begin() + static_cast<std::ptrdiff_t>(next_), 2 * count,
                  to.begin() + static_cast<std::ptrdiff_t>(2 * pairs));
      next_ += 2 * count;
      pairs += count;
    }
    return pairs;
  }

  void seek(double seconds) override {
    if (!decoder_) return;
    constexpr double kBefore = 0.2;  // seconds of earlier input that decoders need to be accurate
    constexpr double kLongest = 1e7;
    const double to = std::isfinite(seconds) ? std::clamp(seconds, 0.0, kLongest) : 0;
    wanted_ = static_cast<std::int64_t>(std::llround(to * rate_));
    samples_.clear();
    next_ = 0;
    skip_ = 0;
    silence_ = 0;
    if (to > kBefore && input_.container().exact && input_.seek(stream_, *decoder_, to - kBefore)) {
      seeking_ = true;
      return;
    }
    if (open()) return;
    skip_ = static_cast<std::size_t>(wanted_);
  }

 private:
  void close() {
    if (decoder_) libav().avcodec_free_context(&decoder_);
  }

  // Decodes the next block into samples_. Returns false if no block follows.
  bool decode() {
    samples_.clear();
    next_ = 0;
    std::string problem;
    while (decoder_ && input_.decode(stream_, *decoder_, *frame_, problem)) {
      const int channels = frame_->ch_layout.nb_channels;
      if (channels < 1 || channels > kMaxChannels || frame_->nb_samples <= 0) continue;
      if (seeking_ && !find_place()) {
        if (open()) return false;
        skip_ = static_cast<std::size_t>(wanted_);
        continue;
      }
      const auto count = static_cast<std::size_t>(frame_->nb_samples);
      const std::size_t skipped = std::min(skip_, count);
      skip_ -= skipped;
      if (skipped == count) continue;
      const bool planar = libav().av_sample_fmt_is_planar(static_cast<AVSampleFormat>(frame_->format)) != 0;
      samples_.reserve(2 * (count - skipped));
      for (std::size_t i = skipped; i < count; ++i) {
        float left = 0, right = 0;
        for (int channel = 0; channel < channels; ++channel) {
          const float value = value_of_sample(*frame_, planar, channels, channel, static_cast<int>(i));
          const Fold fold = channels == 1 ? Fold{1, 1} : kFolds[channel];
          left += fold.left * value;
          right += fold.right * value;
        }
        samples_.push_back(std::isfinite(left) ? std::clamp(left, -4.0f, 4.0f) : 0);
        samples_.push_back(std::isfinite(right) ? std::clamp(right, -4.0f, 4.0f) : 0);
      }
      return true;
    }
    return false;
  }

  // After a seek, compares the time of the first block, in frame_, with the wanted time. Sets the pairs to skip or the
  // silence to insert. Returns false if the block is so late that decoding from the start is better.
  bool find_place() {
    seeking_ = false;
    const std::int64_t stamp = frame_->best_effort_timestamp;
    if (stamp == AV_NOPTS_VALUE) return false;
    const double base = av_q2d(input_.stream(stream_).time_base);
    const double at = (static_cast<double>(stamp) * base - input_.begin_of(stream_)) * rate_;
    if (!std::isfinite(at) || std::abs(at) > 1e13) return false;
    const std::int64_t first = std::llround(at);
    if (first > wanted_ + frame_->nb_samples) return false;
    skip_ = static_cast<std::size_t>(std::max<std::int64_t>(wanted_ - first, 0));
    silence_ = static_cast<std::size_t>(std::max<std::int64_t>(first - wanted_, 0));
    return true;
  }

  MediaInput input_;
  AVCodecContext* decoder_ = nullptr;
  AVFrame* frame_ = nullptr;
  int stream_ = -1;
  double rate_ = 1;
  int channels_ = 1;
  std::vector<float> samples_;  // interleaved left and right samples
  std::size_t next_ = 0;  // index of the next sample in samples_
  std::size_t skip_ = 0, silence_ = 0;  // sample pairs to drop, and silent pairs to insert, before the next block
  bool seeking_ = false;
  std::int64_t wanted_ = 0;
};

}  // namespace

std::variant<std::unique_ptr<SampleReader>, MediaError> open_samples(std::span<const std::byte> bytes,
                                                                     double synthesis_rate,
                                                                     const std::function<bool()>& stopped) {
  if (is_midi(bytes)) return open_midi(bytes, synthesis_rate);
  const MediaContainer* container = media_container_of(bytes);
  if (!container || !container->has_sound)
    return MediaError{"unsupported sound format; expected WAV, MP3, Ogg, FLAC, AIFF, AU, MIDI or a movie"};
  auto reader = std::make_unique<LibavReader>(bytes, *container, stopped);
  if (auto wrong = reader->open()) return MediaError{std::move(*wrong)};
  return reader;
}

std::variant<MediaInfo, MediaError> examine_media(std::span<const std::byte> bytes,
                                                  const std::function<bool()>& stopped) {
  if (is_midi(bytes)) {
    const auto duration = midi_duration(bytes);
    if (const auto* wrong = std::get_if<MediaError>(&duration)) return *wrong;
    return MediaInfo{std::get<double>(duration), false, true};
  }
  const MediaContainer* container = media_container_of(bytes);
  if (!container)
    return MediaError{
        "unsupported sound or movie format; expected WAV, MP3, Ogg, FLAC, MIDI, MPEG, AVI, Matroska, ISO media or GIF"};
  MediaInput input(bytes, *container, stopped);
  if (auto wrong = input.open()) return MediaError{std::move(*wrong)};
  const int pictures = input.find_stream(AVMEDIA_TYPE_VIDEO), sound = input.find_stream(AVMEDIA_TYPE_AUDIO);
  MediaInfo info;
  info.pictures = pictures >= 0;
  info.sound = sound >= 0;
  if (!info.pictures && !info.sound) return MediaError{input.error("it has neither pictures nor sound")};
  // Decode a few samples to find unsupported content.
  if (!info.pictures) {
    auto opened = open_samples(bytes, 48000, stopped);
    if (auto* wrong = std::get_if<MediaError>(&opened)) return std::move(*wrong);
    float some[64];
    if (std::get<0>(opened)->read(some) == 0) return MediaError{input.error("it has no samples")};
  }
  info.duration = input.measure(info.pictures ? pictures : sound);
  return info;
}

}  // namespace gs::render
