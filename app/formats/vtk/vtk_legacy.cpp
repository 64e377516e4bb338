#include "app/formats/vtk/vtk_legacy.h"

#include "app/formats/common/content_type.h"
#include "app/formats/common/text_cursor.h"
#include "app/formats/volume/vtk_xml.h"
#include "app/formats/vtk/bookkeeping.h"
#include "app/formats/vtk/grid_cells.h"
#include "app/formats/vtk/poly_data.h"
#include "base/text.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace gs::app {
namespace {

constexpr std::string_view kLegacyMark = "# vtk DataFile Version";
constexpr double kMaxLegacy = 2e9;  // max number of points, cells or array values

std::optional<StoredType> legacy_type_of(std::string_view name) {
  static constexpr std::pair<std::string_view, StoredType> kNames[] = {
      {"unsigned_char", StoredType::u8}, {"char", StoredType::i8},
      {"signed_char", StoredType::i8},   {"unsigned_short", StoredType::u16},
      {"short", StoredType::i16},        {"unsigned_int", StoredType::u32},
      {"int", StoredType::i32},          {"unsigned_long", StoredType::u64},
      {"long", StoredType::i64},         {"vtktypeuint64", StoredType::u64},
      {"vtktypeint64", StoredType::i64}, {"vtkidtype", StoredType::i32},
      {"float", StoredType::f32},        {"double", StoredType::f64}};
  for (const auto& [type_name, type] : kNames)
    if (type_name == name) return type;
  return std::nullopt;
}

class LegacyImporter {
 public:
  LegacyImporter(std::span<const std::byte> bytes, MeshBuilder& builder)
      : cursor_(bytes), lines_(cursor_.next), builder_(builder) {}

  /// Returns an empty surface if the file has no points. `failed` tells that a message was given: the file is of another
  /// kind, or the user chose a missing array. `lists` notes the arrays for the user.
  PolyData run(bool lists, bool& failed) {
    failed = !read_head();
    if (failed) return {};
    while (problem_.empty() && next_line()) part();
    if (!problem_.empty()) builder_.fail(problem_, place());
    if (data_.points.empty()) return {};
    failed = lists && !note_arrays();
    if (failed) return {};
    if (grid_.cells.ends.empty()) {
      remove_hidden_cells(ghost_cells_, ghost_points_, data_);
    } else {
      hide_cells(ghost_cells_, ghost_points_, grid_);
      add_grid(grid_, data_, builder_);
    }
    return std::move(data_);
  }

 private:
  bool read_head() {
    (void)cursor_.line();
    (void)cursor_.line();  // skip the title
    const std::string format = lower_case(std::string(trimmed(cursor_.line())));
    binary_ = format == "binary";
    if (!binary_ && format != "ascii") {
      builder_.fail("expected ASCII or BINARY", {3, 1});
      return false;
    }
    if (!next_line() || word() != "dataset") {
      builder_.fail("expected DATASET POLYDATA or UNSTRUCTURED_GRID", place());
      return false;
    }
    const std::string dataset = word();
    if (dataset == "polydata" || dataset == "unstructured_grid") return true;
    builder_.fail("the DATASET is " + dataset.substr(0, 80) + "; expected POLYDATA or UNSTRUCTURED_GRID", place());
    return false;
  }
  // Notes the arrays and the one that is shown. Reports a wrong choice and returns false.
  bool note_arrays() {
    if (cells_rank_ == chosen && points_rank_ != chosen) data_.of_points = {};
    const bool by_cell = data_.of_points.empty() && !data_.of_cells.empty();
    const Shown shown = shown_[by_cell ? 1 : 0];
    if (!choose_surface_entry(
            std::move(entries_), builder_, [](std::size_t) {}, shown.path))
      return false;
    if (builder_.choice().found) builder_.choice().found->components = shown.components;
    return true;
  }

  [[nodiscard]] SourceLocation place() { return lines_.location(cursor_.next); }

  // Moves to the next non-empty line. Returns false at the end of the file.
  bool next_line() {
    while (!cursor_.at_end()) {
      line_ = trimmed(cursor_.line());
      if (!line_.empty()) return true;
    }
    return false;
  }
  // Reads the next word of the line, in its original case. Returns an empty string at the end of the line. `word`
  // returns lower case.
  std::string name() {
    const std::size_t end = std::min(line_.find_first_of(" \t"), line_.size());
    const std::string found(line_.substr(0, std::min<std::size_t>(end, 200)));
    line_ = trimmed(line_.substr(end));
    return found;
  }
  std::string word() { return lower_case(name()); }
  // Reads an integer from the line. If there is none, sets `problem_` and returns nullopt.
  std::optional<std::uint64_t> count() {
    const std::string text = name();
    TextCursor number(text.data(), text.data() + text.size());
    double value = 0;
    if (number.number(value) && value >= 0 && value <= kMaxLegacy) return static_cast<std::uint64_t>(value);
    problem_ = "expected a whole number from 0 to 2 000 000 000";
    return std::nullopt;
  }

