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

/// A kind of movie that is written: the container and who encodes its pictures, the best one first.
struct MovieFormat {
  std::string_view extension;  // ".mp4", lower case
  std::string_view name;       // "MP4 (H.264)"
  const char* muxer;
  struct Encoder {
    const char* name;                    // FFmpeg's
    std::string_view debian;             // the library that has it
    std::span<const char* const> pairs;  // names and values of options, by turns
  };
  std::span<const Encoder> encoders;
};
/// The table of all.
[[nodiscard]] std::span<const MovieFormat> movie_formats();
/// By the extension of a file's name, in letters of any case; null: none.
[[nodiscard]] const MovieFormat* movie_format_of(std::string_view file_name);

/// A movie that is made picture by picture, in memory. FFmpeg is opened at run time. One thread.
class MovieWriter {
 public:
  /// Pictures of `width` x `height`, of which odd rows and columns at the edge are left out; 0 < rate pictures a
  /// second, a multiple of 1/1000. The error names what is missing: the libraries, or an encoder.
  [[nodiscard]] static std::variant<std::unique_ptr<MovieWriter>, ImageError> open(const MovieFormat& format, int width,
                                                                                   int height, double rate);
  ~MovieWriter();
  MovieWriter(const MovieWriter&) = delete;
  MovieWriter& operator=(const MovieWriter&) = delete;

  /// The next picture: RGB or RGBA of the size. What is wrong, if anything.
  [[nodiscard]] std::optional<ImageError> add(const Image& image);
  /// The bytes of the file. Once.
  [[nodiscard]] std::variant<std::vector<std::byte>, ImageError> finish();
  /// The encoder's name.
  [[nodiscard]] std::string_view encoder() const;

  static constexpr std::size_t kMostBytes = std::size_t{2} << 30;  // of a movie

 private:
  struct State;
  explicit MovieWriter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace gs::render
