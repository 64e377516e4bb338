#pragma once

#include "app/base/numbered_files.h"
#include "render/image/image.h"

#include <glm/vec2.hpp>

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <variant>

namespace gs::app {

/// Checks whether the name of an animation file has a supported format. Returns a message if not.
[[nodiscard]] std::optional<std::string> check_animation_name(const std::string& name);

/// Writer of the pictures of an animation: as separate files ("walk.%04d.png") or as a movie ("walk.mp4", "walk.webm").
class FrameWriter {
 public:
  /// Opens a writer. Returns a message if the format is unknown, if the encoder is missing, or if the name is that of
  /// another kind of file.
  [[nodiscard]] static std::variant<std::unique_ptr<FrameWriter>, std::string> open(const std::string& name,
                                                                                    const glm::ivec2& size, double rate,
                                                                                    double dots_per_inch);
  virtual ~FrameWriter() = default;
  /// Adds the next picture. Returns a message on failure.
  [[nodiscard]] virtual std::optional<std::string> add(const render::Image& image) = 0;
  /// Completes the output; the file of a movie appears only then. Returns a message on failure.
  [[nodiscard]] virtual std::optional<std::string> finish() = 0;
  /// Describes the output, for example "200 pictures" or "H.264 by libx264".
  [[nodiscard]] virtual std::string what() const = 0;
};

}  // namespace gs::app
