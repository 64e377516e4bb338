#include "app/formats/mesh/stl_binary.h"

#include <algorithm>
#include <bit>
#include <string_view>

namespace gs::app {
namespace {

constexpr std::uint16_t kStlColorBit = 0x8000;

std::uint32_t stl_word(const std::byte* from) {
  return static_cast<std::uint32_t>(from[0]) | static_cast<std::uint32_t>(from[1]) << 8 |
         static_cast<std::uint32_t>(from[2]) << 16 | static_cast<std::uint32_t>(from[3]) << 24;
}

/// Returns the colour after "COLOR=" in the header (four bytes), or nullopt.
std::optional<vrml::Color> magics_color(std::span<const std::byte> header) {
  const std::string_view text(reinterpret_cast<const char*>(header.data()), header.size());
  const std::size_t at = text.find("COLOR=");
  if (at == std::string_view::npos || at + 10 > text.size()) return std::nullopt;
  const auto part = [&](std::size_t i) {
    return static_cast<float>(static_cast<unsigned char>(text[at + 6 + i])) / 255;
  };
  return vrml::Color{part(0), part(1), part(2)};
}

}  // namespace

std::optional<BinaryStl> BinaryStl::open(std::span<const std::byte> bytes) {
  if (bytes.size() < kDataStart || is_text_stl(bytes)) return std::nullopt;
  BinaryStl stl;
  stl.announced_ = stl_word(bytes.data() + kHeaderBytes);
  stl.facets_ = bytes.subspan(kDataStart);
  stl.count_ = std::min<std::size_t>(stl.announced_, stl.facets_.size() / kFacetBytes);
  stl.object_color_ = magics_color(bytes.first(kHeaderBytes));
  return stl;
}

std::array<glm::vec3, 3> BinaryStl::corners(std::size_t facet) const {
  std::array<glm::vec3, 3> out{};
  const std::byte* from = facets_.data() + facet * kFacetBytes + 12;  // 12 bytes of normal come first
  for (glm::vec3& p : out)
    for (int axis = 0; axis < 3; ++axis, from += 4) p[axis] = std::bit_cast<float>(stl_word(from));
  return out;
}

std::uint16_t BinaryStl::attribute(std::size_t facet) const {
  return static_cast<std::uint16_t>(stl_word(facets_.data() + facet * kFacetBytes + 46) >> 16);
}

bool BinaryStl::has_colors(std::size_t looked_at) const {
  const std::size_t all = std::min(looked_at, count_);
  std::size_t colored = 0;
  for (std::size_t i = 0; i < all; ++i) colored += (attribute(i) & kStlColorBit) != 0 ? 1 : 0;
  return all > 0 && (object_color_ ? colored < all : colored == all);
}

vrml::Color BinaryStl::color(std::size_t facet) const {
  const std::uint16_t bits = attribute(facet);
  // Each channel has five bits. Magics stores red in the lowest bits, other programs in the highest.
  const float low = static_cast<float>(bits & 31) / 31, middle = static_cast<float>(bits >> 5 & 31) / 31,
              high = static_cast<float>(bits >> 10 & 31) / 31;
  if (!object_color_) return {high, middle, low};
  return (bits & kStlColorBit) != 0 ? *object_color_ : vrml::Color{low, middle, high};
}

}  // namespace gs::app