  // Reads `count` numbers from the file and passes each to `take`. If some are missing, sets `problem_` and returns
  // false.
  template <class Take>
  bool numbers(const std::string& type_name, std::uint64_t count, Take take) {
    const auto type = legacy_type_of(type_name);
    if (!type) {
      problem_ = "the type is '" + type_name.substr(0, 80) + "'; expected char to double";
      return false;
    }
    if (!binary_) {
      for (std::uint64_t i = 0; i < count; ++i) {
        if (i % kBetweenStops == 0) builder_.draw(0);
        double value = 0;
        if (!cursor_.skip_space() || !cursor_.number(value)) return ends(i, count);
        take(value);
      }
      return true;
    }
    const std::uint64_t there = static_cast<std::uint64_t>(cursor_.end - cursor_.next) / size_of(*type);
    StoredVoxels values;
    values.content.bytes = std::as_bytes(std::span(cursor_.next, static_cast<std::size_t>(cursor_.end - cursor_.next)));
    values.type = *type;
    values.big_endian = true;
    const std::uint64_t read = std::min(there, count);
    each_number(values, read, take);
    cursor_.next += read * size_of(*type);
    return read == count || ends(read, count);
  }
  bool ends(std::uint64_t read, std::uint64_t count) {
    problem_ = "there are " + std::to_string(read) + " numbers, or other content; expected " + std::to_string(count);
    return false;
  }
  // Charges memory for `count` items of `each` bytes. Counts at most one item per remaining byte of the file.
  void draw_for(std::uint64_t count, std::uint64_t each) {
    const auto left = static_cast<std::uint64_t>(cursor_.end - cursor_.next);
    builder_.draw(std::min(count, left) * each);
  }

  void part() {
    static constexpr std::pair<std::string_view, PolyData::Kind> kKinds[] = {{"vertices", PolyData::vertices},
                                                                             {"lines", PolyData::lines},
                                                                             {"polygons", PolyData::polygons},
                                                                             {"triangle_strips", PolyData::strips}};
    const std::string keyword = word();
    for (const auto& [name, kind] : kKinds)
      if (keyword == name) return cells(data_.cells[kind]);
    if (keyword == "cells") return cells(grid_.cells);
    if (keyword == "cell_types") return cell_types();
    if (keyword == "points") return points();
    if (keyword == "metadata") return metadata();
    if (keyword == "point_data" || keyword == "cell_data") {
      of_points_ = keyword == "point_data";
      if (const auto found = count()) rows_ = *found;
      return;
    }
    if (keyword == "field") return field();
    if (!rows_) {
      problem_ = "'" + keyword.substr(0, 80) + "' found; expected POINTS, POLYGONS, POINT_DATA or similar";
      return;
    }
    attribute(keyword);
  }

  void points() {
    const auto found = count();
    if (!found) return;
    draw_for(*found, sizeof(glm::vec3));
    (void)vectors(word(), *found, data_.points);
  }
  bool vectors(const std::string& type, std::uint64_t count, std::vector<glm::vec3>& to) {
    glm::vec3 vector(0);
    int axis = 0;
    return numbers(type, count * 3, [&](double value) {
      vector[axis] = static_cast<float>(value);
      if (++axis < 3) return;
      to.push_back(vector);
      axis = 0;
    });
  }

