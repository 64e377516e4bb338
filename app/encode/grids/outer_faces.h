#pragma once

#include "app/encode/grids/large_grid.h"
#include "qnv/codecs/shared/shared_records.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <variant>
#include <vector>

namespace gs::app {

/// Outer face of a cell.
struct OuterFace {
  static constexpr unsigned kFaceBits = 3;

  std::uint32_t run = 0;
  std::uint32_t place = 0;  // number of the cell in its run, times 8, plus number of the face in the cell
  [[nodiscard]] std::size_t cell() const { return place >> kFaceBits; }
  [[nodiscard]] std::size_t face() const { return place & ((1u << kFaceBits) - 1); }
};

/// Corners of a face, in order around it. Coinciding neighbours count once, so that a face may have fewer than 3.
struct FaceCorners {
  std::array<std::int32_t, 4> corners{};
  std::size_t count = 0;
  [[nodiscard]] std::span<const std::int32_t> list() const { return std::span(corners).first(count); }
};
/// Returns face `face` of a solid cell. Merges coinciding corners: some writers store wedges as hexahedra with them.
[[nodiscard]] FaceCorners face_of(std::span<const std::int32_t> cell, std::size_t type, std::size_t face);

/// Returns the maximum number of corners of a run for a memory limit.
[[nodiscard]] std::size_t most_run_corners(std::uint64_t memory);

/// Returns the outer faces of the solid cells in this rank's runs, sorted by run and place. An outer face belongs to
/// only one cell. Each rank reads its runs, and passes each face through the store to the rank that compares it. Memory
/// is bounded by `memory` bytes, apart from the tables of runs and of stored blocks. Collective.
[[nodiscard]] std::variant<std::vector<OuterFace>, qnv::EncodeError> outer_faces(const LargeGrid& grid,
                                                                                 qnv::EncodeRanks& shared,
                                                                                 std::uint64_t memory,
                                                                                 Progress* progress);

}  // namespace gs::app
