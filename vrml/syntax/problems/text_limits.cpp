#include "vrml/syntax/problems/text_limits.h"

#include <string>
#include <utility>
#include <variant>

namespace gs::vrml {

bool TextLimits::is_first_excess() { return !std::exchange(exceeded_, true); }

bool TextLimits::is_exhausted(SourceLocation location) {
  if (!scene_.memory().exhausted()) return false;
  if (!std::exchange(exhausted_, true))
    problems_.error(location, scene_.budget()->refusal(Resource::nodes) + "; skipped the rest of the file");
  return true;
}

bool TextLimits::admits_depth(std::size_t depth, SourceLocation location) {
  if (depth < scene_.limits().nesting) return true;
  if (is_first_excess())
    problems_.error(location, "nested deeper than " + std::to_string(scene_.limits().nesting) +
                                  " levels; skipped the deeper content");
  return false;
}

bool TextLimits::admits_string(std::size_t bytes, SourceLocation location) {
  constexpr std::size_t kEntry = 64;
  if (bytes <= scene_.limits().string_bytes) return scene_.memory().charge(bytes + kEntry);
  if (is_first_excess()) problems_.error(location, "a string exceeds the limit; left empty");
  return false;
}

bool TextLimits::admits_image(double width, double height, double components, SourceLocation location) {
  const std::uint64_t limit = scene_.limits().image_pixels;
  if (width >= 0 && height >= 0 && components >= 0 && components <= 4 && width * height <= static_cast<double>(limit))
    return true;
  const auto shown = [](double number) { return std::to_string(static_cast<long long>(number)); };
  problems_.error(location, "an image of " + shown(width) + " x " + shown(height) + " pixels with " +
                                shown(components) + " components; expected 0 to 4 components and at most " +
                                std::to_string(limit) + " pixels");
  return false;
}

void TextLimits::charge_growth(const FieldValue& list, std::size_t& charged, bool all) {
  constexpr std::size_t kStep = std::size_t{16} << 10;
  const std::size_t bytes = std::visit(
      [](const auto& value) -> std::size_t {
        if constexpr (requires { value.words; }) return value.words.size() * sizeof(std::uint32_t);
        if constexpr (requires { typename std::decay_t<decltype(value)>::element_type; }) return sizeof(*value);
        if constexpr (requires { value.size(); }) return value.size() * sizeof(*value.data());
        return 0;
      },
      list);
  if (bytes <= charged || (!all && bytes - charged < kStep)) return;
  (void)scene_.memory().charge(bytes - charged);
  charged = bytes;
}

}  // namespace gs::vrml
