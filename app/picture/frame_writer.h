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

/// What is wrong with a name for an animation, by what can be written.
[[nodiscard]] std::optional<std::string> check_animation_name(const std::string& name);

/// Pictures of an animation, as files of their own ("walk.%04d.png") or a movie ("walk.mp4", "walk.webm").
class FrameWriter {
 public:
  /// Why it cannot be begun: a name of no kind, something of another kind that is there, a missing encoder.
  [[nodiscard]] static std::variant<std::unique_ptr<FrameWriter>, std::string> open(const std::string& name,
                                                                                    const glm::ivec2& size, double rate,
                                                                                    double dots_per_inch);
  virtual ~FrameWriter() = default;
  /// The next one. What is wrong, if anything.
  [[nodiscard]] virtual std::optional<std::string> add(const render::Image& image) = 0;
  /// All is written. A movie's file is only made now.
  [[nodiscard]] virtual std::optional<std::string> finish() = 0;
  /// "200 pictures", "H.264 by libx264": what was made.
  [[nodiscard]] virtual std::string what() const = 0;
};

}  // namespace gs::app
