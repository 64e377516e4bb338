#include "render/media/media_input.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <utility>

namespace gs::render {
namespace {

using namespace std::string_view_literals;

constexpr std::array<MediaContainer, 13> kContainers = {{
    {"MPEG system stream", {0, "\x00\x00\x01\xba"sv}, {}, "mpeg", true, true},
    {"MPEG video", {0, "\x00\x00\x01\xb3"sv}, {}, "mpegvideo", true, false, false},
    {"AVI", {0, "RIFF"sv}, {8, "AVI "sv}, "avi", true, true},
    {"WAV", {0, "RIFF"sv}, {8, "WAVE"sv}, "wav", false, true},
    {"Matroska", {0, "\x1a\x45\xdf\xa3"sv}, {}, "matroska", true, true},
    {"Ogg", {0, "OggS"sv}, {}, "ogg", true, true, true, false},
    {"ISO media", {4, "ftyp"sv}, {}, "mov", true, true},
    {"GIF", {0, "GIF8"sv}, {}, "gif", true, false},
    {"FLAC", {0, "fLaC"sv}, {}, "flac", false, true},
    {"AIFF", {0, "FORM"sv}, {8, "AIF"sv}, "aiff", false, true},
    {"AU", {0, ".snd"sv}, {}, "au", false, true},
    {"MP3", {0, "ID3"sv}, {}, "mp3", false, true},
    {"MPEG audio", {0, "\xff"sv}, {}, "mp3", false, true},  // further tests in is_mpeg_audio()
}};

/// Decoders that worlds use. All others are disabled: many are old and rarely tested.
constexpr const char* kDecoders =
    "mpeg1video,mpeg2video,mpeg4,mjpeg,h263,h264,hevc,vp8,vp9,libdav1d,theora,cinepak,indeo2,indeo3,indeo4,indeo5,"
    "msmpeg4v1,msmpeg4v2,msmpeg4,msrle,msvideo1,qtrle,rpza,smc,svq1,svq3,rawvideo,gif,"
    "mp1float,mp1,mp2float,mp2,mp3float,mp3,aac,ac3,vorbis,opus,flac,pcm_u8,pcm_s8,pcm_s16le,pcm_s16be,pcm_s24le,"
    "pcm_s24be,pcm_s32le,pcm_s32be,pcm_f32le,pcm_f32be,pcm_f64le,pcm_f64be,pcm_alaw,pcm_mulaw,adpcm_ms,adpcm_ima_wav,"
    "adpcm_ima_qt,adpcm_yamaha,gsm_ms";

// Detects an MPEG audio header: eleven set bits, then valid version, layer, bit rate and sampling rate (ISO/IEC 11172-3
// 2.4.2.3).
bool is_mpeg_audio(std::span<const std::byte> bytes) {
  if (bytes.size() < 4) return false;
  const auto byte = [&](std::size_t i) { return std::to_integer<unsigned>(bytes[i]); };
  return byte(0) == 0xff && byte(1) >> 5 == 7 && (byte(1) >> 3 & 3) != 1 && (byte(1) >> 1 & 3) != 0 &&
         byte(2) >> 4 != 15 && byte(2) >> 4 != 0 && (byte(2) >> 2 & 3) != 3;
}

int refuse_to_open(AVFormatContext*, AVIOContext** context, const char*, int, AVDictionary**) {
  *context = nullptr;
  return AVERROR(EACCES);
}

}  // namespace

const MediaContainer* media_container_of(std::span<const std::byte> bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const auto has = [&](const MediaContainer::Mark& mark) {
    return text.size() >= mark.at && text.substr(mark.at).starts_with(mark.text);
  };
  for (const MediaContainer& one : kContainers)
    if (has(one.first) && has(one.second) && (&one != &kContainers.back() || is_mpeg_audio(bytes))) return &one;
  return nullptr;
}

MediaInput::MediaInput(std::span<const std::byte> bytes, const MediaContainer& container, std::function<bool()> stopped)
    : bytes_(bytes), container_(container), stopped_(std::move(stopped)) {}

MediaInput::~MediaInput() { close(); }

void MediaInput::close() {
  const Libav& av = libav();
  if (packet_) av.av_packet_free(&packet_);
  if (format_) av.avformat_close_input(&format_);
  if (input_) {
    av.av_free(input_->buffer);
    av.avio_context_free(&input_);
  }
}

int MediaInput::read(void* self, std::uint8_t* to, int size) {
  auto& source = *static_cast<MediaInput*>(self);
  const std::size_t count = std::min(static_cast<std::size_t>(std::max(size, 0)), source.bytes_.size() - source.at_);
  if (count == 0) return AVERROR_EOF;
  std::memcpy(to, source.bytes_.data() + source.at_, count);
  source.at_ += count;
  return static_cast<int>(count);
}

std::int64_t MediaInput::seek_to(void* self, std::int64_t offset, int whence) {
  auto& source = *static_cast<MediaInput*>(self);
  const auto size = static_cast<std::int64_t>(source.bytes_.size());
  if (whence & AVSEEK_SIZE) return size;
  whence &= ~AVSEEK_FORCE;
  const std::int64_t from = whence == SEEK_SET ? 0 : whence == SEEK_CUR ? static_cast<std::int64_t>(source.at_) : size;
  if ((offset > 0 && from > size - offset) || (offset < 0 && from < -offset)) return AVERROR(EINVAL);
  source.at_ = static_cast<std::size_t>(from + offset);
  return from + offset;
}

std::string MediaInput::error(const std::string& what, int code) const {
  std::string message = "broken " + std::string(container_.name) + ": " + what;
  std::array<char, 128> text{};
  if (code != 0 && libav().problem.empty() && libav().av_strerror(code, text.data(), text.size()) == 0)
    message += std::string(" (") + text.data() + ")";
  return message;
}

std::optional<std::string> MediaInput::open() {
  const Libav& av = libav();
  if (!av.problem.empty()) return "movies and sounds need FFmpeg: " + av.problem;
  close();
  at_ = 0;
  drained_ = false;
  const std::string no_memory = error("not enough memory");
  constexpr std::size_t kBuffer = 1 << 15;
  auto* buffer = static_cast<std::uint8_t*>(av.av_malloc(kBuffer));
  if (!buffer) return no_memory;
  input_ = av.avio_alloc_context(buffer, kBuffer, 0, this, &MediaInput::read, nullptr, &MediaInput::seek_to);
  if (!input_) {
    av.av_free(buffer);
    return no_memory;
  }
  format_ = av.avformat_alloc_context();
  packet_ = av.av_packet_alloc();
  if (!format_ || !packet_) return no_memory;
  format_->pb = input_;
  format_->flags |= AVFMT_FLAG_CUSTOM_IO;
  format_->io_open = refuse_to_open;
  format_->interrupt_callback = {[](void* self) { return static_cast<const MediaInput*>(self)->stopped() ? 1 : 0; },
                                 this};
  format_->max_streams = 64;
  format_->probesize = 1 << 20;
  format_->max_analyze_duration = 5 * AV_TIME_BASE;
  AVDictionary* options = nullptr;
  av.av_dict_set(&options, "protocol_whitelist", "none", 0);
  av.av_dict_set(&options, "codec_whitelist", kDecoders, 0);
  // On failure, avformat_open_input frees `format_`.
  const int opened = av.avformat_open_input(&format_, nullptr, av.av_find_input_format(container_.demuxer), &options);
  av.av_dict_free(&options);
  if (opened < 0) return error("expected its header", opened);
  if (const int found = av.avformat_find_stream_info(format_, nullptr); found < 0)
    return error("expected streams", found);
  return std::nullopt;
}

int MediaInput::find_stream(AVMediaType kind) const {
  for (unsigned i = 0; i < format_->nb_streams; ++i)
    if (format_->streams[i]->codecpar->codec_type == kind &&
        !(format_->streams[i]->disposition & AV_DISPOSITION_ATTACHED_PIC))
      return static_cast<int>(i);
  return -1;
}

AVCodecContext* MediaInput::open_decoder(int stream, std::string& problem,
                                         const std::function<void(AVCodecContext&)>& adjust) {
  const Libav& av = libav();
  const AVStream& chosen = *format_->streams[stream];
  const std::string what = chosen.codecpar->codec_type == AVMEDIA_TYPE_AUDIO ? "its sound" : "its picture";
  const AVCodec* codec = av.avcodec_find_decoder(chosen.codecpar->codec_id);
  if (!codec) {
    problem = error(what + " has an unknown format");
    return nullptr;
  }
  AVCodecContext* decoder = av.avcodec_alloc_context3(codec);
  if (!decoder || av.avcodec_parameters_to_context(decoder, chosen.codecpar) < 0) {
    if (decoder) av.avcodec_free_context(&decoder);
    problem = error("not enough memory");
    return nullptr;
  }
  decoder->thread_count = 1;
  decoder->pkt_timebase = chosen.time_base;
  if (adjust) adjust(*decoder);
  AVDictionary* options = nullptr;
  av.av_dict_set(&options, "codec_whitelist", kDecoders, 0);
  const int opened = av.avcodec_open2(decoder, codec, &options);
  av.av_dict_free(&options);
  if (opened < 0) {
    problem = error(what + " cannot be decoded", opened);
    av.avcodec_free_context(&decoder);
    return nullptr;
  }
  return decoder;
}

bool MediaInput::decode(int stream, AVCodecContext& decoder, AVFrame& frame, std::string& problem) {
  const Libav& av = libav();
  constexpr int kMaxPackets = 20'000;  // maximum consecutive packets that give no frame
  for (int packets = 0;; ++packets) {
    if (stopped()) {
      problem = error("the time limit was reached");
      return false;
    }
    const int received = av.avcodec_receive_frame(&decoder, &frame);
    if (received >= 0) return true;
    if (received == AVERROR_EOF || (received != AVERROR(EAGAIN) && drained_)) return false;
    if (packets >= kMaxPackets) {
      problem = error("no picture or sound for " + std::to_string(kMaxPackets) + " packets");
      return false;
    }
    if (av.av_read_frame(format_, packet_) < 0) {
      if (std::exchange(drained_, true)) return false;
      (void)av.avcodec_send_packet(&decoder, nullptr);  // the end of the file: get the buffered frames
      continue;
    }
    if (packet_->stream_index == stream) (void)av.avcodec_send_packet(&decoder, packet_);
    av.av_packet_unref(packet_);
  }
}

bool MediaInput::seek(int stream, AVCodecContext& decoder, double seconds) {
  const Libav& av = libav();
  const AVStream& chosen = *format_->streams[stream];
  const double base = av_q2d(chosen.time_base), to = seconds + begin_of(stream);
  constexpr double kMax = 9e15;
  if (!container_.timed || !(base > 0) || !(std::abs(to / base) < kMax)) return false;
  if (av.av_seek_frame(format_, stream, static_cast<std::int64_t>(to / base), AVSEEK_FLAG_BACKWARD) < 0) return false;
  av.avcodec_flush_buffers(&decoder);
  drained_ = false;
  return true;
}

double MediaInput::begin_of(int stream) const {
  const AVStream& chosen = *format_->streams[stream];
  return chosen.start_time == AV_NOPTS_VALUE ? 0 : static_cast<double>(chosen.start_time) * av_q2d(chosen.time_base);
}

double MediaInput::measure(int stream) {
  const Libav& av = libav();
  constexpr std::size_t kMaxBytes = std::size_t{128} << 20;  // maximum bytes of a file that is scanned for its duration
  constexpr double kLongest = 1e7;  // seconds; a longer duration is not plausible
  const AVStream& chosen = *format_->streams[stream];
  const double base = av_q2d(chosen.time_base);
  const double told = chosen.duration != AV_NOPTS_VALUE     ? static_cast<double>(chosen.duration) * base
                      : format_->duration != AV_NOPTS_VALUE ? static_cast<double>(format_->duration) / AV_TIME_BASE
                                                            : -1;
  double end = -1, sum = 0;
  bool all_timed = container_.timed;
  if (bytes_.size() <= kMaxBytes) {
    while (!stopped() && av.av_read_frame(format_, packet_) >= 0) {
      if (packet_->stream_index == stream) {
        const double duration = static_cast<double>(std::max<std::int64_t>(packet_->duration, 0)) * base;
        sum += duration;
        if (packet_->pts == AV_NOPTS_VALUE)
          all_timed = false;
        else
          end = std::max(end, static_cast<double>(packet_->pts) * base + duration - begin_of(stream));
      }
      av.av_packet_unref(packet_);
    }
    const double found = all_timed ? end : sum;
    // Packets do not always contain the duration of the last frame, so assume a maximum.
    constexpr double kLastPicture = 1;
    const bool longer = chosen.codecpar->codec_type == AVMEDIA_TYPE_VIDEO && container_.timed && told > found &&
                        told < found + kLastPicture;
    if (found > 0 && found < kLongest) return longer ? told : found;
  }
  return told > 0 && told < kLongest ? told : -1;
}

}  // namespace gs::render
