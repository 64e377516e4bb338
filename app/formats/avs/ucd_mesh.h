#pragma once

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// Cell type, numbered as in binary files.
enum class UcdType : std::uint8_t { point, line, triangle, quadrilateral, tetrahedron, pyramid, prism, hexahedron };
inline constexpr std::array<std::size_t, 8> kUcdCorners = {1, 2, 3, 4, 4, 5, 6, 8};
inline constexpr std::array<std::string_view, 8> kUcdNames = {"pt",  "line", "tri",   "quad",
                                                              "tet", "pyr",  "prism", "hex"};

/// Cell. Its corners are node indices; -1 stands for an invalid index in the file.
struct UcdCell {
  UcdType type = UcdType::point;
  std::array<std::int32_t, 8> corners{};
};

/// Contents of a UCD file.
struct UcdMesh {
  std::vector<glm::vec3> nodes;
  std::vector<UcdCell> cells;
  std::vector<float> node_values, cell_values;  // values of the displayed component; may be empty or too short
  std::string node_label, cell_label;           // "temperature (kelvin)"; may be empty
};

/// Error of a UCD file, with its line (0 if unknown). The readers store everything before the error in `mesh`.
struct UcdProblem {
  std::string message;
  std::uint32_t line = 0;
};
[[nodiscard]] std::optional<UcdProblem> read_ucd_text(std::span<const std::byte> bytes, UcdMesh& mesh);
[[nodiscard]] std::optional<UcdProblem> read_ucd_binary(std::span<const std::byte> bytes, UcdMesh& mesh);

/// Formats a label such as "temperature (kelvin)". Trims blanks and removes non-ASCII characters.
[[nodiscard]] std::string ucd_label(std::string_view name, std::string_view unit);

/// First byte of a binary file.
inline constexpr std::byte kUcdBinary{7};

}  // namespace gs::app
