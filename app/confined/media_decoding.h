#pragma once

#include "base/noncopyable.h"
#include "render/image/image.h"
#include "render/media/movie.h"
#include "render/media/sample_reader.h"

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <variant>

// Decoding of sounds and movies in confined children, as app/confined/image_decoding.h does for images. Each open movie
// or sound has a child of its own. MIDI files are read in this process, because their reader belongs to this program.
namespace gs::app {

/// Bytes of a sound or movie. `file` is an open file with the same bytes, or -1; a child then needs no copy.
struct EncodedMedia {
  std::span<const std::byte> bytes;
  int file = -1;
};

/// Movie that decodes pictures for requested times. One thread at a time.
class MovieSource : NonCopyable {
 public:
  virtual ~MovieSource() = default;
  /// Returns the picture at `seconds`, as render::Movie::at() does.
  [[nodiscard]] virtual std::variant<const render::Movie::Frame*, render::ImageError> at(double seconds) = 0;
};

/// Finds out what can be played, as render::examine_media() does. Any thread.
[[nodiscard]] std::variant<render::MediaInfo, render::MediaError> examine_confined(
    const EncodedMedia& media, const std::function<bool()>& stopped = {});
/// Opens a movie, as render::Movie::open() does. `media` must outlive the result.
[[nodiscard]] std::variant<std::unique_ptr<MovieSource>, render::ImageError> open_movie_confined(
    const EncodedMedia& media, const render::ImageLimits& limits);
/// Opens the sound of a sound or movie, as render::open_samples() does. `media` must outlive the result. If the child
/// fails later, the sound ends.
[[nodiscard]] std::variant<std::unique_ptr<render::SampleReader>, render::MediaError> open_samples_confined(
    const EncodedMedia& media, double synthesis_rate);

}  // namespace gs::app
