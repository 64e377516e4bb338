#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace gs::vrml {
class SceneGraph;
}

namespace gs::app {

class SceneBuilder;

/// Steps of a file with a surface that changes with time, and the one that a scene shows. A scene from such a file has
/// them in the `info` of a WorldInfo:
///
///     time steps: SHOWN TIME TIME ...
struct TimeSteps {
  std::vector<double> times;  // ascending; at least two
  std::size_t shown = 0;

  friend bool operator==(const TimeSteps&, const TimeSteps&) = default;
};
/// Maximum number of steps that a scene states.
inline constexpr std::size_t kMaxTimeSteps = 10'000;

/// Returns true if there are 2 to kMaxTimeSteps finite times, and the shown step is one of them.
[[nodiscard]] bool is_valid(const TimeSteps& steps);
/// Adds a WorldInfo with the steps to the scene under construction.
void add_time_steps(SceneBuilder& builder, const TimeSteps& steps);
/// Returns the first valid steps in a WorldInfo of the scene, or nullopt.
[[nodiscard]] std::optional<TimeSteps> time_steps_of(const vrml::SceneGraph& scene);

}  // namespace gs::app
