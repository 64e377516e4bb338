#pragma once

#include "render/media/libav.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace gs::render {

/// Media container: its signatures and its demuxer.
struct MediaContainer {
  struct Mark {
    std::size_t at = 0;
    std::string_view text;  // empty means none
  };
  std::string_view name;
  Mark first, second;
  const char* demuxer;
  bool has_pictures, has_sound;  // may contain pictures or sound
  bool timed = true;             // if false, frames have no timestamps and follow the rate in the header
  bool exact = true;             // if false, positions of sound after a seek are not exact to the sample
};

/// Returns the container that starts like `bytes`; null if unknown. Containers that may refer to other files are not in
/// the table.
[[nodiscard]] const MediaContainer* media_container_of(std::span<const std::byte> bytes);

/// Demuxes a file in memory with FFmpeg, which reads no files or addresses. Single-threaded. Accepts untrusted input.
class MediaInput {
 public:
  /// `stopped` is polled regularly; true cancels the work. Null means never.
  MediaInput(std::span<const std::byte> bytes, const MediaContainer& container, std::function<bool()> stopped = {});
  ~MediaInput();
  MediaInput(const MediaInput&) = delete;
  MediaInput& operator=(const MediaInput&) = delete;

  /// Starts from the beginning. Returns an error or nullopt; after an error there are no packets.
  [[nodiscard]] std::optional<std::string> open();
  /// Returns the first stream of a kind, ignoring cover pictures; -1 if there is none.
  [[nodiscard]] int find_stream(AVMediaType kind) const;
  /// Opens a decoder of the stream; null on failure, with the reason in `problem`. `adjust` sets options before it is
  /// opened.
  [[nodiscard]] AVCodecContext* open_decoder(int stream, std::string& problem,
                                             const std::function<void(AVCodecContext&)>& adjust = {});
  /// Decodes the next picture or sound block of the stream into `frame`. Returns false at the end, and on errors, with
  /// the reason in `problem`. Broken packets are dropped.
  [[nodiscard]] bool decode(int stream, AVCodecContext& decoder, AVFrame& frame, std::string& problem);
  /// Seeks to a key frame at or before `seconds` from the stream's start, as far as the container indexes key frames.
  [[nodiscard]] bool seek(int stream, AVCodecContext& decoder, double seconds);
  /// Returns the stream's duration in seconds: by its packets if the file is short enough, else by its header; negative
  /// if unknown. Call open() afterwards to start again.
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
