#pragma once

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

/// Output movie format: the container and its encoders, best one first.
struct MovieFormat {
  std::string_view extension;  // ".mp4", lower case
  std::string_view name;       // "MP4 (H.264)"
  const char* muxer;
  struct Encoder {
    const char* name;                    // name in FFmpeg
    std::string_view debian;             // Debian package of its library
    std::span<const char* const> pairs;  // alternating option names and values
  };
  std::span<const Encoder> encoders;
};
/// Returns the table of formats.
[[nodiscard]] std::span<const MovieFormat> movie_formats();
/// Returns the format for a file name's extension, case-insensitive; null if there is none.
[[nodiscard]] const MovieFormat* movie_format_of(std::string_view file_name);

/// Writes a movie frame by frame in memory. FFmpeg is opened at run time. Single-threaded.
class MovieWriter {
 public:
  /// Opens a writer for `width` x `height` frames; odd rows and columns at the edge are dropped. `rate` is in frames
  /// per second, > 0, a multiple of 1/1000. The error names the missing library or encoder.
  [[nodiscard]] static std::variant<std::unique_ptr<MovieWriter>, ImageError> open(const MovieFormat& format, int width,
                                                                                   int height, double rate);
  ~MovieWriter();
  MovieWriter(const MovieWriter&) = delete;
  MovieWriter& operator=(const MovieWriter&) = delete;

  /// Adds an RGB or RGBA frame of the size. Returns an error or nullopt.
  [[nodiscard]] std::optional<ImageError> add(const Image& image);
  /// Returns the bytes of the file. Call once.
  [[nodiscard]] std::variant<std::vector<std::byte>, ImageError> finish();
  /// Returns the encoder's name.
  [[nodiscard]] std::string_view encoder() const;

  static constexpr std::size_t kMaxBytes = std::size_t{2} << 30;  // per movie

 private:
  struct State;
  explicit MovieWriter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace gs::render
