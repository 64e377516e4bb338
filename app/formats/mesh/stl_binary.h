#pragma once

#include "vrml/scene/field_value.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace gs::app {

/// The facets of a binary STL: 80 bytes of any text, their number, and 50 bytes for each. The bytes must outlive it.
class BinaryStl {
 public:
  static constexpr std::size_t kHeaderBytes = 80, kDataStart = 84, kFacetBytes = 50;

  /// Nothing for a text, and for what is too short for a header.
  [[nodiscard]] static std::optional<BinaryStl> open(std::span<const std::byte> bytes);

  [[nodiscard]] std::size_t size() const { return count_; }  // facets that are there, of those announced
  [[nodiscard]] std::uint32_t announced() const { return announced_; }
  [[nodiscard]] std::array<glm::vec3, 3> corners(std::size_t facet) const;
  /// The colour of all, where Materialise Magics has left one in the header.
  [[nodiscard]] const std::optional<vrml::Color>& object_color() const { return object_color_; }
  /// Whether the last two bytes of facets are colours: without either sign they are anything, and most programs leave
  /// rubbish or nothing there. `looked_at`: how many facets are asked for theirs.
  [[nodiscard]] bool has_colors(std::size_t looked_at) const;
  [[nodiscard]] vrml::Color color(std::size_t facet) const;

 private:
  [[nodiscard]] std::uint16_t attribute(std::size_t facet) const;

  std::span<const std::byte> facets_;
  std::size_t count_ = 0;
  std::uint32_t announced_ = 0;
  std::optional<vrml::Color> object_color_;
};

/// Whether an STL is one of text, rather than a binary file whose header begins like one.
[[nodiscard]] bool is_text_stl(std::span<const std::byte> bytes);

}  // namespace gs::app
