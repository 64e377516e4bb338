#pragma once

#include "render/image/image.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <variant>

namespace gs::render {

/// Frames of a movie in memory: MPEG-1 and other formats that FFmpeg reads from the containers in
/// render/media/media_input.cpp, including animated GIF. FFmpeg is opened at run time. Single-threaded. Accepts
/// untrusted input: reads no files or addresses, and ImageLimits bounds the cost.
class Movie {
 public:
  struct Frame {
    Image image;      // 1 or 3 components, 4 if the movie has alpha; reduced according to ImageLimits
    double time = 0;  // seconds from the start of the movie
  };

  /// Opens a movie; `bytes` must outlive it. The error explains the unexpected input.
  [[nodiscard]] static std::variant<std::unique_ptr<Movie>, ImageError> open(std::span<const std::byte> bytes,
                                                                             const ImageLimits& limits = {});
  ~Movie();
  Movie(const Movie&) = delete;
  Movie& operator=(const Movie&) = delete;

  /// Returns the next frame; nullopt at the end. After an error there are no more frames.
  [[nodiscard]] std::variant<std::optional<Frame>, ImageError> next();
  /// Returns the last frame at or before `seconds`, else the first one; null if there are no frames. Valid until the
  /// next call. The cost is proportional to the distance from the previous call. Going back decodes about one second at
  /// a time and caches up to kMaxKept of it. Do not mix with `next`.
  [[nodiscard]] std::variant<const Frame*, ImageError> at(double seconds);

  static constexpr std::size_t kMaxKept = std::size_t{32} << 20;  // bytes of cached frames

 private:
  struct State;
  explicit Movie(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace gs::render
