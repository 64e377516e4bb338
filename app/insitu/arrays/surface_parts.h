#pragma once

#include "app/insitu/arrays/field_view.h"
#include "app/insitu/arrays/ranks.h"
#include "app/insitu/arrays/step_plan.h"
#include "qnv/codecs/shared/encode_options.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace gs::app::insitu {

/// Unstructured cells of the caller, with views of its arrays.
struct CellsView {
  gs_insitu_cells cells{};  // without fields
  std::vector<FieldView> fields;
};
/// Checks cells. Returns the problem if they are invalid.
[[nodiscard]] std::variant<CellsView, std::string> cells_view(const gs_insitu_cells& cells);

/// Triangle of the surface of cells. Positions are relative to StepPlan::origin.
struct SurfaceTriangle {
  std::array<std::array<float, 3>, 3> positions{};
  std::array<float, 3> values{};  // of the corners; NaN without a field
  std::uint32_t of_solid = 0;     // 1 for a face of a solid cell, which a cell of another rank may share
};

/// Surface of all ranks, on rank 0.
struct SurfaceValues {
  FieldFacts field;
  std::array<double, 3> origin{};
  bool too_large = false;  // the triangles exceed the memory limit and are left out
  std::vector<SurfaceTriangle> triangles;
};

/// Extends the bounds of `facts` by the points of cells.
void add_bounds(const CellsView& view, PartFacts& facts);

/// Returns the triangles of faces that belong to only one cell. Leaves out cells of other ranks, of unknown types, or
/// with invalid indices; `left_out` counts the last two. Memory: about 150 bytes per open face. If faces and triangles
/// exceed `most_bytes`, throws std::bad_alloc.
[[nodiscard]] std::vector<SurfaceTriangle> outer_triangles(std::span<const CellsView> parts, const FieldFacts& field,
                                                           const std::array<double, 3>& origin, std::uint64_t& left_out,
                                                           std::uint64_t most_bytes = UINT64_MAX);

/// Collects the surface on rank 0. Removes faces that cells of two ranks share. Collective. Returns false if the
/// communication failed.
[[nodiscard]] bool gather_surface(Ranks& ranks, std::span<const CellsView> parts, const StepPlan& plan,
                                  SurfaceValues& values, std::uint64_t& left_out);

/// Encodes a surface with colours for its values. Errors of positions are at most `relative_error` of the longest side
/// of the box. Returns nullopt on success, else the problem.
[[nodiscard]] std::optional<std::string> encode_surface(const SurfaceValues& surface, double relative_error,
                                                        qnv::EncodeOptions options, std::vector<std::byte>& bytes);

}  // namespace gs::app::insitu
