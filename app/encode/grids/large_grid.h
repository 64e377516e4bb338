#pragma once

#include "app/encode/grids/grid_array.h"
#include "app/formats/datasets/vtk/vtk_datasets.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace gs::app {

/// Unstructured grid of VTK XML files that exceeds memory.
struct LargeGrid {
  /// Piece of a file.
  struct Part {
    std::size_t file = 0, piece = 0;  // in files.files; in the header of the file
    std::uint64_t points = 0, cells = 0;
  };
  /// Consecutive cells of a part, which one process reads.
  struct Run {
    std::uint32_t part = 0, cells = 0;
    std::uint64_t first = 0;  // number of the first cell in the part
  };
  static constexpr std::uint64_t kRunCells = std::uint64_t{1} << 16;

  /// File on disk. Another program may change it while parts are read.
  struct File {
    std::string path;
    std::filesystem::file_time_type changed{};  // time of its last change when the grid was opened
  };

  VtkPartFiles files;           // with the array to show
  std::vector<File> on_disk{};  // one for each of files.files
  VoxelComponent choice;
  std::vector<Part> parts;
  std::vector<Run> runs;

  /// Reports whether another program changed a file since the grid was opened.
  [[nodiscard]] bool is_changed(std::size_t file) const;
  /// Returns an error text. Names the file unless it is the first one, which callers name.
  [[nodiscard]] std::string message(std::size_t file, const std::string& text) const;
};

/// Error text for a file that another program changed.
inline constexpr const char* kChangedGridFile = "another program changed the file; encode it again";

/// Opens an unstructured grid if an importer would need more than `memory` bytes for its surface. Reads only headers.
/// Returns nullopt for other files, and for choices that need all values at once.
[[nodiscard]] std::optional<LargeGrid> open_large_grid(const VolumeFile& file, std::uint64_t memory);

/// Returns true if the values of an array are colours.
[[nodiscard]] bool stores_colors(const VtkArray& array, const VoxelComponent& choice);
/// Returns the title of the values of an array, for a colour key. Returns an empty title for colours, and for too many
/// components.
[[nodiscard]] std::string title_of_values(const VtkArray& array, const VoxelComponent& choice);

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
  [[nodiscard]] bool positions(std::uint64_t first, std::span<double> to) { return points_->read(3 * first, to); }
  [[nodiscard]] bool values(std::uint64_t first, std::span<double> to);

  [[nodiscard]] bool has_values() const { return values_.has_value(); }
  [[nodiscard]] bool has_colors() const { return colors_; }
  [[nodiscard]] bool of_points() const { return of_points_; }
  /// Returns the count of numbers in a shown value: 1, or 3 for colours.
  [[nodiscard]] std::size_t width() const { return colors_ ? 3 : 1; }
  [[nodiscard]] bool wide() const { return wide_; }
  [[nodiscard]] const LargeGrid::Part& part() const { return part_; }

 private:
  GridPartReader(const LargeGrid& grid, std::size_t part) : grid_(grid), part_(grid.parts[part]) {}
  std::optional<std::string> open_arrays();
  std::optional<std::string> open_array(VtkSection section, std::string_view name, std::uint64_t numbers,
                                        std::optional<GridArray>& to);
  std::optional<std::string> hide(const LargeGrid::Run& run, GridRun& cells);

  const LargeGrid& grid_;
  const LargeGrid::Part& part_;
  std::shared_ptr<const net::RandomAccessFile> file_;
  std::optional<GridArray> points_, types_, ends_, corners_, values_, cell_flags_, point_flags_;
  bool old_flags_ = false;  // cell_flags_ has the ghost levels of older files (vtkGhostLevels)
  bool colors_ = false, of_points_ = false, wide_ = false;
  std::size_t components_ = 1;
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
