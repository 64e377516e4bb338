#include "render/media/movie.h"

#include "render/image/image_codecs.h"
#include "render/media/media_input.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <limits>
#include <string>
#include <utility>

namespace gs::render {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kSpan = 1;  // seconds that are decoded at once when playing backwards
constexpr double kBeforeJump =
    1.5;  // seconds before the target where decoding starts, because frames after a seek may refer to earlier frames
constexpr double kFarAhead = 10;  // seconds; to go farther, `at` seeks instead of decoding
constexpr double kUsualRate = 25;  // frames per second if the movie has no frame rate

}  // namespace

struct Movie::State {
  State(std::span<const std::byte> bytes, const MediaContainer& container, const ImageLimits& given)
      : limits(given), input(bytes, container, given.stopped) {}
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    close();
    const Libav& av = libav();
    if (scaler) av.sws_freeContext(scaler);
    for (AVFrame** one : {&frame, &following})
      if (*one) av.av_frame_free(one);
  }

  void close() {
    if (decoder) libav().avcodec_free_context(&decoder);
  }
  std::optional<ImageError> open();
  bool decode(AVFrame& into, double& time);
  std::variant<Image, ImageError> picture();
  [[nodiscard]] bool covers(double seconds) const {
    return !kept.empty() && seconds < following_time && (seconds >= kept.front().time || kept_first);
  }
  std::optional<ImageError> go_to(double seconds);
  std::optional<ImageError> advance(double seconds, double keep_from);
  std::optional<ImageError> keep();

  ImageLimits limits;
  MediaInput input;
  AVCodecContext* decoder = nullptr;
  AVFrame *frame = nullptr, *following = nullptr;
  SwsContext* scaler = nullptr;
  int scaled_width = 0, scaled_height = 0, scaled_format = -1;
  int stream = -1;
  double start = 0, last_time = -1;  // seconds: start of the stream, and time of the last frame
  std::string problem;
  bool over = false;
  // State of `at`: times of `frame` and of the next frame, `following`. kNever means that the frame does not exist.
  double frame_time = 0, following_time = -1;
  bool begun = false, kept_first = false;  // kept_first: the first cached frame is the first frame of the movie
  std::deque<Frame> kept;  // cached frames; the last one is `frame` if it was requested
  std::size_t kept_bytes = 0;
};

// Opens the movie at its beginning. Returns the error, or nullopt.
std::optional<ImageError> Movie::State::open() {
  const Libav& av = libav();
  close();
  if (auto wrong = input.open()) return ImageError{std::move(*wrong)};
  if (!frame) frame = av.av_frame_alloc();
  if (!following) following = av.av_frame_alloc();
  if (!frame || !following) return ImageError{input.error("not enough memory")};
  stream = input.find_stream(AVMEDIA_TYPE_VIDEO);
  if (stream < 0) return ImageError{input.error("it has no pictures")};
  const AVCodecParameters& chosen = *input.stream(stream).codecpar;
  if (chosen.width > 0 && chosen.height > 0)
    if (auto refused = refuse_size(input.container().name.data(), static_cast<std::uint64_t>(chosen.width),
                                   static_cast<std::uint64_t>(chosen.height), limits))
      return refused;
  std::string wrong;
  decoder = input.open_decoder(stream, wrong, [&](AVCodecContext& context) {
    context.max_pixels = static_cast<std::int64_t>(limits.file_pixels);
  });
  if (!decoder) return ImageError{std::move(wrong)};
  start = input.begin_of(stream);
  last_time = -1;
  over = false;
  problem.clear();
  return std::nullopt;
}

// Decodes the next frame. Returns false at the end and on errors; `problem` is only set on errors.
bool Movie::State::decode(AVFrame& into, double& time) {
  if (over || !input.decode(stream, *decoder, into, problem)) {
    over = true;
    return false;
  }
  const AVStream& chosen = input.stream(stream);
  const std::int64_t stamp = into.best_effort_timestamp;
  const double rate = av_q2d(chosen.avg_frame_rate), step = 1 / (rate > 0 && std::isfinite(rate) ? rate : kUsualRate);
  time = stamp == AV_NOPTS_VALUE || !input.container().timed
             ? std::max(0.0, last_time + step)
             : std::max(0.0, static_cast<double>(stamp) * av_q2d(chosen.time_base) - start);
  if (!std::isfinite(time)) time = std::max(0.0, last_time);
  last_time = time;
  return true;
}

