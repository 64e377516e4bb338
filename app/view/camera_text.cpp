#include "app/view/camera_text.h"

#include "base/text.h"

#include <glm/gtc/quaternion.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <numbers>
#include <optional>
#include <span>
#include <system_error>

namespace gs::app {
namespace {

constexpr std::string_view kExpectedCamera =
    "expected position=X,Y,Z orientation=X,Y,Z,RADIANS fieldOfView=RADIANS and, for parallel rays, height=H, or the "
    "text of a Viewpoint";
constexpr std::string_view kNodeWords[] = {"OrthoViewpoint", "Viewpoint"};  // first words of a text that is a node
constexpr std::size_t kMaxCameraText = 4096;  // max bytes of a text

std::string numbers_text(std::span<const double> numbers, char separator) {
  std::string text;
  for (const double number : numbers) {
    char buffer[32];
    std::snprintf(buffer, sizeof buffer, "%.9g", number == 0 ? 0.0 : number);
    text += (text.empty() ? "" : std::string(1, separator)) + buffer;
  }
  return text;
}

struct CameraNumbers {
  double position[3], orientation[4], field_of_view[1];
};

CameraNumbers numbers_of_camera(const Pose& pose) {
  const glm::quat turn = pose.orientation.w < 0 ? -pose.orientation : pose.orientation;
  const glm::dvec3 axis(turn.x, turn.y, turn.z);
  const double sine = glm::length(axis), angle = 2 * std::atan2(sine, double{turn.w});
  const glm::dvec3 unit = sine > 1e-12 ? axis / sine : glm::dvec3(0, 0, 1);
  return {{pose.position.x, pose.position.y, pose.position.z},
          {unit.x, unit.y, unit.z, sine > 1e-12 ? angle : 0},
          {double{pose.field_of_view}}};
}

/// Tokenizer that returns words, names and numbers, and skips separators.
class CameraWords {
 public:
  explicit CameraWords(std::string_view text) : left_(text) {}
  /// Returns the next token, or "" at the end.
  std::string_view next() {
    for (;;) {
      const std::size_t first = left_.find_first_not_of(" \t\r\n,={}");
      if (first == std::string_view::npos) return {};
      left_.remove_prefix(first);
      if (left_.front() != '#') break;
      left_.remove_prefix(std::min(left_.find('\n'), left_.size()));
    }
    if (left_.front() == '"') {
      const std::size_t end = left_.find('"', 1);
      return take(end == std::string_view::npos ? left_.size() : end + 1);
    }
    return take(std::min(left_.find_first_of(" \t\r\n,={}#\""), left_.size()));
  }

 private:
  std::string_view take(std::size_t size) {
    const std::string_view word = left_.substr(0, size);
    left_.remove_prefix(size);
    return word;
  }
  std::string_view left_;
};

std::optional<double> camera_number(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  const bool good = error == std::errc() && end == word.data() + word.size() && std::isfinite(value);
  return good && std::abs(value) <= kFarthest ? std::optional(value) : std::nullopt;
}

}  // namespace

std::string camera_text(const Pose& pose) {
  const CameraNumbers numbers = numbers_of_camera(pose);
  std::string text = "position=" + numbers_text(numbers.position, ',') +
                     " orientation=" + numbers_text(numbers.orientation, ',') +
                     " fieldOfView=" + numbers_text(numbers.field_of_view, ',');
  if (pose.height > 0) text += " height=" + numbers_text(std::span(&pose.height, 1), ',');
  return text;
}

std::string viewpoint_text(const Pose& pose) {
  const CameraNumbers numbers = numbers_of_camera(pose);
  return "Viewpoint { position " + numbers_text(numbers.position, ' ') + " orientation " +
         numbers_text(numbers.orientation, ' ') + " fieldOfView " + numbers_text(numbers.field_of_view, ' ') + " }";
}

std::variant<Pose, std::string> read_camera(std::string_view text) {
  const std::string expected(kExpectedCamera);
  if (text.size() > kMaxCameraText) return expected;
  double position[3] = {0, 0, 10}, orientation[4] = {0, 0, 1, 0}, field_of_view[1] = {0.785398}, height[1] = {0};
  struct Field {
    std::string_view name;
    std::span<double> numbers;
    bool given = false;
  };
  Field fields[] = {
      {"position", position}, {"orientation", orientation}, {"fieldOfView", field_of_view}, {"height", height}};
  bool any = false;
  CameraWords words(text);
  for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
    if (word == "DEF" || word == "description" || word == "jump") {
      if (words.next().empty()) return expected;
      continue;
    }
    if (std::find(std::begin(kNodeWords), std::end(kNodeWords), word) != std::end(kNodeWords)) continue;
    Field* field = nullptr;
    for (Field& one : fields)
      if (one.name == word) field = &one;
    if (!field) return "\"" + shortened(word, 40) + "\": " + expected;
    if (field->given) return std::string(field->name) + " is given twice; " + expected;
    field->given = any = true;
    for (double& number : field->numbers) {
      const auto value = camera_number(words.next());
      if (!value)
        return std::string(field->name) + " has " + std::to_string(field->numbers.size()) + " numbers; " + expected;
      number = *value;
    }
  }
  if (!any) return expected;
  if (!(field_of_view[0] > 0 && field_of_view[0] < std::numbers::pi))
    return "fieldOfView must be between 0 and 3.14159, exclusive; " + expected;
  if (height[0] < 0) return "height must be at least 0; " + expected;
  Pose pose;
  pose.position = {position[0], position[1], position[2]};
  const glm::dvec3 axis(orientation[0], orientation[1], orientation[2]);
  const double length = glm::length(axis);
  if (!(length > 0) && orientation[3] != 0) return "orientation needs an axis other than 0,0,0; " + expected;
  if (length > 0) pose.orientation = glm::quat(glm::angleAxis(orientation[3], axis / length));
  pose.field_of_view = static_cast<float>(field_of_view[0]);
  pose.height = height[0];
  return valid_pose(pose, Pose{});
}

}  // namespace gs::app
