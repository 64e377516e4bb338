#pragma once

#include "base/noncopyable.h"
#include "render/image/image.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <variant>

namespace gs::render {

/// Frames of a movie in memory: MPEG-1 and other formats, including animated GIF, in the containers of
/// render/media/media_input.cpp. FFmpeg decodes them and is loaded at run time. One thread.
///
/// Safe for untrusted bytes: reads no files or addresses, and ImageLimits bounds the cost.
class Movie : NonCopyable {
 public:
  struct Frame {
    Image image;  // 1 or 3 components, or 4 with alpha; scaled down if ImageLimits requires it
    double time = 0;  // seconds from the start of the movie
  };

  /// Opens a movie. `bytes` must outlive it. The error names the expected input.
  [[nodiscard]] static std::variant<std::unique_ptr<Movie>, ImageError> open(std::span<const std::byte> bytes,
                                                                             const ImageLimits& limits = {});
  ~Movie();

  /// Returns the next frame, or nullopt at the end. After an error, no more frames follow.
  [[nodiscard]] std::variant<std::optional<Frame>, ImageError> next();
  /// Returns the last frame at or before `seconds`. Before the first frame, returns the first. Returns null if the
  /// movie has no frames. Valid until the next call. Do not mix with `next`.
  ///
  /// The cost is proportional to the distance from the previous call. Going back decodes about one second at a time,
  /// and caches its frames in at most kMaxKept bytes.
  [[nodiscard]] std::variant<const Frame*, ImageError> at(double seconds);

  static constexpr std::size_t kMaxKept = std::size_t{32} << 20;  // maximum bytes of cached frames

 private:
  struct State;
  explicit Movie(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace gs::render
