#pragma once

#include "qnv/base/description.h"

#include <glm/vec3.hpp>

#include <array>
#include <charconv>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

namespace gs::qnv {

/// Specular properties of a surface (VRML97 6.27), stored in its stream's metadata.
struct Shine {
  glm::vec3 specular{0};
  float shininess = 0.2f;
  friend bool operator==(const Shine&, const Shine&) = default;
};
/// Returns the metadata; empty if the surface has no specular colour.
[[nodiscard]] inline std::vector<std::pair<std::string, std::string>> metadata_of(const Shine& shine) {
  if (shine.specular == glm::vec3(0)) return {};
  const auto text = [](float number) {
    std::array<char, 16> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number, std::chars_format::general, 4);
    return std::string(digits.data(), end.ptr);
  };
  const glm::vec3& s = shine.specular;
  return {{"specular", text(s.x) + " " + text(s.y) + " " + text(s.z)}, {"shininess", text(shine.shininess)}};
}
/// Reads the metadata; ignores values that are not numbers from 0 to 1.
[[nodiscard]] inline Shine shine_of(const Description& description) {
  Shine shine;
  const auto read = [](std::string_view text, std::span<float> numbers) {
    const char *at = text.data(), *const end = at + text.size();
    for (float& number : numbers) {
      while (at != end && *at == ' ') ++at;
      const auto [next, error] = std::from_chars(at, end, number);
      if (error != std::errc() || !(number >= 0 && number <= 1)) return false;
      at = next;
    }
    return at == end;
  };
  for (const auto& [key, value] : description.metadata) {
    std::array<float, 3> numbers{};
    if (key == "specular" && read(value, numbers)) shine.specular = {numbers[0], numbers[1], numbers[2]};
    if (key == "shininess" && read(value, std::span(numbers).first(1))) shine.shininess = numbers[0];
  }
  return shine;
}

}  // namespace gs::qnv
