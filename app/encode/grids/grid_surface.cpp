#include "app/encode/grids/grid_surface.h"

#include "app/encode/grids/outer_faces.h"
#include "app/encode/surface_corners.h"
#include "app/formats/vtk/cell_shapes.h"
#include "app/formats/vtk/grid_cells.h"
#include "base/finite.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <string>
#include <utility>

namespace gs::app {
namespace {

using qnv::EncodeError;

// Maximum number of points or values to read together.
constexpr std::uint64_t kTogether = std::uint64_t{1} << 16;
// Colours of cells without values if other cells have values, and if no cell has values. Importers use them, too.
const qnv::Rgb8 kWithoutValues{128, 128, 128}, kPlain{204, 204, 204};

/// Triangle in the store.
struct StoredTriangle {
  std::array<float, 9> places{};
  std::array<std::uint8_t, 12> colors{};  // the last three bytes are 0
};

/// Triangles of a run of cells in the store.
struct StoredTriangles {
  std::uint64_t offset = 0, count = 0;
};

/// Numbers of cells that a surface cannot show.
struct OmittedCells {
  std::uint64_t lines = 0;     // lines and vertices
  std::uint64_t unknown = 0;   // of unsupported types
  std::uint64_t short_of = 0;  // without all of their corners

  void add(const OmittedCells& other) {
    lines += other.lines;
    unknown += other.unknown;
    short_of += other.short_of;
  }
  /// Returns a warning that lists the numbers above 0. Returns an empty text if all are 0.
  [[nodiscard]] std::string text() const {
    std::string text;
    const auto name = [&](std::uint64_t count, const char* what) {
      if (count > 0) text += (text.empty() ? "" : ", ") + std::to_string(count) + what;
    };
    name(lines, " lines and vertices");
    name(unknown, " cells of unsupported types");
    name(short_of, " cells without all of their corners");
    return text.empty() ? text : text + " are left out; the surface has the faces of the other cells";
  }
};

/// Result of a LargeGrid::Run, recorded for --resume.
struct FinishedRun {
  StoredTriangles triangles;
  Box box;
  OmittedCells omitted;
};

/// Returns the bytes as a record. Returns nullopt if they have another size.
template <class Record>
std::optional<Record> finished_record(const std::optional<std::vector<std::byte>>& bytes) {
  static_assert(std::is_trivially_copyable_v<Record>);
  if (!bytes || bytes->size() != sizeof(Record)) return std::nullopt;
  Record record;
  std::memcpy(static_cast<void*>(&record), bytes->data(), sizeof record);
  return record;
}

/// Ranges of the shown values and of wide coordinates.
struct GridRanges {
  float low = std::numeric_limits<float>::infinity(), high = -std::numeric_limits<float>::infinity();
  WideBox box;

  void add(const GridRanges& other) {
    low = std::min(low, other.low);
    high = std::max(high, other.high);
    box.add(other.box);
  }
};

/// Triangles of the cells of one run.
class RunTriangles {
 public:
  RunTriangles(GridPartReader& part, const LargeGrid::Run& run, const GridRun& cells,
               const std::optional<ColorKey>& key, bool shows, const glm::dvec3& origin)
      : part_(part), run_(run), cells_(cells), key_(key), shows_(shows), origin_(origin) {}

  /// Adds a polygon.
  void add(std::span<const std::int32_t> corners, std::size_t cell) {
    if (corners.size() < 3) return;
    corners_.insert(corners_.end(), corners.begin(), corners.end());
    polygons_.push_back({corners_.size(), cell});
  }

