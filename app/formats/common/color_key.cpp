#include "app/formats/common/color_key.h"

#include "app/formats/common/dataset_list.h"
#include "app/formats/common/scene_builder.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <iterator>
#include <utility>

namespace gs::app {
namespace {

constexpr std::string_view kColorKeyMark = "color key:";
constexpr std::size_t kMaxKeyColors = 64, kLongestKeyTitle = 200;

std::string_view next_key_word(std::string_view& text) {
  text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
  const std::string_view word = text.substr(0, text.find_first_of(" \t\r\n"));
  text.remove_prefix(word.size());
  return word;
}

bool read_key_number(std::string_view word, double& number) {
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  return error == std::errc() && end == word.data() + word.size() && std::isfinite(number);
}

std::optional<vrml::Color> read_key_color(std::string_view word) {
  std::uint32_t value = 0;
  if (word.size() != 7 || word.front() != '#') return std::nullopt;
  const auto [end, error] = std::from_chars(word.data() + 1, word.data() + word.size(), value, 16);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  const auto part = [value](int shift) { return static_cast<float>(value >> shift & 255) / 255; };
  return vrml::Color{part(16), part(8), part(0)};
}

vrml::Color mixed(const vrml::Color& a, const vrml::Color& b, float part) {
  return {a.r + (b.r - a.r) * part, a.g + (b.g - a.g) * part, a.b + (b.b - a.b) * part};
}

}  // namespace

vrml::Color ColorKey::color_of(double value) const {
  if (!std::isfinite(value) || colors.size() < 2) return {0.5f, 0.5f, 0.5f};
  const double last = static_cast<double>(colors.size() - 1);
  const double place = high > low ? std::clamp((value - low) / (high - low), 0.0, 1.0) * last : last / 2;
  const auto at = std::min(static_cast<std::size_t>(place), colors.size() - 2);
  return mixed(colors[at], colors[at + 1], static_cast<float>(place - static_cast<double>(at)));
}

double ColorKey::value_of(const vrml::Color& color) const {
  double nearest = INFINITY, place = 0;
  for (std::size_t i = 0; i + 1 < colors.size(); ++i) {
    const double from[] = {colors[i].r, colors[i].g, colors[i].b};
    const double to[] = {colors[i + 1].r, colors[i + 1].g, colors[i + 1].b};
    const double sought[] = {color.r, color.g, color.b};
    double along = 0, length = 0, distance = 0;
    for (int c = 0; c < 3; ++c) {
      along += (sought[c] - from[c]) * (to[c] - from[c]);
      length += (to[c] - from[c]) * (to[c] - from[c]);
    }
    const double part = length > 0 ? std::clamp(along / length, 0.0, 1.0) : 0;
    for (int c = 0; c < 3; ++c) {
      const double off = from[c] + part * (to[c] - from[c]) - sought[c];
      distance += off * off;
    }
    if (distance >= nearest) continue;
    nearest = distance;
    place = (static_cast<double>(i) + part) / static_cast<double>(colors.size() - 1);
  }
  return low + place * (high - low);
}

std::vector<vrml::Color> viridis_colors() {
  std::vector<vrml::Color> colors;
  for (const std::string_view one : {"#440154", "#3b528b", "#21918c", "#5ec962", "#fde725"})
    colors.push_back(*read_key_color(one));
  return colors;
}

ColorKey color_key_over(std::span<const float> values, std::vector<vrml::Color> colors, std::string title) {
  ColorKey key{std::move(title), INFINITY, -INFINITY, std::move(colors)};
  for (const float value : values)
    if (std::isfinite(value)) {
      key.low = std::min(key.low, static_cast<double>(value));
      key.high = std::max(key.high, static_cast<double>(value));
    }
  if (!(key.low <= key.high)) key.low = key.high = 0;
  return key;
}

ColorKey color_key_of_choice(std::span<const float> values, std::string title, const VoxelComponent& choice) {
  const SurfaceColors& wanted = choice.colors;
  std::vector<vrml::Color> colors;
  for (const glm::vec3& one : std::span(wanted.map).first(std::min(wanted.map.size(), kMaxKeyColors)))
    colors.push_back({std::clamp(one.x, 0.0f, 1.0f), std::clamp(one.y, 0.0f, 1.0f), std::clamp(one.z, 0.0f, 1.0f)});
  if (colors.size() < 2) colors = viridis_colors();
  ColorKey key = color_key_over(values, std::move(colors), std::move(title));
  if (choice.found) choice.found->range = {key.low, key.high};
  if (wanted.range == SurfaceColors::Range::typed && wanted.low <= wanted.high) {
    key.low = wanted.low;
    key.high = wanted.high;
  } else if (wanted.range == SurfaceColors::Range::contrast) {
    std::vector<float> finite;
    std::ranges::copy_if(values, std::back_inserter(finite), [](float value) { return std::isfinite(value); });
    const auto value_at = [&](double part) {
      const auto place = static_cast<std::ptrdiff_t>(part * static_cast<double>(finite.size() - 1));
      std::nth_element(finite.begin(), finite.begin() + place, finite.end());
      return static_cast<double>(finite[static_cast<std::size_t>(place)]);
    };
    constexpr double kLow = 0.02, kHigh = 0.98;
    if (!finite.empty()) {
      const double low = value_at(kLow), high = value_at(kHigh);
      if (low < high) key.low = low, key.high = high;
    }
  }
  return key;
}

std::string color_key_text(const ColorKey& key) {
  char buffer[96];
  std::snprintf(buffer, sizeof buffer, " %.9g %.9g", key.low, key.high);
  std::string text = std::string(kColorKeyMark) + buffer;
  for (const vrml::Color& color : key.colors) {
    const auto byte = [](float part) { return static_cast<unsigned>(std::lround(std::clamp(part, 0.0f, 1.0f) * 255)); };
    std::snprintf(buffer, sizeof buffer, " #%02x%02x%02x", byte(color.r), byte(color.g), byte(color.b));
    text += buffer;
  }
  return key.title.empty() ? text : text + " " + key.title;
}

std::pair<std::string, std::string> color_key_metadata(const ColorKey& key) {
  return {std::string(kColorKeyMetadata), color_key_text(key).substr(kColorKeyMark.size() + 1)};
}

std::optional<ColorKey> color_key_of(std::span<const std::pair<std::string, std::string>> metadata) {
  for (const auto& [name, value] : metadata)
    if (name == kColorKeyMetadata)
      if (auto key = read_color_key(std::string(kColorKeyMark) + ' ' + value)) return key;
  return std::nullopt;
}

void add_color_key(SceneBuilder& builder, const ColorKey& key) {
  const vrml::NodeId info = builder.make(vrml::NodeKind::world_info);
  vrml::MFString lines;
  lines.push_back(color_key_text(key));
  builder.set<vrml::MFString>(info, "info", std::move(lines));
  builder.add_root(info);
}

std::optional<ColorKey> read_color_key(std::string_view text) {
  if (!text.starts_with(kColorKeyMark)) return std::nullopt;
  text.remove_prefix(kColorKeyMark.size());
  ColorKey key;
  if (!read_key_number(next_key_word(text), key.low) || !read_key_number(next_key_word(text), key.high) ||
      !(key.low <= key.high))
    return std::nullopt;
  for (;;) {
    std::string_view rest = text;
    const auto color = read_key_color(next_key_word(rest));
    if (!color) break;
    if (key.colors.size() >= kMaxKeyColors) return std::nullopt;
    key.colors.push_back(*color);
    text = rest;
  }
  if (key.colors.size() < 2) return std::nullopt;
  text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
  key.title = text.substr(0, kLongestKeyTitle);
  return key;
}

std::optional<ColorKey> color_key_of(const vrml::SceneGraph& scene) {
  for (std::uint32_t i = 1; i <= scene.nodes().count(); ++i) {
    const vrml::Node& node = scene.nodes().at(i);
    if (node.in_prototype_body || node.type->read_as != vrml::NodeKind::world_info) continue;
    for (const vrml::String& line : scene.get<vrml::MFString>(scene.nodes().id_at(i), "info"))
      if (auto key = read_color_key(line.str())) return key;
  }
  return std::nullopt;
}

}  // namespace gs::app
