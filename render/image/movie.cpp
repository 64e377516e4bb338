#include "render/image/movie.h"

#include "render/image/image_codecs.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/avutil.h>
#include <libavutil/dict.h>
#include <libavutil/imgutils.h>
#include <libavutil/log.h>
#include <libavutil/pixdesc.h>
#include <libswscale/swscale.h>
}

#include <dlfcn.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>

/// The functions of FFmpeg that are called, by the library that has them.
#define GHOSTSPACE_LIBAV_FUNCTIONS(X)       \
  X(avutil, av_dict_free)                   \
  X(avutil, av_dict_set)                    \
  X(avutil, av_frame_alloc)                 \
  X(avutil, av_frame_free)                  \
  X(avutil, av_free)                        \
  X(avutil, av_log_set_level)               \
  X(avutil, av_malloc)                      \
  X(avutil, av_max_alloc)                   \
  X(avutil, av_pix_fmt_desc_get)            \
  X(avutil, av_strerror)                    \
  X(avcodec, av_packet_alloc)               \
  X(avcodec, av_packet_free)                \
  X(avcodec, av_packet_unref)               \
  X(avcodec, avcodec_alloc_context3)        \
  X(avcodec, avcodec_find_decoder)          \
  X(avcodec, avcodec_free_context)          \
  X(avcodec, avcodec_open2)                 \
  X(avcodec, avcodec_parameters_to_context) \
  X(avcodec, avcodec_receive_frame)         \
  X(avcodec, avcodec_send_packet)           \
  X(avformat, av_find_input_format)         \
  X(avformat, av_read_frame)                \
  X(avformat, avformat_alloc_context)       \
  X(avformat, avformat_close_input)         \
  X(avformat, avformat_find_stream_info)    \
  X(avformat, avformat_open_input)          \
  X(avformat, avio_alloc_context)           \
  X(avformat, avio_context_free)            \
  X(swscale, sws_freeContext)               \
  X(swscale, sws_getContext)                \
  X(swscale, sws_scale)

namespace gs::render {
namespace {

using namespace std::string_view_literals;

/// Opened when the first movie is: they take longer to link than most worlds to draw.
struct Libav {
#define GHOSTSPACE_LIBAV_MEMBER(library, name) decltype(&::name) name = nullptr;
  GHOSTSPACE_LIBAV_FUNCTIONS(GHOSTSPACE_LIBAV_MEMBER)
#undef GHOSTSPACE_LIBAV_MEMBER
  std::string problem;  // why they are not there