  /// Adds the polygons and strips. Counts the cells that the surface cannot show.
  void add_flat() {
    for (std::size_t i = 0; i < cells_.types.size(); ++i) {
      const GridShape shape = grid_shape(cells_.types[i]);
      auto corners = cells_.cell(i);
      const bool hidden = cells_.types[i] == 0;
      if (shape.as == GridShape::As::nothing)
        omitted.unknown += hidden ? 0 : 1;
      else if (corners.size() < shape.corners)
        ++omitted.short_of;
      else if (shape.as == GridShape::As::line || shape.as == GridShape::As::vertices)
        ++omitted.lines;
      if (corners.size() < shape.corners) continue;
      if (!shape.any_number) corners = corners.first(shape.corners);
      if (shape.as == GridShape::As::polygon) {
        add(corners, i);
      } else if (shape.as == GridShape::As::pixel) {
        add(std::array{corners[0], corners[1], corners[3], corners[2]}, i);
      } else if (shape.as == GridShape::As::strip) {
        for (std::size_t k = 2; k < corners.size(); ++k)
          add(std::array{corners[k % 2 == 1 ? k - 1 : k - 2], corners[k % 2 == 1 ? k - 2 : k - 1], corners[k]}, i);
      }
    }
  }

  /// Triangulates all polygons as fans. Skips polygons with missing or non-finite corners. Returns false if the file is
  /// damaged.
  bool make() {
    if (!read_points()) return false;
    std::size_t begin = 0;
    for (const Polygon& polygon : polygons_) {
      if (!make(std::span(corners_).subspan(begin, polygon.end - begin), polygon.cell)) return false;
      begin = polygon.end;
    }
    return true;
  }

  std::vector<StoredTriangle> triangles;
  Box box;
  OmittedCells omitted;

 private:
  struct Polygon {
    std::size_t end = 0, cell = 0;  // end in `corners_`
  };
  /// Point of the polygons.
  struct Point {
    glm::vec3 place{0};
    qnv::Rgb8 color;
  };

  [[nodiscard]] bool by_cell() const { return part_.has_values() && !part_.of_points(); }

  /// Reads the points of all polygons in ascending order. So a run unpacks each block of a compressed array only once,
  /// in whatever order its cells use the points.
  bool read_points() {
    numbers_ = corners_;
    std::erase(numbers_, kBadIndex);
    std::ranges::sort(numbers_);
    numbers_.erase(std::unique(numbers_.begin(), numbers_.end()), numbers_.end());
    points_.resize(numbers_.size());
    for (std::size_t i = 0; i < numbers_.size(); ++i) {
      std::array<double, 3> place{};
      if (!part_.positions(static_cast<std::uint64_t>(numbers_[i]), place)) return false;
      points_[i].place = glm::vec3(glm::dvec3(place[0], place[1], place[2]) - origin_);
      points_[i].color = shows_ ? kWithoutValues : kPlain;
    }
    if (by_cell() || !part_.has_values()) return true;
    for (std::size_t i = 0; i < numbers_.size(); ++i)
      if (!color_of(static_cast<std::uint64_t>(numbers_[i]), points_[i].color)) return false;
    return true;
  }

  bool make(std::span<const std::int32_t> corners, std::size_t cell) {
    qnv::Rgb8 color = shows_ ? kWithoutValues : kPlain;
    if (by_cell() && !color_of(run_.first + cell, color)) return false;
    fan_.clear();
    for (const std::int32_t corner : corners) {
      if (corner == kBadIndex) return true;
      const auto found = std::ranges::lower_bound(numbers_, corner);
      fan_.push_back(points_[static_cast<std::size_t>(found - numbers_.begin())]);
      if (!finite(fan_.back().place)) return true;
      if (by_cell()) fan_.back().color = color;
    }
    for (std::size_t k = 2; k < fan_.size(); ++k) {
      StoredTriangle& made = triangles.emplace_back();
      const std::array<std::size_t, 3> from{0, k - 1, k};
      for (std::size_t i = 0; i < 3; ++i) {
        const auto& [p, c] = fan_[from[i]];
        std::copy_n(&p.x, 3, made.places.begin() + static_cast<std::ptrdiff_t>(3 * i));
        made.colors[3 * i] = c.r;
        made.colors[3 * i + 1] = c.g;
        made.colors[3 * i + 2] = c.b;
        box.add(p);
      }
    }
    return true;
  }

  bool color_of(std::uint64_t row, qnv::Rgb8& color) {
    std::array<double, 3> value{};
    if (!part_.values(row, std::span(value).first(part_.width()))) return false;
    if (part_.has_colors()) {
      const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(std::clamp(value[i], 0.0, 255.0)); };
      color = {byte(0), byte(1), byte(2)};
    } else if (key_) {
      const vrml::Color c = key_->color_of(static_cast<double>(static_cast<float>(value[0])));
      color = to_rgb8({c.r, c.g, c.b});
    }
    return true;
  }