std::variant<Image, ImageError> Movie::State::picture() {
  const Libav& av = libav();
  const auto error = [&](const char* what) { return ImageError{input.error(what)}; };
  const auto width = static_cast<std::uint64_t>(std::max(frame->width, 0)),
             height = static_cast<std::uint64_t>(std::max(frame->height, 0));
  if (auto refused = refuse_size(input.container().name.data(), width, height, limits)) return *std::move(refused);
  const auto from = static_cast<AVPixelFormat>(frame->format);
  const AVPixFmtDescriptor* kind = av.av_pix_fmt_desc_get(from);
  if (!kind) return error("a picture has an unknown format");
  const bool alpha = (kind->flags & AV_PIX_FMT_FLAG_ALPHA) != 0,
             grey = kind->nb_components == 1 && !(kind->flags & AV_PIX_FMT_FLAG_PAL);
  Image image;
  image.reduction = reduction_of(width, height, limits);
  image.width = static_cast<std::uint32_t>((width - 1) / image.reduction + 1);
  image.height = static_cast<std::uint32_t>((height - 1) / image.reduction + 1);
  image.components = alpha ? 4 : grey ? 1 : 3;
  const AVPixelFormat to = alpha ? AV_PIX_FMT_RGBA : grey ? AV_PIX_FMT_GRAY8 : AV_PIX_FMT_RGB24;
  if (scaler && (scaled_width != frame->width || scaled_height != frame->height || scaled_format != frame->format))
    av.sws_freeContext(std::exchange(scaler, nullptr));
  if (!scaler) {
    scaler = av.sws_getContext(
        frame->width, frame->height, from, static_cast<int>(image.width), static_cast<int>(image.height), to,
        image.reduction > 1 ? SWS_AREA : SWS_BICUBIC | SWS_ACCURATE_RND, nullptr, nullptr, nullptr);
    // Frames without colour information are treated as ITU-R BT.601, which old movies use.
    if (scaler && frame->colorspace == AVCOL_SPC_BT709) {
      const int* const table = av.sws_getCoefficients(SWS_CS_ITU709);
      constexpr int kOne = 1 << 16;
      (void)av.sws_setColorspaceDetails(scaler, table, frame->color_range == AVCOL_RANGE_JPEG ? 1 : 0, table, 1, 0,
                                        kOne, kOne);
    }
  }
  if (!scaler) return error("a picture has an unsupported format");
  scaled_width = frame->width;
  scaled_height = frame->height;
  scaled_format = frame->format;
  // FFmpeg writes rows in whole vectors, so reserve space after the last row.
  constexpr std::size_t kBeyond = 64;
  const std::size_t row = std::size_t{image.width} * image.components, size = row * image.height;
  image.pixels.resize(size + kBeyond);
  std::uint8_t* const rows[4] = {image.pixels.data(), nullptr, nullptr, nullptr};
  const int strides[4] = {static_cast<int>(row), 0, 0, 0};
  if (av.sws_scale(scaler, frame->data, frame->linesize, 0, frame->height, rows, strides) !=
      static_cast<int>(image.height))
    return error("a picture cannot be converted");
  image.pixels.resize(size);
  return image;
}

// ---- Random access by at()

// Seeks to a key frame before `seconds`, or to the start.
std::optional<ImageError> Movie::State::go_to(double seconds) {
  const Libav& av = libav();
  const double wanted = seconds - kBeforeJump;
  const auto begin = [&](bool front) -> std::optional<ImageError> {
    over = false;
    double time = 0;
    while (decode(*following, time))
      if (front || following->key_frame || following->pict_type == AV_PICTURE_TYPE_I) {
        following_time = time;
        return std::nullopt;
      }
    following_time = kNever;
    return problem.empty() ? std::nullopt : std::optional(ImageError{problem});
  };
  begun = true;
  kept.clear();
  kept_bytes = 0;
  kept_first = false;
  if (wanted > 0 && decoder && input.seek(stream, *decoder, wanted)) {
    last_time = wanted;
    problem.clear();
    if (!begin(false) && following_time <= seconds) return std::nullopt;
  }
  av.av_frame_unref(following);
  if (auto wrong = open()) return wrong;
  kept_first = true;
  return begin(true);
}

