#include "render/media/movie_writer.h"

#include "render/media/libav.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <utility>

namespace gs::render {
namespace {

constexpr int kTicks = 1000;  // clock ticks per second; frame rates are multiples of 1/kTicks

// Settings with no visible loss, at a size for sharing. `medium` encodes in a tenth of the drawing time.
constexpr std::array<const char*, 4> kX264{{"crf", "17", "preset", "medium"}};
constexpr std::array<const char*, 2> kMpeg4{{"b", "20000000"}};
constexpr std::array<const char*, 10> kVp9{{"crf", "22", "b", "0", "deadline", "good", "cpu-used", "4", "row-mt", "1"}};
constexpr std::array<const char*, 8> kVp8{{"crf", "8", "b", "20000000", "deadline", "good", "cpu-used", "4"}};

constexpr std::array<MovieFormat::Encoder, 2> kMp4Encoders{
    {{"libx264", "libx264", kX264}, {"mpeg4", "libavcodec", kMpeg4}}};
constexpr std::array<MovieFormat::Encoder, 2> kWebmEncoders{
    {{"libvpx-vp9", "libvpx", kVp9}, {"libvpx", "libvpx", kVp8}}};
constexpr std::array<MovieFormat, 2> kFormats{
    {{".mp4", "MP4 (H.264)", "mp4", kMp4Encoders}, {".webm", "WebM (VP9)", "webm", kWebmEncoders}}};

/// Output file in memory. The muxer seeks back to the header at the end.
struct MovieFile {
  std::vector<std::byte> bytes;
  std::size_t at = 0;

  static int write(void* opaque, std::uint8_t* from, int count) {
    auto& file = *static_cast<MovieFile*>(opaque);
    const auto size = static_cast<std::size_t>(std::max(count, 0));
    if (file.at + size > MovieWriter::kMaxBytes) return AVERROR(ENOSPC);
    if (file.bytes.size() < file.at + size) file.bytes.resize(file.at + size);
    std::memcpy(file.bytes.data() + file.at, from, size);
    file.at += size;
    return count;
  }
  static std::int64_t seek(void* opaque, std::int64_t offset, int whence) {
    auto& file = *static_cast<MovieFile*>(opaque);
    const auto size = static_cast<std::int64_t>(file.bytes.size());
    if ((whence & AVSEEK_SIZE) != 0) return size;
    const std::int64_t base = whence == SEEK_CUR ? static_cast<std::int64_t>(file.at) : whence == SEEK_END ? size : 0;
    if (base + offset < 0 || base + offset > static_cast<std::int64_t>(MovieWriter::kMaxBytes)) return AVERROR(EINVAL);
    file.at = static_cast<std::size_t>(base + offset);
    return base + offset;
  }
};

}  // namespace

struct MovieWriter::State {
  const Libav& av = libav();
  MovieFile file;
  AVFormatContext* format = nullptr;
  AVIOContext* io = nullptr;
  AVCodecContext* encoder = nullptr;
  AVStream* stream = nullptr;
  AVFrame* frame = nullptr;
  AVPacket* packet = nullptr;
  SwsContext* scaler = nullptr;
  int width = 0, height = 0;
  std::int64_t pictures = 0, ticks_a_picture = 0;
  std::string name;

  ~State() {
    if (!av.problem.empty()) return;
    av.sws_freeContext(scaler);
    av.av_frame_free(&frame);
    av.av_packet_free(&packet);
    av.avcodec_free_context(&encoder);
    if (format) format->pb = nullptr;
    av.avformat_free_context(format);
    if (io) av.av_free(io->buffer);
    av.avio_context_free(&io);
  }

  [[nodiscard]] ImageError error(const std::string& what, int code = 0) const {
    std::array<char, AV_ERROR_MAX_STRING_SIZE> text{};
    if (code < 0) av.av_strerror(code, text.data(), text.size());
    return {what + (code < 0 ? std::string(": ") + text.data() : std::string())};
  }

