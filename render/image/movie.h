#pragma once

#include "render/image/image.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <variant>

namespace gs::render {

/// The pictures of a movie in memory: MPEG-1 and what else the libraries of FFmpeg read of the containers in the table
/// of render/media/media_input.cpp, animated GIF among them. These are opened at run time. One thread; safe for
/// untrusted bytes: nothing is read but these, no file, no address, and what it may cost is bounded by ImageLimits.
class Movie {
 public:
  struct Frame {
    Image image;      // 1 or 3 components, 4 where the movie has alpha; reduced as ImageLimits says
    double time = 0;  // seconds from the start of the movie
  };

  /// `bytes` outlive the movie. The error says what was not as expected.
  [[nodiscard]] static std::variant<std::unique_ptr<Movie>, ImageError> open(std::span<const std::byte> bytes,
                                                                             const ImageLimits& limits = {});
  ~Movie();
  Movie(const Movie&) = delete;
  Movie& operator=(const Movie&) = delete;

  /// The next picture; nothing at the end. After an error there are no more.
  [[nodiscard]] std::variant<std::optional<Frame>, ImageError> next();
  /// The picture at a time: the last one that is not later, or the first one. Valid until the next call; null where
  /// there is none at all. Costs what lies between it and the one before; backwards about a second is decoded at a
  /// time, and of that is kept what fits into kMostKept. Not to be mixed with `next`.
  [[nodiscard]] std::variant<const Frame*, ImageError> at(double seconds);

  static constexpr std::size_t kMostKept = std::size_t{32} << 20;  // bytes of pictures

 private:
  struct State;
  explicit Movie(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Whether the bytes begin as a movie in a container that is known.
[[nodiscard]] bool is_movie(std::span<const std::byte> bytes);

}  // namespace gs::render