  GridPartReader& part_;
  const LargeGrid::Run& run_;
  const GridRun& cells_;
  const std::optional<ColorKey>& key_;
  bool shows_;  // the surface shows an array
  glm::dvec3 origin_;
  std::vector<std::int32_t> corners_;  // of all polygons
  std::vector<Polygon> polygons_;
  std::vector<std::int32_t> numbers_;  // of the points, ascending
  std::vector<Point> points_;          // one for each of `numbers_`
  std::vector<Point> fan_;             // corners of one polygon
};

/// Maker of the surface of one grid.
class GridSurfaceMaker {
 public:
  GridSurfaceMaker(const LargeGrid& grid, qnv::EncodeRanks& shared, std::uint64_t memory, Progress* progress)
      : grid_(grid),
        shared_(shared),
        memory_(memory),
        progress_(progress),
        reader_(grid),
        own_(qnv::share_of(shared.ranks(), grid.runs.size())) {}

  std::variant<MeshStream, EncodeError> make() {
    begin_stage("reading", 3);
    if (auto failed = find_ranges()) return std::move(*failed);
    make_key();
    if (!restore_runs()) {
      auto found = outer_faces(grid_, shared_, memory_, progress_);
      if (auto* const failed = std::get_if<EncodeError>(&found)) return std::move(*failed);
      if (auto failed = shared_.agree(store_triangles(std::get<std::vector<OuterFace>>(found))))
        return std::move(*failed);
    }
    return stream();
  }

 private:
  [[nodiscard]] static std::string name_of(std::uint64_t run) { return "triangles " + std::to_string(run); }

  /// Finds the triangles that --resume has for this rank's runs. If all ranks find all of theirs, takes them. Returns
  /// true in this case. Collective.
  bool restore_runs() {
    bool whole = true;
    for (std::uint64_t run = own_.first; run < own_.end; ++run) {
      finished_.push_back(finished_record<FinishedRun>(shared_.store().finished(name_of(run))));
      whole = whole && finished_.back();
    }
    const std::byte own{whole ? std::uint8_t{0} : std::uint8_t{1}};
    const std::vector<std::byte> missing = shared_.ranks().gather(std::span(&own, 1));
    if (std::ranges::count(missing, std::byte{1}) > 0) return false;
    for (const std::optional<FinishedRun>& run : finished_) take(*run);
    return true;
  }
  void take(const FinishedRun& run) {
    stored_.push_back(run.triangles);
    box_.add(run.box);
    omitted_.add(run.omitted);
  }

  void begin_stage(const char* stage, std::uint64_t passes) {
    if (!progress_) return;
    progress_->stage = stage;
    progress_->done = 0;
    progress_->total = 0;
    for (const LargeGrid::Run& run : grid_.runs) progress_->total += run.cells * passes / shared_.count();
  }

  /// Finds the ranges of values and coordinates in this rank's share of the points and cells.
  std::optional<EncodeError> survey() {
    // An element of `work` is a part, and the first of kTogether points and cells.
    std::vector<std::pair<std::uint32_t, std::uint64_t>> work;
    for (std::uint32_t part = 0; part < grid_.parts.size(); ++part) {
      const std::uint64_t most = std::max(grid_.own_points(part), grid_.parts[part].cells);
      for (std::uint64_t first = 0; first < most; first += kTogether) work.emplace_back(part, first);
    }
    const qnv::RankShare own = qnv::share_of(shared_.ranks(), work.size());
    for (std::uint64_t i = own.first; i < own.end; ++i) {
      if (is_cancelled(progress_)) return EncodeError{"cancelled"};
      const auto [number, first] = work[static_cast<std::size_t>(i)];
      const auto opened = reader_.part(number);
      if (const auto* const problem = std::get_if<std::string>(&opened)) return EncodeError{*problem};
      if (!survey_rows(*std::get<GridPartReader*>(opened), first, grid_.own_points(number) > 0))
        return EncodeError{grid_.source->message(number, "the arrays are damaged")};
      if (progress_) progress_->done += kTogether;
    }
    return std::nullopt;
  }

