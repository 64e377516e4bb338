#pragma once

#include "app/encode/grids/grid_numbers.h"
#include "app/formats/common/voxel_component.h"
#include "app/formats/volume/volume_common.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace gs::app {

/// Unstructured grid that exceeds memory, from VTK XML files, VTKHDF or Exodus II.
struct LargeGrid {
  /// Part of the grid with its own arrays.
  struct Part {
    std::uint64_t points = 0, cells = 0;
    std::uint32_t space = 0;  // consecutive parts with equal numbers have the same points
  };
  /// Consecutive cells of a part, which one process reads.
  struct Run {
    std::uint32_t part = 0, cells = 0;
    std::uint64_t first = 0;  // number of the first cell in the part
  };
  static constexpr std::uint64_t kRunCells = std::uint64_t{1} << 16;
  /// Maximum number of runs, and of parts. It limits their lists to 256 MB.
  static constexpr std::uint64_t kMostRuns = std::uint64_t{1} << 22;

  std::uint64_t other_bytes = 0;  // size of all files except the first one
  std::shared_ptr<const GridSource> source;
  VoxelComponent choice;
  bool shows_values = false;
  std::string title;  // of the shown values, for a colour key; empty for colours, and without values
  std::vector<Part> parts;
  std::vector<Run> runs;

  /// Returns the number of points of a part, or 0 if the part before has the same points.
  [[nodiscard]] std::uint64_t own_points(std::size_t part) const;
};

/// Opens an unstructured grid if an importer would need more than `memory` bytes for its surface. Reads only headers.
/// Returns nullopt for other files, and for choices that need all values at once.
[[nodiscard]] std::optional<LargeGrid> open_large_grid(const VolumeFile& file, std::uint64_t memory);

/// Cells of a run. Corners are numbers of points in the part, or kBadIndex.
struct GridRun {
  std::vector<std::uint8_t> types;  // 0 for hidden cells
  std::vector<std::size_t> ends;    // end of each cell in `corners`
  std::vector<std::int32_t> corners;

  [[nodiscard]] std::span<const std::int32_t> cell(std::size_t i) const {
    const std::size_t begin = i == 0 ? 0 : ends[i - 1];
    return std::span(corners).subspan(begin, ends[i] - begin);
  }
};

/// Reader of a part. One thread.
class GridPartReader {
 public:
  /// Opens the arrays of a part. Returns a message on failure.
  [[nodiscard]] static std::variant<std::unique_ptr<GridPartReader>, std::string> open(const LargeGrid& grid,
                                                                                       std::size_t part);

  /// Reads the cells of a run. Returns a message on failure, also if they have more than `most_corners` corners.
  [[nodiscard]] std::variant<GridRun, std::string> cells(const LargeGrid::Run& run, std::size_t most_corners);
  /// Read the positions of consecutive points, and the shown values of consecutive points or cells. A value has width()
  /// numbers. Return false if the file is damaged.
  [[nodiscard]] bool positions(std::uint64_t first, std::span<double> to) {
    return arrays_.points->read(3 * first, to);
  }
  [[nodiscard]] bool values(std::uint64_t first, std::span<double> to);

  [[nodiscard]] bool has_values() const { return arrays_.values != nullptr; }
  [[nodiscard]] bool has_colors() const { return arrays_.colors; }
  [[nodiscard]] bool of_points() const { return arrays_.of_points; }
  /// Returns the count of numbers in a shown value: 1, or 3 for colours.
  [[nodiscard]] std::size_t width() const { return arrays_.colors ? 3 : 1; }
  [[nodiscard]] bool wide() const { return arrays_.wide; }
  [[nodiscard]] const LargeGrid::Part& part() const { return part_; }

 private:
  GridPartReader(const LargeGrid& grid, std::size_t part, GridPartArrays arrays)
      : grid_(grid), part_(grid.parts[part]), arrays_(std::move(arrays)) {}
  std::optional<std::string> read_ends(const LargeGrid::Run& run, std::size_t most_corners, double& first,
                                       GridRun& cells);
  std::optional<std::string> hide(const LargeGrid::Run& run, GridRun& cells);

  const LargeGrid& grid_;
  const LargeGrid::Part& part_;
  GridPartArrays arrays_;
};

/// Reader of the parts of a grid, which keeps the last part open. One thread.
class LargeGridReader {
 public:
  explicit LargeGridReader(const LargeGrid& grid) : grid_(grid) {}
  /// Returns the reader of a part, or a message.
  [[nodiscard]] std::variant<GridPartReader*, std::string> part(std::size_t number);

 private:
  const LargeGrid& grid_;
  std::size_t number_ = 0;
  std::unique_ptr<GridPartReader> open_;
};

}  // namespace gs::app
