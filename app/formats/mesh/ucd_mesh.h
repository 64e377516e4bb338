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

/// In the order of their numbers in binary files.
enum class UcdType : std::uint8_t { point, line, triangle, quadrilateral, tetrahedron, pyramid, prism, hexahedron };
inline constexpr std::array<std::size_t, 8> kUcdCorners = {1, 2, 3, 4, 4, 5, 6, 8};
inline constexpr std::array<std::string_view, 8> kUcdNames = {"pt",  "line", "tri",   "quad",
                                                              "tet", "pyr",  "prism", "hex"};

/// A cell and its corners, as indices of nodes; -1 for what the file has wrong.
struct UcdCell {
  UcdType type = UcdType::point;
  std::array<std::int32_t, 8> corners{};
};

/// What is read of a UCD file.
struct UcdMesh {
  std::vector<glm::vec3> nodes;
  std::vector<UcdCell> cells;
  std::vector<float> node_values, cell_values;  // the component that is shown; may be empty or too short
  std::string node_label, cell_label;           // "temperature (kelvin)"; may be empty
};

/// Reads a file of either form into `mesh`, as far as it goes; what is wrong with it, and in which line (0: none).
struct UcdProblem {
  std::string message;
  std::uint32_t line = 0;
};
[[nodiscard]] std::optional<UcdProblem> read_ucd_text(std::span<const std::byte> bytes, UcdMesh& mesh);
[[nodiscard]] std::optional<UcdProblem> read_ucd_binary(std::span<const std::byte> bytes, UcdMesh& mesh);

/// "temperature (kelvin)", without blanks about it and without what is no letter of ASCII.
[[nodiscard]] std::string ucd_label(std::string_view name, std::string_view unit);

/// The first byte of a binary file.
inline constexpr std::byte kUcdBinary{7};

}  // namespace gs::app