  /// Finds the ranges of at most kTogether points and cells. Omits points that the previous part already counted.
  bool survey_rows(GridPartReader& part, std::uint64_t first, bool has_own_points) {
    const auto rows_from = [first](std::uint64_t count) {
      return static_cast<std::size_t>(std::min(kTogether, count - std::min(count, first)));
    };
    std::vector<double> numbers;
    if (part.wide() && has_own_points && rows_from(part.part().points) > 0) {
      numbers.resize(3 * rows_from(part.part().points));
      if (!part.positions(first, numbers)) return false;
      for (std::size_t i = 0; i < numbers.size(); i += 3) {
        const glm::dvec3 p(numbers[i], numbers[i + 1], numbers[i + 2]);
        if (finite(p)) ranges_.box.add(p);
      }
    }
    const std::size_t rows = rows_from(part.of_points() ? part.part().points : part.part().cells);
    if (!part.has_values() || part.has_colors() || rows == 0 || (part.of_points() && !has_own_points)) return true;
    numbers.resize(rows);
    if (!part.values(first, numbers)) return false;
    for (const double number : numbers) {
      const auto value = static_cast<float>(number);
      if (!std::isfinite(value)) continue;
      ranges_.low = std::min(ranges_.low, value);
      ranges_.high = std::max(ranges_.high, value);
    }
    return true;
  }

  /// Finds the ranges of all ranks, or restores the ranges that --resume has. Collective.
  std::optional<EncodeError> find_ranges() {
    constexpr const char* kRanges = "ranges";
    if (const auto earlier = finished_record<GridRanges>(qnv::earlier_result(shared_, kRanges))) {
      ranges_ = *earlier;
      return std::nullopt;
    }
    if (auto failed = shared_.agree(survey())) return failed;
    const GridRanges own = ranges_;
    for (const GridRanges& one : qnv::gather_records<GridRanges>(shared_.ranks(), std::span(&own, 1))) ranges_.add(one);
    return qnv::record_result(shared_, kRanges, std::as_bytes(std::span(&ranges_, 1)));
  }

  /// Makes the colour key and the origin from the ranges.
  void make_key() {
    if (!ranges_.box.empty()) origin_ = qnv::local_origin(ranges_.box);
    if (grid_.title.empty()) return;
    std::vector<float> values;
    if (ranges_.low <= ranges_.high) values = {ranges_.low, ranges_.high};
    key_ = color_key_of_choice(values, grid_.title, grid_.choice);
  }

  /// Stores the triangles of this rank's runs.
  std::optional<EncodeError> store_triangles(std::span<const OuterFace> outer) {
    auto next = outer.begin();
    for (std::uint64_t number = own_.first; number < own_.end; ++number) {
      if (is_cancelled(progress_)) return EncodeError{"cancelled"};
      if (const auto& finished = finished_[static_cast<std::size_t>(number - own_.first)]) {
        take(*finished);
        while (next != outer.end() && next->run == number) ++next;
        continue;
      }
      const LargeGrid::Run& run = grid_.runs[static_cast<std::size_t>(number)];
      const auto opened = reader_.part(run.part);
      if (const auto* const problem = std::get_if<std::string>(&opened)) return EncodeError{*problem};
      GridPartReader& part = *std::get<GridPartReader*>(opened);
      auto read = part.cells(run, most_run_corners(memory_));
      if (auto* const problem = std::get_if<std::string>(&read)) return EncodeError{std::move(*problem)};
      const GridRun& cells = std::get<GridRun>(read);
      RunTriangles made(part, run, cells, key_, grid_.shows_values, origin_);
      made.add_flat();
      for (; next != outer.end() && next->run == number; ++next) {
        if (next->cell() >= cells.types.size()) return EncodeError{grid_.source->message(run.part, kChangedGridFile)};
        const std::uint8_t type = cells.types[next->cell()];
        const GridShape shape = grid_shape(type);
        const auto cell = cells.cell(next->cell());
        if (next->face() >= shape.faces.size() || cell.size() < shape.corners)
          return EncodeError{grid_.source->message(run.part, kChangedGridFile)};
        made.add(face_of(cell, type, next->face()).list(), next->cell());
      }
      const bool good = made.make();
      if (grid_.source->is_changed(run.part)) return EncodeError{grid_.source->message(run.part, kChangedGridFile)};
      if (!good) return EncodeError{grid_.source->message(run.part, "the arrays are damaged")};
      const FinishedRun finished{{shared_.store().size(), made.triangles.size()}, made.box, made.omitted};
      if ((!made.triangles.empty() && !shared_.store().append(std::as_bytes(std::span(made.triangles)))) ||
          !shared_.store().finish(name_of(number), finished.triangles.offset, std::as_bytes(std::span(&finished, 1))))
        return EncodeError{shared_.store().problem()};
      take(finished);
      if (progress_) progress_->done += run.cells;
    }
    return shared_.store().publish() ? std::nullopt : std::optional(EncodeError{shared_.store().problem()});
  }