  std::optional<ImageError> open_encoder(const MovieFormat& row, double rate) {
    std::string tried;
    for (const MovieFormat::Encoder& each : row.encoders) {
      const AVCodec* const codec = av.avcodec_find_encoder_by_name(each.name);
      tried += (tried.empty() ? "" : ", ") + std::string(each.name) + " (" + std::string(each.debian) + ")";
      if (!codec) continue;
      encoder = av.avcodec_alloc_context3(codec);
      if (!encoder) return error("not enough memory for an encoder");
      encoder->width = width & ~1;
      encoder->height = height & ~1;
      encoder->time_base = {1, static_cast<int>(std::lround(rate * kTicks))};
      encoder->framerate = {static_cast<int>(std::lround(rate * kTicks)), kTicks};
      encoder->pix_fmt = AV_PIX_FMT_YUV420P;
      encoder->color_range = AVCOL_RANGE_MPEG;
      encoder->colorspace = AVCOL_SPC_BT709;
      encoder->color_primaries = AVCOL_PRI_BT709;
      encoder->color_trc = AVCOL_TRC_BT709;
      encoder->flags |= AV_CODEC_FLAG_BITEXACT;
      if ((format->oformat->flags & AVFMT_GLOBALHEADER) != 0) encoder->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
      AVDictionary* wishes = nullptr;
      for (std::size_t i = 0; i + 1 < each.pairs.size(); i += 2)
        av.av_dict_set(&wishes, each.pairs[i], each.pairs[i + 1], 0);
      const int opened = av.avcodec_open2(encoder, codec, &wishes);
      av.av_dict_free(&wishes);
      name = each.name;
      if (opened >= 0) return std::nullopt;
      auto problem = error(name + " does not support pictures of " + std::to_string(encoder->width) + "x" +
                               std::to_string(encoder->height),
                           opened);
      av.avcodec_free_context(&encoder);
      return problem;
    }
    return error("libavcodec has no encoder for " + std::string(row.name) + "; expected one of " + tried);
  }

  std::optional<ImageError> begin(const MovieFormat& row, double rate) {
    if (!av.problem.empty()) return ImageError{"movies cannot be written: " + av.problem};
    if (width < 2 || height < 2) return error("a movie needs at least 2 x 2 pixels");
    constexpr int kBuffer = 1 << 16;
    auto* buffer = static_cast<std::uint8_t*>(av.av_malloc(kBuffer));
    if (buffer) io = av.avio_alloc_context(buffer, kBuffer, 1, &file, nullptr, &MovieFile::write, &MovieFile::seek);
    if (int code = av.avformat_alloc_output_context2(&format, nullptr, row.muxer, nullptr); code < 0 || !io)
      return error("libavformat cannot write " + std::string(row.name), code);
    format->pb = io;
    format->flags |= AVFMT_FLAG_BITEXACT;
    if (auto problem = open_encoder(row, rate)) return problem;
    stream = av.avformat_new_stream(format, nullptr);
    frame = av.av_frame_alloc();
    packet = av.av_packet_alloc();
    if (!stream || !frame || !packet) return error("not enough memory for a movie");
    stream->time_base = encoder->time_base;
    stream->avg_frame_rate = encoder->framerate;
    if (int code = av.avcodec_parameters_from_context(stream->codecpar, encoder); code < 0)
      return error("a movie cannot be started", code);
    if (int code = av.avformat_write_header(format, nullptr); code < 0) return error("a movie cannot be started", code);
    ticks_a_picture = kTicks;
    frame->format = AV_PIX_FMT_YUV420P;
    frame->width = encoder->width;
    frame->height = encoder->height;
    if (int code = av.av_frame_get_buffer(frame, 0); code < 0) return error("not enough memory for a picture", code);
    return std::nullopt;
  }