  Libav() {
    void* const avutil = open("libavutil.so." AV_STRINGIFY(LIBAVUTIL_VERSION_MAJOR));
    void* const avcodec = open("libavcodec.so." AV_STRINGIFY(LIBAVCODEC_VERSION_MAJOR));
    void* const avformat = open("libavformat.so." AV_STRINGIFY(LIBAVFORMAT_VERSION_MAJOR));
    void* const swscale = open("libswscale.so." AV_STRINGIFY(LIBSWSCALE_VERSION_MAJOR));
    if (!problem.empty()) return;
#define GHOSTSPACE_LIBAV_FIND(library, name)                      \
  name = reinterpret_cast<decltype(name)>(dlsym(library, #name)); \
  if (!name) problem = "the library has no " #name;
    GHOSTSPACE_LIBAV_FUNCTIONS(GHOSTSPACE_LIBAV_FIND)
#undef GHOSTSPACE_LIBAV_FIND
    if (!problem.empty()) return;
    av_log_set_level(AV_LOG_QUIET);
    av_max_alloc(ImageLimits{}.working_bytes);  // at once
  }

 private:
  void* open(const char* name) {
    void* const handle = dlopen(name, RTLD_NOW | RTLD_LOCAL);
    if (!handle && problem.empty()) problem = std::string(name) + " cannot be opened";
    return handle;
  }
};

const Libav& libav() {
  static const Libav library;
  return library;
}

/// A kind of file: where its mark stands, and who takes it apart. Others, which may refer to further files, are not
/// asked.
struct Container {
  std::string_view name;
  std::size_t at;
  std::string_view mark;
  const char* demuxer;
};
constexpr std::array<Container, 6> kContainers = {{
    {"MPEG system stream", 0, "\x00\x00\x01\xba"sv, "mpeg"},
    {"MPEG video", 0, "\x00\x00\x01\xb3"sv, "mpegvideo"},
    {"AVI", 0, "RIFF"sv, "avi"},
    {"Matroska", 0, "\x1a\x45\xdf\xa3"sv, "matroska"},
    {"Ogg", 0, "OggS"sv, "ogg"},
    {"ISO media", 4, "ftyp"sv, "mov"},
}};

/// Decoders that worlds have a use for; of the others, which are many and old, nobody is asked.
constexpr const char* kDecoders =
    "mpeg1video,mpeg2video,mpeg4,mjpeg,h263,h264,hevc,vp8,vp9,libdav1d,theora,cinepak,indeo2,indeo3,indeo4,indeo5,"
    "msmpeg4v1,msmpeg4v2,msmpeg4,msrle,msvideo1,qtrle,rpza,smc,svq1,svq3,rawvideo";

const Container* container_of(std::span<const std::byte> bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  for (const Container& one : kContainers)
    if (text.size() >= one.at && text.substr(one.at).starts_with(one.mark)) return &one;
  return nullptr;
}

/// Bytes in memory, as libavformat reads a file.
struct Source {
  std::span<const std::byte> bytes;
  std::size_t at = 0;
};

int read_source(void* opaque, std::uint8_t* to, int size) {
  auto& source = *static_cast<Source*>(opaque);
  const std::size_t count = std::min(static_cast<std::size_t>(std::max(size, 0)), source.bytes.size() - source.at);
  if (count == 0) return AVERROR_EOF;
  std::memcpy(to, source.bytes.data() + source.at, count);
  source.at += count;
  return static_cast<int>(count);
}

std::int64_t seek_source(void* opaque, std::int64_t offset, int whence) {
  auto& source = *static_cast<Source*>(opaque);
  const auto size = static_cast<std::int64_t>(source.bytes.size());
  if (whence & AVSEEK_SIZE) return size;
  whence &= ~AVSEEK_FORCE;
  const std::int64_t from = whence == SEEK_SET ? 0 : whence == SEEK_CUR ? static_cast<std::int64_t>(source.at) : size;
  if ((offset > 0 && from > size - offset) || (offset < 0 && from < -offset)) return AVERROR(EINVAL);
  source.at = static_cast<std::size_t>(from + offset);
  return from + offset;
}

int refuse_to_open(AVFormatContext*, AVIOContext** context, const char*, int, AVDictionary**) {
  *context = nullptr;
  return AVERROR(EACCES);
}

}  // namespace

struct Movie::State {
  const Container* container = nullptr;
  ImageLimits limits;
  Source source;
  AVIOContext* input = nullptr;
  AVFormatContext* format = nullptr;
  AVCodecContext* decoder = nullptr;
  AVPacket* packet = nullptr;
  AVFrame* frame = nullptr;
  int stream = -1;
  double start = 0, last_time = 0;  // seconds
  bool drained = false, over = false;