  /// Collects the offsets of all ranks' triangles in the store, and returns their mesh. Collective.
  std::variant<MeshStream, EncodeError> stream() {
    MeshStream made;
    auto all = std::make_shared<const std::vector<StoredTriangles>>(
        qnv::gather_records<StoredTriangles>(shared_.ranks(), stored_));
    for (const StoredTriangles& run : *all) made.faces += run.count;
    if (made.faces == 0) return EncodeError{"the grid has no faces; expected cells with an area"};
    Box box;
    for (const Box& one : qnv::gather_records<Box>(shared_.ranks(), std::span(&box_, 1))) box.add(one);
    OmittedCells omitted;
    for (const OmittedCells& one : qnv::gather_records<OmittedCells>(shared_.ranks(), std::span(&omitted_, 1)))
      omitted.add(one);
    made.omitted = omitted.text();
    made.size = box.size();
    made.origin = origin_;
    made.color_key = key_;
    made.source = {all->size(), [all, &store = shared_.store()](std::uint64_t run, const qnv::TriangleSink& sink) {
                     return read_triangles(store, (*all)[static_cast<std::size_t>(run)], sink);
                   }};
    return made;
  }

  static bool read_triangles(const qnv::SpillStore& store, const StoredTriangles& run, const qnv::TriangleSink& sink) {
    constexpr std::uint64_t kBatch = 4096;
    std::vector<StoredTriangle> stored;
    TriangleBatches batches(sink);
    for (std::uint64_t first = 0; first < run.count; first += kBatch) {
      stored.resize(static_cast<std::size_t>(std::min(kBatch, run.count - first)));
      if (!store.read(run.offset + first * sizeof(StoredTriangle), std::as_writable_bytes(std::span(stored))))
        return false;
      for (const StoredTriangle& one : stored) {
        qnv::Triangle triangle{};
        for (std::size_t i = 0; i < 3; ++i) {
          triangle.positions[i] = {one.places[3 * i], one.places[3 * i + 1], one.places[3 * i + 2]};
          triangle.colors[i] = {one.colors[3 * i], one.colors[3 * i + 1], one.colors[3 * i + 2]};
        }
        if (!batches.add(triangle)) return false;
      }
    }
    return batches.flush();
  }

  const LargeGrid& grid_;
  qnv::EncodeRanks& shared_;
  std::uint64_t memory_;
  Progress* progress_;
  LargeGridReader reader_;
  qnv::RankShare own_;                                // runs that this rank reads
  std::vector<std::optional<FinishedRun>> finished_;  // results that --resume has, by run
  GridRanges ranges_;
  std::optional<ColorKey> key_;
  glm::dvec3 origin_{0};
  std::vector<StoredTriangles> stored_;
  Box box_;
  OmittedCells omitted_;
};

}  // namespace

std::variant<MeshStream, EncodeError> grid_surface(const LargeGrid& grid, qnv::EncodeRanks& shared,
                                                   std::uint64_t memory, Progress* progress) {
  return GridSurfaceMaker(grid, shared, memory, progress).make();
}

}  // namespace gs::app