  /// Writes the packets that the encoder has finished to the file.
  std::optional<ImageError> take_packets() {
    while (true) {
      const int code = av.avcodec_receive_packet(encoder, packet);
      if (code == AVERROR(EAGAIN) || code == AVERROR_EOF) return std::nullopt;
      if (code < 0) return error("a picture cannot be encoded", code);
      av.av_packet_rescale_ts(packet, encoder->time_base, stream->time_base);
      packet->stream_index = stream->index;
      if (const int written = av.av_interleaved_write_frame(format, packet); written < 0)
        return error("a movie cannot be written", written);
    }
  }

  std::optional<ImageError> convert(const Image& image) {
    const AVPixelFormat from = image.components == 4 ? AV_PIX_FMT_RGBA : AV_PIX_FMT_RGB24;
    if (!scaler) {
      scaler = av.sws_getContext(frame->width, frame->height, from, frame->width, frame->height, AV_PIX_FMT_YUV420P,
                                 SWS_BICUBIC | SWS_ACCURATE_RND | SWS_FULL_CHR_H_INP, nullptr, nullptr, nullptr);
      if (!scaler) return error("not enough memory to convert a picture");
      const int* const table = av.sws_getCoefficients(SWS_CS_ITU709);
      constexpr int kOne = 1 << 16;
      (void)av.sws_setColorspaceDetails(scaler, table, 1, table, 0, 0, kOne, kOne);
    }
    if (const int code = av.av_frame_make_writable(frame); code < 0) return error("not enough memory", code);
    const std::array<const std::uint8_t*, 4> rows{{image.pixels.data()}};
    const std::array<int, 4> strides{{static_cast<int>(image.width * image.components)}};
    av.sws_scale(scaler, rows.data(), strides.data(), 0, frame->height, frame->data, frame->linesize);
    return std::nullopt;
  }
};

MovieWriter::MovieWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}
MovieWriter::~MovieWriter() = default;

std::span<const MovieFormat> movie_formats() { return kFormats; }

const MovieFormat* movie_format_of(std::string_view file_name) {
  std::string lower(file_name);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  for (const MovieFormat& row : kFormats)
    if (lower.ends_with(row.extension)) return &row;
  return nullptr;
}

std::variant<std::unique_ptr<MovieWriter>, ImageError> MovieWriter::open(const MovieFormat& format, int width,
                                                                         int height, double rate) {
  auto state = std::make_unique<State>();
  state->width = width;
  state->height = height;
  constexpr double kMin = 0.001, kMax = 1000;
  if (!(rate >= kMin && rate <= kMax)) return ImageError{"expected 0.001 to 1000 pictures per second"};
  if (auto problem = state->begin(format, rate)) return std::move(*problem);
  return std::unique_ptr<MovieWriter>(new MovieWriter(std::move(state)));
}

std::optional<ImageError> MovieWriter::add(const Image& image) {
  State& s = *state_;
  if (image.width != static_cast<std::uint32_t>(s.width) || image.height != static_cast<std::uint32_t>(s.height) ||
      image.components < 3 || image.pixels.size() != std::size_t{image.width} * image.height * image.components)
    return ImageError{"all pictures of a movie must have the same size"};
  if (auto problem = s.convert(image)) return problem;
  s.frame->pts = s.pictures++ * s.ticks_a_picture;
  if (const int code = s.av.avcodec_send_frame(s.encoder, s.frame); code < 0)
    return s.error("a picture cannot be encoded", code);
  return s.take_packets();
}

std::variant<std::vector<std::byte>, ImageError> MovieWriter::finish() {
  State& s = *state_;
  if (const int code = s.av.avcodec_send_frame(s.encoder, nullptr); code < 0)
    return s.error("the movie cannot be finished", code);
  if (auto problem = s.take_packets()) return std::move(*problem);
  if (const int code = s.av.av_write_trailer(s.format); code < 0) return s.error("the movie cannot be finished", code);
  return std::move(s.file.bytes);
}

std::string_view MovieWriter::encoder() const { return state_->name; }

}  // namespace gs::render
