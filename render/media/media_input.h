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

/// A kind of file with pictures or sound in it: its marks, and who takes it apart.
struct MediaContainer {
  struct Mark {
    std::size_t at = 0;
    std::string_view text;  // empty: none
  };
  std::string_view name;
  Mark first, second;
  const char* demuxer;
  bool has_pictures, has_sound;  // may have
  bool timed = true;             // false: pictures have no times, but follow each other at the rate of the head
  bool exact = true;             // false: where a stretch of sound is, is not told to the sample behind a jump
};

/// The kind of file that begins like this; null: none that is known. Others, which may refer to further files, are not
/// asked.
[[nodiscard]] const MediaContainer* media_container_of(std::span<const std::byte> bytes);

/// A file in memory, taken apart into packets by FFmpeg, which reads nothing else: no file, no address. One thread;
/// safe for untrusted bytes.
class MediaInput {
 public:
  /// `stopped`: asked now and then; true ends what it does. Null: nobody does.
  MediaInput(std::span<const std::byte> bytes, const MediaContainer& container, std::function<bool()> stopped = {});
  ~MediaInput();
  MediaInput(const MediaInput&) = delete;
  MediaInput& operator=(const MediaInput&) = delete;

  /// Begins anew at the front. What is wrong, if anything: then there are no packets.
  [[nodiscard]] std::optional<std::string> open();
  /// The first stream of a kind that is no picture on a cover; -1: there is none.
  [[nodiscard]] int find_stream(AVMediaType kind) const;
  /// A decoder of the stream; null, and `problem` says why. `adjust`: sets more, before it is opened.
  [[nodiscard]] AVCodecContext* open_decoder(int stream, std::string& problem,
                                             const std::function<void(AVCodecContext&)>& adjust = {});
  /// The next picture or stretch of sound of the stream into `frame`: false at the end, with `problem` where there is
  /// an error. Packets that are broken are lost.
  [[nodiscard]] bool decode(int stream, AVCodecContext& decoder, AVFrame& frame, std::string& problem);
  /// Goes to a key frame not after `seconds` from the stream's beginning, as far as the container tells where one is.
  [[nodiscard]] bool seek(int stream, AVCodecContext& decoder, double seconds);
  /// How long the stream is, in seconds: by its packets, where the file is not too long for that, else as its head
  /// says. Negative: that cannot be told. `begin` it anew afterwards.
  [[nodiscard]] double measure(int stream);

  [[nodiscard]] std::string error(const std::string& what, int code = 0) const;
  [[nodiscard]] const AVStream& stream(int index) const { return *format_->streams[index]; }
  /// In seconds.
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
