#pragma once

#include "app/insitu/arrays/field_view.h"
#include "app/insitu/arrays/ranks.h"
#include "app/insitu/arrays/step_plan.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace gs::app::insitu {

/// Block of the caller, with views of its arrays.
struct BlockView {
  GridFacts grid;
  std::array<std::int64_t, 6> extent{}, ghost{};
  std::vector<FieldView> fields;
};
/// Checks a block. Returns the problem if it is invalid.
[[nodiscard]] std::variant<BlockView, std::string> block_view(const gs_insitu_block& block);

/// Box of a thinned grid.
struct GridBox {
  std::array<std::uint32_t, 3> first{}, size{};
};

/// Part of a field of a thinned grid, owned by one block. Refers to the caller's array.
struct GridPart {
  GridBox box;
  FieldView field;
  std::array<std::int64_t, 3> start{};  // indices in the array of the first element of the box
  std::uint32_t thinning = 1;

  /// Copies the values of component `c` in the slice `z` of the box to rows that are `pitch` bytes apart.
  void copy_slice(std::uint32_t c, std::uint32_t z, std::byte* to, std::size_t pitch) const;
  /// Copies the values of component 0 in the slice `z` of the box to a contiguous array of floats.
  void copy_floats(std::uint32_t z, float* to) const;
};
/// Returns the parts of one field of a plan, one for each block that owns elements.
[[nodiscard]] std::vector<GridPart> grid_parts(std::span<const BlockView> blocks, const FieldFacts& field,
                                               std::uint32_t thinning);

/// Values of one field of a whole grid, on rank 0. They are a copy, or the parts of the only rank.
struct GridValues {
  FieldFacts field;
  GridFacts grid;
  std::uint32_t thinning = 1;
  std::array<std::uint32_t, 3> size{};
  qnv::VoxelType type = qnv::VoxelType::f32;
  std::vector<std::byte> bytes;  // components one after the other; empty if `parts` are read instead
  std::vector<GridPart> parts;

  /// Copies the slice `z` of component `c`. Elements without data become NaN, or 0 for integers.
  void read(std::uint32_t c, std::uint32_t z, std::span<std::byte> slice) const;
};

/// Collects a field of a grid on rank 0. Collective. Without `copy` and with one rank, the result refers to the arrays.
/// Other ranks get an empty result. If a rank lacks memory, sets `complete` to false on all ranks. Returns false if the
/// communication failed.
[[nodiscard]] bool gather_grid(Ranks& ranks, std::span<const BlockView> blocks, const StepPlan& plan,
                               const FieldFacts& field, bool copy, GridValues& values, bool& complete);

}  // namespace gs::app::insitu
