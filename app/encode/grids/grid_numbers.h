#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <variant>

namespace gs::app {

/// Array of numbers in a grid that is read in parts, such as the coordinates of a part. One thread.
class GridNumbers {
 public:
  virtual ~GridNumbers() = default;
  /// Reads consecutive numbers. Returns false if the file is damaged.
  [[nodiscard]] virtual bool read(std::uint64_t first, std::span<double> to) = 0;
  /// Returns the count of numbers that may be read.
  [[nodiscard]] virtual std::uint64_t size() const = 0;
};

/// Arrays of a part of a grid. Null pointers stand for arrays that the file lacks.
struct GridPartArrays {
  std::unique_ptr<GridNumbers> points, corners;
  std::unique_ptr<GridNumbers> types, ends;  // null if all cells have the type `element` and `element_corners` corners
  std::unique_ptr<GridNumbers> values;
  std::unique_ptr<GridNumbers> cell_flags, point_flags;
  std::uint8_t element = 0;
  std::size_t element_corners = 0;
  std::size_t components = 1;    // of a value
  bool of_points = false;        // the values belong to points
  bool colors = false;           // the values are colours
  bool wide = false;             // the coordinates have double precision
  bool old_flags = false;        // cell_flags has the ghost levels of older files (vtkGhostLevels)
  bool omits_polyhedra = false;  // polyhedra count as unsupported, as in the importer of the format
};

/// Error text for a file that another program changed.
inline constexpr const char* kChangedGridFile = "another program changed the file; encode it again";

/// File on disk. Another program may change it while parts are read.
struct GridFile {
  std::string path;
  std::uint64_t size = 0;                        // of the opened file
  std::filesystem::file_time_type changed_at{};  // time of the last change when the grid was opened

  /// Finds a file of a grid. `name` is absolute, relative to the folder of the file `grid`, or empty for `grid` itself.
  /// If no file has the exact name, ignores upper and lower case, as the readers of headers do.
  [[nodiscard]] static GridFile find(const std::string& grid, const std::string& name, std::uint64_t size);
  [[nodiscard]] bool is_changed() const;
  /// Returns the size and the time of the last change, as a text.
  [[nodiscard]] std::string state() const;
};

/// File or files of a grid.
class GridSource {
 public:
  virtual ~GridSource() = default;
  /// Opens the arrays of a part. On failure, returns a message for message(), without the path.
  [[nodiscard]] virtual std::variant<GridPartArrays, std::string> open(std::size_t part) const = 0;
  /// Reports whether another program changed the file of a part since the grid was opened.
  [[nodiscard]] virtual bool is_changed(std::size_t part) const = 0;
  /// Returns a text that differs if a file of the grid differs. For results that an earlier run of the program stored.
  [[nodiscard]] virtual std::string state() const = 0;
  /// Returns an error text that begins with the file of the part. Omits the first file, because callers name it.
  [[nodiscard]] virtual std::string message(std::size_t part, const std::string& text) const = 0;
};

}  // namespace gs::app
