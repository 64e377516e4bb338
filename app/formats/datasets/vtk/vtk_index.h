#pragma once

#include "app/formats/volume/vtk_xml.h"

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

// VTK and ParaView files that refer to other files: pieces of parallel programs, blocks, time steps.
namespace gs::app {

/// Class of a file by its first bytes.
enum class VtkFileClass : std::uint8_t {
  other,
  leaf,    // VTK XML with data: ImageData, RectilinearGrid, StructuredGrid, PolyData, UnstructuredGrid
  pieces,  // P and the type of a leaf: the pieces of one dataset
  blocks,  // blocks with names: vtkMultiBlockDataSet and similar
  steps,   // times with their files: Collection (PVD), or a series in JSON
  legacy,  // "# vtk DataFile"
};
[[nodiscard]] VtkFileClass vtk_class_of(std::span<const std::byte> bytes);
/// Returns true if the first bytes are those of VTK XML of one of these types, or of its pieces.
[[nodiscard]] bool is_vtk_xml_or_pieces(std::span<const std::byte> bytes, std::string_view type);

/// File that another one names.
struct VtkMember {
  std::string file, name;  // path as written; name for users, which may be empty
  std::string extent{};    // of a piece of a grid
  double time = 0;
};

/// Array that a file of pieces declares.
struct VtkDeclaredArray {
  VtkSection section = VtkSection::point_data;
  std::string name, type;
  std::uint64_t components = 1;
};

/// Content of a file that names others.
struct VtkIndex {
  VtkFileClass kind = VtkFileClass::other;
  std::string type;  // of the pieces, without P
  std::vector<VtkMember> members;
  std::vector<VtkDeclaredArray> arrays;
  std::string point_scalars, cell_scalars;  // active arrays
  std::string whole_extent, origin, spacing, direction;
};
/// Reads such a file. Returns a message on failure. Safe for untrusted bytes.
[[nodiscard]] std::variant<VtkIndex, std::string> read_vtk_index(std::span<const std::byte> bytes);

}  // namespace gs::app