  State() = default;
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    const Libav& av = libav();
    if (frame) av.av_frame_free(&frame);
    if (packet) av.av_packet_free(&packet);
    if (decoder) av.avcodec_free_context(&decoder);
    if (format) av.avformat_close_input(&format);
    if (input) {
      av.av_free(input->buffer);
      av.avio_context_free(&input);
    }
  }
  [[nodiscard]] ImageError error(const std::string& what, int code = 0) const {
    std::string message = "broken " + std::string(container->name) + ": " + what;
    std::array<char, 128> text{};
    if (code != 0 && libav().av_strerror(code, text.data(), text.size()) == 0)
      message += std::string(" (") + text.data() + ")";
    return {message};
  }
  [[nodiscard]] bool stopped() const { return limits.stopped && limits.stopped(); }
  std::optional<ImageError> open();
  std::optional<ImageError> open_decoder();
  std::variant<Image, ImageError> picture() const;
};

std::optional<ImageError> Movie::State::open() {
  const Libav& av = libav();
  constexpr std::size_t kBuffer = 1 << 15;
  auto* buffer = static_cast<std::uint8_t*>(av.av_malloc(kBuffer));
  if (!buffer) return error("there is not enough memory");
  input = av.avio_alloc_context(buffer, kBuffer, 0, &source, read_source, nullptr, seek_source);
  if (!input) {
    av.av_free(buffer);
    return error("there is not enough memory");
  }
  format = av.avformat_alloc_context();
  packet = av.av_packet_alloc();
  frame = av.av_frame_alloc();
  if (!format || !packet || !frame) return error("there is not enough memory");
  format->pb = input;
  format->flags |= AVFMT_FLAG_CUSTOM_IO;
  format->io_open = refuse_to_open;
  format->interrupt_callback = {[](void* state) { return static_cast<const State*>(state)->stopped() ? 1 : 0; }, this};
  format->max_streams = 64;
  format->probesize = 1 << 20;
  format->max_analyze_duration = 5 * AV_TIME_BASE;
  AVDictionary* options = nullptr;
  av.av_dict_set(&options, "protocol_whitelist", "none", 0);
  av.av_dict_set(&options, "codec_whitelist", kDecoders, 0);
  // On failure this frees `format`.
  const int opened = av.avformat_open_input(&format, nullptr, av.av_find_input_format(container->demuxer), &options);
  av.av_dict_free(&options);
  if (opened < 0) return error("expected its header", opened);
  if (const int found = av.avformat_find_stream_info(format, nullptr); found < 0)
    return error("expected streams", found);
  return open_decoder();
}

std::optional<ImageError> Movie::State::open_decoder() {
  const Libav& av = libav();
  for (unsigned i = 0; i < format->nb_streams && stream < 0; ++i)
    if (format->streams[i]->codecpar->codec_type == AVMEDIA_TYPE_VIDEO &&
        !(format->streams[i]->disposition & AV_DISPOSITION_ATTACHED_PIC))
      stream = static_cast<int>(i);
  if (stream < 0) return error("it has no pictures");
  const AVStream& chosen = *format->streams[stream];
  const AVCodec* codec = av.avcodec_find_decoder(chosen.codecpar->codec_id);
  if (!codec) return error("its pictures are of a kind that is not known");
  if (chosen.codecpar->width > 0 && chosen.codecpar->height > 0)
    if (auto refused = refuse_size(container->name.data(), static_cast<std::uint64_t>(chosen.codecpar->width),
                                   static_cast<std::uint64_t>(chosen.codecpar->height), limits))
      return refused;
  decoder = av.avcodec_alloc_context3(codec);
  if (!decoder || av.avcodec_parameters_to_context(decoder, chosen.codecpar) < 0)
    return error("there is not enough memory");
  decoder->max_pixels = static_cast<std::int64_t>(limits.file_pixels);
  decoder->thread_count = 1;
  AVDictionary* options = nullptr;
  av.av_dict_set(&options, "codec_whitelist", kDecoders, 0);
  const int opened = av.avcodec_open2(decoder, codec, &options);
  av.av_dict_free(&options);
  if (opened < 0) return error("its pictures cannot be decoded", opened);
  const auto begin = chosen.start_time;
  start = begin == AV_NOPTS_VALUE ? 0 : static_cast<double>(begin) * av_q2d(chosen.time_base);
  return std::nullopt;
}

std::variant<Image, ImageError> Movie::State::picture() const {
  const Libav& av = libav();
  const auto width = static_cast<std::uint64_t>(std::max(frame->width, 0)),
             height = static_cast<std::uint64_t>(std::max(frame->height, 0));
  if (auto refused = refuse_size(container->name.data(), width, height, limits)) return *std::move(refused);
  const auto from = static_cast<AVPixelFormat>(frame->format);
  const AVPixFmtDescriptor* kind = av.av_pix_fmt_desc_get(from);
  if (!kind) return error("a picture is of a kind that is not known");
  const bool alpha = (kind->flags & AV_PIX_FMT_FLAG_ALPHA) != 0,
             grey = kind->nb_components == 1 && !(kind->flags & AV_PIX_FMT_FLAG_PAL);
  Image image;
  image.reduction = reduction_of(width, height, limits);
  image.width = static_cast<std::uint32_t>((width - 1) / image.reduction + 1);
  image.height = static_cast<std::uint32_t>((height - 1) / image.reduction + 1);
  image.components = alpha ? 4 : grey ? 1 : 3;
  const AVPixelFormat to = alpha ? AV_PIX_FMT_RGBA : grey ? AV_PIX_FMT_GRAY8 : AV_PIX_FMT_RGB24;
  SwsContext* scaler = av.sws_getContext(
      frame->width, frame->height, from, static_cast<int>(image.width), static_cast<int>(image.height), to,
      image.reduction > 1 ? SWS_AREA : SWS_BICUBIC | SWS_ACCURATE_RND, nullptr, nullptr, nullptr);
  if (!scaler) return error("a picture is of a kind that cannot be shown");
  // Rows are written by whole vectors: room for the last one.
  constexpr std::size_t kBeyond = 64;
  const std::size_t row = std::size_t{image.width} * image.components, size = row * image.height;
  image.pixels.resize(size + kBeyond);
  std::uint8_t* const rows[4] = {image.pixels.data(), nullptr, nullptr, nullptr};
  const int strides[4] = {static_cast<int>(row), 0, 0, 0};
  const int scaled = av.sws_scale(scaler, frame->data, frame->linesize, 0, frame->height, rows, strides);
  av.sws_freeContext(scaler);
  if (scaled != static_cast<int>(image.height)) return error("a picture cannot be converted");
  image.pixels.resize(size);
  return image;
}

Movie::Movie(std::unique_ptr<State> state) : state_(std::move(state)) {}
Movie::~Movie() = default;

std::variant<std::unique_ptr<Movie>, ImageError> Movie::open(std::span<const std::byte> bytes,
                                                             const ImageLimits& limits) {
  const Container* container = container_of(bytes);
  if (!container) return ImageError{"not a movie that can be read: expected MPEG, AVI, Matroska, Ogg or ISO media"};
  if (!libav().problem.empty()) return ImageError{"movies need FFmpeg: " + libav().problem};
  auto state = std::make_unique<State>();
  state->container = container;
  state->limits = limits;
  state->source.bytes = bytes;
  if (auto error = state->open()) return *std::move(error);
  return std::unique_ptr<Movie>(new Movie(std::move(state)));
}

double Movie::duration() const {
  const std::int64_t duration = state_->format->duration;
  return duration == AV_NOPTS_VALUE || duration < 0 ? 0 : static_cast<double>(duration) / AV_TIME_BASE;
}

std::variant<std::optional<Movie::Frame>, ImageError> Movie::next() {
  State& s = *state_;
  const Libav& av = libav();
  const auto fail = [&](ImageError error) {
    s.over = true;
    return error;
  };
  constexpr int kMostPackets = 20'000;  // without a picture
  for (int packets = 0; !s.over; ++packets) {
    if (s.stopped()) return fail(s.error("the time for it is over"));
    const int received = av.avcodec_receive_frame(s.decoder, s.frame);
    if (received >= 0) {
      auto picture = s.picture();
      if (auto* error = std::get_if<ImageError>(&picture)) return fail(std::move(*error));
      Frame frame{std::move(std::get<Image>(picture)), 0};
      const AVRational base = s.format->streams[s.stream]->time_base;
      const std::int64_t stamp = s.frame->best_effort_timestamp;
      // One that does not say when comes with the one before.
      if (stamp == AV_NOPTS_VALUE)
        frame.time = s.last_time;
      else
        frame.time = std::max(0.0, static_cast<double>(stamp) * av_q2d(base) - s.start);
      if (!std::isfinite(frame.time)) frame.time = s.last_time;
      s.last_time = frame.time;
      return frame;
    }
    if (received == AVERROR_EOF || (received != AVERROR(EAGAIN) && s.drained)) break;
    if (packets >= kMostPackets) return fail(s.error("no picture for " + std::to_string(kMostPackets) + " packets"));
    if (av.av_read_frame(s.format, s.packet) < 0) {
      if (std::exchange(s.drained, true)) break;
      (void)av.avcodec_send_packet(s.decoder, nullptr);  // what it still holds
      continue;
    }
    // A packet that is broken is lost, and what follows may be whole.
    if (s.packet->stream_index == s.stream) (void)av.avcodec_send_packet(s.decoder, s.packet);
    av.av_packet_unref(s.packet);
  }
  s.over = true;
  return std::optional<Frame>();
}

bool is_movie(std::span<const std::byte> bytes) { return container_of(bytes) != nullptr; }

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
