#pragma once

#include "base/noncopyable.h"
#include "render/media/libav.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace gs::render {

/// Row of the table of media containers: signatures and demuxer.
struct MediaContainer {
  struct Mark {
    std::size_t at = 0;
    std::string_view text;  // bytes of the signature; empty means no signature
  };
  std::string_view name;
  Mark first, second;
  const char* demuxer;
  bool has_pictures, has_sound;  // the container can hold pictures, or sound
  bool timed = true;  // if false, frames have no timestamps; their times follow from the rate in the header
  bool exact = true;  // if false, the position of sound after a seek is not exact to the sample
};

/// Returns the container of a file that begins with `bytes`. Returns null if unknown. The table has no containers that
/// can refer to other files.
[[nodiscard]] const MediaContainer* media_container_of(std::span<const std::byte> bytes);

/// Demuxer and decoders of FFmpeg for a file in memory. Never reads files or addresses. One thread. Safe for untrusted
/// bytes.
class MediaInput : NonCopyable {
 public:
  /// Prepares to read `bytes`, which must outlive this object. `stopped` is called regularly and returns true to
  /// cancel. Null never cancels.
  MediaInput(std::span<const std::byte> bytes, const MediaContainer& container, std::function<bool()> stopped = {});
  ~MediaInput();

  /// Opens the file at its beginning. Returns the error, or nullopt. After an error, no packets can be read.
  [[nodiscard]] std::optional<std::string> open();
  /// Returns the index of the first stream of a kind. Ignores cover pictures. Returns -1 if there is no such stream.
  [[nodiscard]] int find_stream(AVMediaType kind) const;
  /// Opens a decoder for a stream. Returns null on failure and sets `problem`. `adjust` may set options of the decoder
  /// first.
  [[nodiscard]] AVCodecContext* open_decoder(int stream, std::string& problem,
                                             const std::function<void(AVCodecContext&)>& adjust = {});
  /// Decodes the next picture or block of sound of a stream into `frame`. Ignores broken packets. Returns false at the
  /// end and on errors; `problem` is only set on errors.
  [[nodiscard]] bool decode(int stream, AVCodecContext& decoder, AVFrame& frame, std::string& problem);
  /// Seeks to a key frame at most `seconds` after the start of the stream. Depends on the container's index of key
  /// frames.
  [[nodiscard]] bool seek(int stream, AVCodecContext& decoder, double seconds);
  /// Returns the duration of a stream in seconds: from its packets if the file is short, otherwise from its header.
  /// Returns a negative number if unknown. Call open() afterwards to read from the start.
  [[nodiscard]] double measure(int stream);

  [[nodiscard]] std::string error(const std::string& what, int code = 0) const;
  [[nodiscard]] const AVStream& stream(int index) const { return *format_->streams[index]; }
  /// Returns the stream's start time in seconds.
  [[nodiscard]] double begin_of(int stream) const;
  [[nodiscard]] const MediaContainer& container() const { return container_; }
  [[nodiscard]] bool stopped() const { return stopped_ && stopped_(); }

 private:
  void close();

  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  const MediaContainer& container_;
  std::function<bool()> stopped_;
  AVIOContext* input_ = nullptr;
  AVFormatContext* format_ = nullptr;
  AVPacket* packet_ = nullptr;
  bool drained_ = false;

  static int read(void* self, std::uint8_t* to, int size);
  static std::int64_t seek_to(void* self, std::int64_t offset, int whence);
};

}  // namespace gs::render