  // Reads the corners of cells. Up to version 5.0, "POLYGONS cells numbers" precedes the cells, each with its number of
  // corners. From version 5.1 on, "POLYGONS offsets corners" precedes OFFSETS (from 0) and CONNECTIVITY.
  void cells(PolyCells& cells) {
    const auto rows = count(), all = rows ? count() : std::nullopt;
    if (!all) return;
    const auto corner_of = [](double corner) {
      return corner >= 0 && corner < static_cast<double>(kBadIndex) ? static_cast<std::int32_t>(corner) : kBadIndex;
    };
    draw_for(*all, sizeof(std::int32_t) + sizeof(std::size_t));
    const std::size_t first = cells.corners.size();
    const TextCursor before = cursor_;
    if (next_line() && word() == "offsets") {
      std::vector<std::size_t> ends;
      bool rising = true;
      const std::string type = word();
      const bool whole = numbers(type, *rows, [&](double end) {
        rising =
            rising && end >= (ends.empty() ? 0 : static_cast<double>(ends.back())) && end <= static_cast<double>(*all);
        if (rising) ends.push_back(static_cast<std::size_t>(end));
      });
      if (!whole) return;
      if (!rising || !next_line() || word() != "connectivity") {
        problem_ = "expected ascending OFFSETS, and CONNECTIVITY";
        return;
      }
      (void)numbers(word(), *all, [&](double corner) { cells.corners.push_back(corner_of(corner)); });
      // This section may occur twice. Append to the existing cells.
      for (std::size_t i = 1; i < ends.size() && ends[i] <= cells.corners.size() - first; ++i)
        cells.ends.push_back(first + ends[i]);
      cells.corners.resize(cells.ends.empty() ? 0 : cells.ends.back());
      return;
    }
    cursor_ = before;
    std::uint64_t left = 0;  // number of corners of the current cell still to read
    bool in_cell = false;
    (void)numbers("int", *all, [&](double value) {
      if (!in_cell) {
        left = value >= 0 && value <= kMaxLegacy ? static_cast<std::uint64_t>(value) : 0;
        in_cell = true;
      } else {
        cells.corners.push_back(corner_of(value));
        --left;
      }
      if (left > 0) return;
      cells.ends.push_back(cells.corners.size());
      in_cell = false;
    });
    // Drop the last cell if it is incomplete.
    cells.corners.resize(cells.ends.empty() ? 0 : cells.ends.back());
  }

  void cell_types() {
    const auto found = count();
    if (!found) return;
    draw_for(*found, 1);
    (void)numbers("int", *found, [&](double type) {
      grid_.types.push_back(type >= 0 && type < 256 ? static_cast<std::uint8_t>(type) : std::uint8_t{255});
    });
  }

  void metadata() {
    while (!cursor_.at_end() && !trimmed(cursor_.line()).empty()) {
    }
  }

  // Priority of point or cell data for display. The data with the lowest value are shown.
  enum Rank : int { chosen, scalars, one_number, several, nothing };

  void attribute(const std::string& keyword) {
    const std::string title = name();
    if (keyword == "scalars") {
      const std::string type = word();
      std::uint64_t components = 1;
      if (!line_.empty()) components = count().value_or(0);
      const TextCursor before = cursor_;
      if (!next_line() || word() != "lookup_table") cursor_ = before;
      return values(title, type, components, scalars, false);
    }
    if (keyword == "color_scalars") {
      const auto components = count();
      if (components) values(title, binary_ ? "unsigned_char" : "float", *components, scalars, true);
      return;
    }
    if (keyword == "lookup_table") {
      const auto size = count();
      if (size) (void)numbers(binary_ ? "unsigned_char" : "float", *size * 4, [](double) {});
      return;
    }
    if (keyword == "normals" && of_points_) {
      draw_for(*rows_, sizeof(glm::vec3));
      (void)vectors(word(), *rows_, data_.normals);
      return;
    }
    if (keyword == "vectors" || keyword == "normals" || keyword == "global_ids" || keyword == "pedigree_ids") {
      const bool ids = keyword.ends_with("ids");
      return values(title, word(), ids ? 1 : 3, keyword == "vectors" ? several : nothing, false);
    }
    if (keyword == "tensors" || keyword == "tensors6")
      return values(title, word(), keyword == "tensors" ? 9 : 6, nothing, false);
    if (keyword == "texture_coordinates") {
      const auto components = count();
      if (components) values(title, word(), *components, nothing, false);
      return;
    }
    problem_ = "'" + keyword.substr(0, 80) + "' found; expected SCALARS, VECTORS, NORMALS, FIELD or similar";
  }

  void field() {
    (void)name();
    const auto arrays = count();
    for (std::uint64_t i = 0; arrays && i < *arrays && problem_.empty(); ++i) {
      if (!next_line()) return void(ends(i, *arrays));
      if (lower_case(std::string(line_)).starts_with("metadata")) {
        metadata();
        if (!next_line()) return void(ends(i, *arrays));
      }
      const std::string title = name();
      const auto components = count(), rows = components ? count() : std::nullopt;
      if (!rows) return;
      const bool shown = rows_ && *rows == *rows_ && *components > 0;
      if (shown)
        values(title, word(), *components, *components == 1 ? one_number : several, false);
      else
        (void)numbers(word(), *components * *rows, [](double) {});
    }
  }

  // Reports whether the user chose this array, by "PointData/NAME" or a part of its end.
  [[nodiscard]] bool is_chosen(const std::string& name) const {
    const std::string& wanted = builder_.choice().dataset;
    const std::string path = entry_path(of_points_, name);
    return !wanted.empty() && (path == wanted || path.ends_with((wanted.front() == '/' ? "" : "/") + wanted));
  }

