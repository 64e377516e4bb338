#pragma once

#include "vrml/scene/values/field_value.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace gs::app {

/// View of a binary STL: an 80-byte header, the number of facets, and 50 bytes per facet. The bytes must outlive the
/// view.
class BinaryStl {
 public:
  static constexpr std::size_t kHeaderBytes = 80, kDataStart = 84, kFacetBytes = 50;

  /// Opens a binary STL. Returns nullopt for a text STL and for a file without a complete header.
  [[nodiscard]] static std::optional<BinaryStl> open(std::span<const std::byte> bytes);

  [[nodiscard]] std::size_t size() const { return count_; }  // number of complete facets in the file
  [[nodiscard]] std::uint32_t announced() const { return announced_; }
  [[nodiscard]] std::array<glm::vec3, 3> corners(std::size_t facet) const;
  /// Returns the colour of the whole object that Materialise Magics stores in the header, or nullopt.
  [[nodiscard]] const std::optional<vrml::Color>& object_color() const { return object_color_; }
  /// Returns true if the attribute bytes of facets are colours. Either the header has COLOR= and a facet has a separate
  /// colour, or bit 15 is set in each facet. `looked_at` is the number of facets to check.
  [[nodiscard]] bool has_colors(std::size_t looked_at) const;
  [[nodiscard]] vrml::Color color(std::size_t facet) const;

 private:
  [[nodiscard]] std::uint16_t attribute(std::size_t facet) const;

  std::span<const std::byte> facets_;
  std::size_t count_ = 0;
  std::uint32_t announced_ = 0;
  std::optional<vrml::Color> object_color_;
};

/// Returns true for a text STL. Returns false for a binary STL, even if its header begins with "solid".
[[nodiscard]] bool is_text_stl(std::span<const std::byte> bytes);

}  // namespace gs::app
