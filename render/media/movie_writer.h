#pragma once

#include "base/noncopyable.h"
#include "render/image/image.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace gs::render {

/// Row of the table of movie formats: a container and its encoders, best encoder first.
struct MovieFormat {
  std::string_view extension;  // ".mp4", lower case
  std::string_view name;       // "MP4 (H.264)"
  const char* muxer;
  struct Encoder {
    const char* name;  // encoder's name in FFmpeg
    std::string_view debian;  // Debian package of the encoder's library
    std::span<const char* const> pairs;  // options: names and values alternate
  };
  std::span<const Encoder> encoders;
};
/// Returns the table of formats.
[[nodiscard]] std::span<const MovieFormat> movie_formats();
/// Returns the format for the extension of a file name. Ignores case. Returns null if no format has it.
[[nodiscard]] const MovieFormat* movie_format_of(std::string_view file_name);

/// Encodes a movie in memory, frame by frame. FFmpeg is loaded at run time. One thread.
class MovieWriter : NonCopyable {
 public:
  /// Opens a writer for frames of `width` x `height` pixels. Drops the last row or column if their number is odd.
  /// `rate` is in frames per second, positive, a multiple of 1/1000. The error names the missing library or encoder.
  [[nodiscard]] static std::variant<std::unique_ptr<MovieWriter>, ImageError> open(const MovieFormat& format, int width,
                                                                                   int height, double rate);
  ~MovieWriter();

  /// Adds an RGB or RGBA frame of that size. Returns the error, or nullopt.
  [[nodiscard]] std::optional<ImageError> add(const Image& image);
  /// Returns the bytes of the file. Call it once, after all frames.
  [[nodiscard]] std::variant<std::vector<std::byte>, ImageError> finish();
  /// Returns the encoder's name.
  [[nodiscard]] std::string_view encoder() const;

  static constexpr std::size_t kMaxBytes = std::size_t{2} << 30;  // maximum bytes of a movie

 private:
  struct State;
  explicit MovieWriter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace gs::render