  void values(const std::string& title, const std::string& type, std::uint64_t components, Rank rank, bool colors) {
    entries_.push_back(surface_entry(of_points_, title, *rows_, components, type, {}));
    if (is_bookkeeping(title)) rank = nothing;
    if (is_chosen(title)) rank = chosen;
    if (rank == chosen && builder_.choice().chosen) colors = false;
    constexpr std::uint64_t kMaxComponents = 64;
    if (components == 0 || components > kMaxComponents) {
      problem_ = std::to_string(components) + " components; expected 1 to " + std::to_string(kMaxComponents);
      return;
    }
    if (title == kGhostArray && components == 1) return flags(type);
    Rank& shown = of_points_ ? points_rank_ : cells_rank_;
    const bool better = rank < shown;
    PolyData::Data data;
    data.title = title.substr(0, 80) + (colors ? "" : part_text(components, builder_.choice()));
    if (better) draw_for(*rows_, colors ? sizeof(vrml::Color) : sizeof(float));
    std::array<double, kMaxComponents> parts{};
    std::size_t part = 0;
    const double most = binary_ ? 255 : 1;
    const bool whole = numbers(type, *rows_ * components, [&](double value) {
      parts[part] = value;
      if (++part < components) return;
      part = 0;
      if (!better) return;
      if (colors) {
        const auto share = [&](std::size_t i) {
          return std::clamp(static_cast<float>(parts[components > 2 ? i : 0] / most), 0.0f, 1.0f);
        };
        data.colors.push_back({share(0), share(1), share(2)});
        return;
      }
      append_number(std::span(parts).first(components), builder_.choice(), data);
    });
    if (!better || (!whole && data.empty())) return;
    shown = rank;
    shown_[of_points_ ? 0 : 1] = {entry_path(of_points_, title), components};
    (of_points_ ? data_.of_points : data_.of_cells) = std::move(data);
  }

  /// Reads the flags of hidden points or cells.
  void flags(const std::string& type) {
    draw_for(*rows_, 1);
    GhostFlags& all = of_points_ ? ghost_points_ : ghost_cells_;
    all.clear();
    (void)numbers(type, *rows_, [&](double value) {
      all.push_back(value > 0 && value < 256 ? static_cast<std::uint8_t>(value) : std::uint8_t{0});
    });
  }

  static constexpr std::uint64_t kBetweenStops = std::uint64_t{1} << 17;

  TextCursor cursor_;
  LineCounter lines_;
  MeshBuilder& builder_;
  std::string_view line_;  // rest of the current line
  bool binary_ = false, of_points_ = true;
  std::optional<std::uint64_t> rows_;  // number of rows of point or cell data; nullopt before such a section
  Rank points_rank_ = nothing, cells_rank_ = nothing;
  /// Array that is shown: its path in the list, and its numbers per row.
  struct Shown {
    std::string path;
    std::uint64_t components = 1;
  };
  std::array<Shown, 2> shown_{};  // of points, of cells
  std::vector<DatasetEntry> entries_;
  PolyData data_;
  GridCells grid_;
  GhostFlags ghost_points_, ghost_cells_;
  std::string problem_;
};

bool is_vtk_legacy(std::span<const std::byte> bytes) { return text_of(bytes).starts_with(kLegacyMark); }

/// Imports a legacy VTK file (.vtk, versions 1 to 5.1, text or binary). Reads the vertices, lines, polygons and strips
/// of DATASET POLYDATA, or the visible faces of an UNSTRUCTURED_GRID (grid_cells.h). Rejects other datasets with a
/// message. The first point SCALARS become colours (poly_data.h); else a one-component field, else vector lengths; else
/// the same of cells. COLOR_SCALARS are colours; NORMALS are kept. A truncated file gives an error and its complete
/// part. Layout: "VTK File Formats", Simple Legacy Formats (VTK User's Guide).
void import_vtk_legacy(std::span<const std::byte> bytes, MeshBuilder& builder) {
  if (!is_vtk_legacy(bytes)) return builder.fail("expected '" + std::string(kLegacyMark) + "'", {1, 1});
  bool failed = false;
  PolyData data = LegacyImporter(bytes, builder).run(true, failed);
  if (data.points.empty()) return failed ? void() : builder.warn("no points in the file");
  build_poly_data(std::move(data), builder);
}

}  // namespace

PolyData read_vtk_legacy(std::span<const std::byte> bytes, MeshBuilder& builder) {
  bool failed = false;
  return LegacyImporter(bytes, builder).run(false, failed);
}

extern constinit const ContentType kVtkLegacyFormat = mesh_type(
    "legacy VTK", "application/x-vtk", ".vtk ", is_vtk_legacy, read_mesh<import_vtk_legacy>, {.mark = kLegacyMark});

}  // namespace gs::app