std::optional<ImageError> Movie::State::keep() {
  auto made = picture();
  if (auto* wrong = std::get_if<ImageError>(&made)) return std::move(*wrong);
  kept.push_back({std::move(std::get<Image>(made)), frame_time});
  kept_bytes += kept.back().image.pixels.size();
  while (kept.size() > 1 && kept_bytes > kMaxKept) {
    kept_bytes -= kept.front().image.pixels.size();
    kept.pop_front();
    kept_first = false;
  }
  return std::nullopt;
}

// Decodes until the next frame is later than `seconds`. Caches frames from `keep_from` on.
std::optional<ImageError> Movie::State::advance(double seconds, double keep_from) {
  const Libav& av = libav();
  const bool from_front = kept_first && kept.empty();
  bool has_kept = false;
  std::size_t moved = 0;
  while (following_time != kNever && (following_time <= seconds || (from_front && moved == 0))) {
    av.av_frame_unref(frame);
    av.av_frame_move_ref(frame, following);
    frame_time = following_time;
    ++moved;
    double time = 0;
    following_time = decode(*following, time) ? std::max(time, frame_time) : kNever;
    has_kept = frame_time >= keep_from;
    if (has_kept)
      if (auto wrong = keep()) return wrong;
    kept_first = kept_first && kept.size() == moved;
  }
  if (moved == 0 || has_kept) return std::nullopt;
  kept_first = from_front && moved == 1;
  return keep();  // keep at least the last frame
}

std::variant<const Movie::Frame*, ImageError> Movie::at(double seconds) {
  State& s = *state_;
  if (!std::isfinite(seconds)) seconds = 0;
  seconds = std::max(seconds, 0.0);
  if (!s.covers(seconds)) {
    const bool ahead = s.begun && !s.kept.empty() && seconds >= s.following_time;
    std::optional<ImageError> wrong;
    if (ahead && seconds - s.frame_time <= kFarAhead) {
      s.kept.clear();
      s.kept_bytes = 0;
      s.kept_first = false;
      wrong = s.advance(seconds, kNever);
    } else {
      const bool back = s.begun && !ahead;
      wrong = s.go_to(seconds);
      if (!wrong) wrong = s.advance(seconds, back ? seconds - kSpan : kNever);
    }
    if (wrong) {
      s.begun = false;
      return std::move(*wrong);
    }
  }
  const Frame* found = nullptr;
  for (const Frame& one : s.kept)
    if (!found || one.time <= seconds) found = &one;
  if (!found && !s.problem.empty()) return ImageError{s.problem};
  return found;
}

// ---- Sequential access by next()

Movie::Movie(std::unique_ptr<State> state) : state_(std::move(state)) {}
Movie::~Movie() = default;

std::variant<std::unique_ptr<Movie>, ImageError> Movie::open(std::span<const std::byte> bytes,
                                                             const ImageLimits& limits) {
  const MediaContainer* container = media_container_of(bytes);
  if (!container || !container->has_pictures)
    return ImageError{"unsupported movie format; expected MPEG, AVI, Matroska, Ogg, ISO media or GIF"};
  auto state = std::make_unique<State>(bytes, *container, limits);
  if (auto error = state->open()) return *std::move(error);
  return std::unique_ptr<Movie>(new Movie(std::move(state)));
}

std::variant<std::optional<Movie::Frame>, ImageError> Movie::next() {
  State& s = *state_;
  double time = 0;
  if (!s.decode(*s.frame, time)) {
    if (!s.problem.empty()) return ImageError{std::exchange(s.problem, {})};
    return std::optional<Frame>();
  }
  auto picture = s.picture();
  if (auto* error = std::get_if<ImageError>(&picture)) {
    s.over = true;
    return std::move(*error);
  }
  return Frame{std::move(std::get<Image>(picture)), time};
}

bool is_movie(std::span<const std::byte> bytes) {
  const MediaContainer* container = media_container_of(bytes);
  return container && container->has_pictures;
}

DecodedImage decode_movie(std::span<const std::byte> bytes, const ImageLimits& limits) {
  auto opened = Movie::open(bytes, limits);
  if (auto* error = std::get_if<ImageError>(&opened)) return std::move(*error);
  auto frame = std::get<std::unique_ptr<Movie>>(opened)->next();
  if (auto* error = std::get_if<ImageError>(&frame)) return std::move(*error);
  auto& first = std::get<std::optional<Movie::Frame>>(frame);
  if (!first) return ImageError{"broken movie: expected at least one picture"};
  return std::move(first->image);
}

}  // namespace gs::render
