#include "app/encode/grids/grid_sources.h"
#include "app/formats/datasets/arrays/dataset_tree.h"
#include "app/formats/datasets/dataset_formats.h"

#include <algorithm>
#include <array>
#include <mutex>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

namespace gs::app {
namespace {

// Maximum count of numbers in a row of an array, and count of numbers in a block. Each read gets one block.
constexpr std::uint64_t kMostRowNumbers = 4096, kBlockNumbers = std::uint64_t{1} << 14;
// Maximum number of blocks of an array in memory.
constexpr std::size_t kMostBlocksKept = 32;

/// Open file of arrays. `mutex` guards its reads. Any thread.
struct OpenArrays {
  std::shared_ptr<ArrayFile> file;
  std::mutex mutex;
};

/// Rows of an array. Keeps the most recently used blocks in memory.
class RowNumbers final : public GridNumbers {
 public:
  /// Opens rows of an array. Returns a message if the array does not have these rows.
  static std::variant<std::unique_ptr<GridNumbers>, std::string> open(std::shared_ptr<OpenArrays> arrays,
                                                                      const ArrayRows& rows) {
    const auto& all = arrays->file->arrays();
    const auto found = std::ranges::find(all, rows.path, &ArrayInfo::path);
    if (found == all.end()) return "expected an array " + rows.path + ", which the file does not have";
    if (!found->problem.empty()) return rows.path + ": " + found->problem;
    const std::size_t axis = rows.before.size();
    bool fits = found->type != NumberType::none && found->shape.size() > axis;
    for (std::size_t i = 0; fits && i < axis; ++i) fits = rows.before[i] < found->shape[i];
    fits = fits && rows.first <= found->shape[axis] && rows.rows <= found->shape[axis] - rows.first;
    if (!fits)
      return rows.path + " has too few rows, or no numbers; expected " + std::to_string(rows.rows) + " rows of numbers";
    std::uint64_t stored = found->parts;
    for (std::size_t i = axis + 1; i < found->shape.size() && stored <= kMostRowNumbers; ++i)
      stored *= std::clamp<std::uint64_t>(found->shape[i], 1, kMostRowNumbers + 1);  // the product does not wrap around
    if (stored > kMostRowNumbers || rows.columns > stored || rows.columns == 0)
      return rows.path + " has " + (stored > kMostRowNumbers ? "too many" : "too few") +
             " numbers in a row; expected " + std::to_string(rows.columns) + " to " + std::to_string(kMostRowNumbers);
    {
      const std::lock_guard lock(arrays->mutex);
      const auto index = static_cast<std::size_t>(found - all.begin());
      const double elements = static_cast<double>(rows.rows) * static_cast<double>(stored / found->parts);
      if (std::string problem = unwritten_problem(*arrays->file, index, elements); !problem.empty())
        return rows.path + ": " + problem;
    }
    return std::unique_ptr<GridNumbers>(new RowNumbers(std::move(arrays), rows, *found, stored));
  }

  bool read(std::uint64_t first, std::span<double> to) override {
    if (first > size() || to.size() > size() - first) return false;
    while (!to.empty()) {
      const std::uint64_t number = first / in_block_;
      const Block* const from = block(number);
      if (!from) return false;
      const std::size_t at = static_cast<std::size_t>(first - number * in_block_),
                        some = std::min(to.size(), from->numbers.size() - at);
      std::copy_n(from->numbers.begin() + static_cast<std::ptrdiff_t>(at), some, to.begin());
      to = to.subspan(some);
      first += some;
    }
    return true;
  }
  [[nodiscard]] std::uint64_t size() const override { return rows_.rows * rows_.columns; }

 private:
  struct Block {
    std::uint64_t number = 0, used = 0;  // `used` is the value of `uses_` at the last use
    std::vector<double> numbers;
  };
  RowNumbers(std::shared_ptr<OpenArrays> arrays, const ArrayRows& rows, const ArrayInfo& info, std::uint64_t stored)
      : arrays_(std::move(arrays)),
        rows_(rows),
        index_(static_cast<std::size_t>(&info - arrays_->file->arrays().data())),
        stored_(static_cast<std::size_t>(stored)),
        block_rows_(std::max<std::uint64_t>(1, kBlockNumbers / stored)),
        in_block_(block_rows_ * rows.columns) {}

  const Block* block(std::uint64_t number) {
    if (!kept_.empty() && kept_[last_].number == number) return &kept_[last_];
    auto found = std::ranges::find(kept_, number, &Block::number);
    if (found == kept_.end()) {
      auto numbers = load(number);
      if (!numbers) return nullptr;
      if (kept_.size() < kMostBlocksKept)
        found = kept_.insert(kept_.end(), Block{});
      else
        found = std::ranges::min_element(kept_, {}, &Block::used);
      *found = {number, 0, std::move(*numbers)};
    }
    found->used = ++uses_;
    last_ = static_cast<std::size_t>(found - kept_.begin());
    return &*found;
  }

  std::optional<std::vector<double>> load(std::uint64_t number) const {
    const std::uint64_t begin = number * block_rows_, count = std::min(block_rows_, rows_.rows - begin);
    const std::lock_guard lock(arrays_->mutex);
    const ArrayInfo& info = arrays_->file->arrays()[index_];
    std::vector<std::uint64_t> first = rows_.before, size(rows_.before.size(), 1);
    first.push_back(rows_.first + begin);
    size.push_back(count);
    for (std::size_t i = first.size(); i < info.shape.size(); ++i) {
      first.push_back(0);
      size.push_back(info.shape[i]);
    }
    std::vector<std::byte> bytes(static_cast<std::size_t>(count) * stored_ * size_of(info.type));
    if (!arrays_->file->read(index_, first, size, bytes).empty()) return std::nullopt;
    std::vector<double> numbers = doubles_of(info.type, bytes);
    if (rows_.columns < stored_) {
      for (std::size_t row = 0; row < count; ++row)
        std::copy_n(numbers.begin() + static_cast<std::ptrdiff_t>(row * stored_), rows_.columns,
                    numbers.begin() + static_cast<std::ptrdiff_t>(row * rows_.columns));
      numbers.resize(static_cast<std::size_t>(count) * rows_.columns);
    }
    for (double& one : numbers) one -= rows_.base;
    return numbers;
  }

  std::shared_ptr<OpenArrays> arrays_;
  ArrayRows rows_;
  std::size_t index_, stored_;  // index of the array; count of numbers in a stored row
  std::uint64_t block_rows_, in_block_;
  std::vector<Block> kept_;
  std::size_t last_ = 0;
  std::uint64_t uses_ = 0;
};

/// Coordinates from one array per axis, joined to rows of three numbers. Missing axes are 0.
class JoinedAxes final : public GridNumbers {
 public:
  explicit JoinedAxes(std::vector<std::unique_ptr<GridNumbers>> axes) : axes_(std::move(axes)) {}
  bool read(std::uint64_t first, std::span<double> to) override {
    if (first % 3 != 0 || to.size() % 3 != 0) return false;
    column_.resize(to.size() / 3);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::ranges::fill(column_, 0.0);
      if (axis < axes_.size() && !axes_[axis]->read(first / 3, column_)) return false;
      for (std::size_t i = 0; i < column_.size(); ++i) to[3 * i + axis] = column_[i];
    }
    return true;
  }
  [[nodiscard]] std::uint64_t size() const override { return 3 * axes_.front()->size(); }

 private:
  std::vector<std::unique_ptr<GridNumbers>> axes_;
  std::vector<double> column_;
};

/// Grid in a file of arrays.
class ArrayGrid final : public GridSource {
 public:
  ArrayGrid(DatasetGrid grid, GridFile on_disk)
      : arrays_(std::make_shared<OpenArrays>()), grid_(std::move(grid.rows)), on_disk_(std::move(on_disk)) {
    arrays_->file = std::move(grid.file);
  }

  [[nodiscard]] bool is_changed(std::size_t) const override { return on_disk_.is_changed(); }
  [[nodiscard]] std::string state() const override { return on_disk_.state(); }
  [[nodiscard]] std::string message(std::size_t, const std::string& text) const override { return text; }
  [[nodiscard]] std::variant<GridPartArrays, std::string> open(std::size_t part) const override {
    if (on_disk_.is_changed()) return std::string(kChangedGridFile);
    const GridPartRows& rows = grid_.parts[part];
    GridPartArrays made;
    std::string problem;
    const auto open = [&](const ArrayRows& from, std::unique_ptr<GridNumbers>& to) {
      if (from.empty() || !problem.empty()) return;
      auto opened = RowNumbers::open(arrays_, from);
      if (auto* const wrong = std::get_if<std::string>(&opened))
        problem = std::move(*wrong);
      else
        to = std::move(std::get<std::unique_ptr<GridNumbers>>(opened));
    };
    std::vector<std::unique_ptr<GridNumbers>> axes(rows.places.size());
    for (std::size_t i = 0; i < axes.size(); ++i) open(rows.places[i], axes[i]);
    open(rows.types, made.types);
    open(rows.ends, made.ends);
    open(rows.corners, made.corners);
    open(rows.values, made.values);
    open(rows.hidden_points, made.point_flags);
    open(rows.hidden_cells, made.cell_flags);
    if (!problem.empty()) return problem;
    made.wide = std::ranges::any_of(rows.places, [&](const ArrayRows& one) { return has_doubles(one.path); });
    const bool joined = rows.places.size() == 1 && rows.places.front().columns == 3;
    made.points = joined ? std::move(axes.front()) : std::make_unique<JoinedAxes>(std::move(axes));
    made.element = rows.element;
    made.element_corners = rows.types.empty() ? rows.corners.columns : 0;
    made.components = rows.values.empty() ? 1 : rows.values.columns;
    made.of_points = grid_.of_points;
    made.omits_polyhedra = true;
    return made;
  }

 private:
  [[nodiscard]] bool has_doubles(const std::string& path) const {
    const auto& all = arrays_->file->arrays();
    const auto found = std::ranges::find(all, path, &ArrayInfo::path);
    return found != all.end() && found->type == NumberType::f64;
  }

  std::shared_ptr<OpenArrays> arrays_;
  GridRows grid_;
  GridFile on_disk_;
};

// Reports whether the reader supports a part: it has all necessary arrays, and its counts are in range.
bool is_sound(const GridPartRows& part) {
  const bool typed = !part.types.empty() && !part.ends.empty();
  return part.points > 0 && part.cells > 0 && part.points < kMostGridPoints && part.cells < kMostGridPoints &&
         !part.places.empty() && part.places.size() <= 3 && !part.corners.empty() && (typed || part.element != 0) &&
         part.values.columns <= kMostGridComponents;
}

// Returns the arrays in chunks that the cache of a reader may not hold. Reading a block would unpack a whole chunk.
std::set<std::string_view> arrays_in_large_chunks(const ArrayFile& file, std::uint64_t memory) {
  const auto most = static_cast<double>(std::clamp<std::uint64_t>(memory / 8, 1 << 20, 64 << 20));  // the cache
  std::set<std::string_view> large;
  for (const ArrayInfo& array : file.arrays()) {
    double bytes = array.chunk.empty() ? 0 : static_cast<double>(size_of(array.type)) * array.parts;
    for (const std::uint64_t edge : array.chunk) bytes *= static_cast<double>(edge);
    if (bytes > most) large.insert(array.path);
  }
  return large;
}

bool uses_any(const GridPartRows& part, const std::set<std::string_view>& arrays) {
  const auto named = [&](const ArrayRows& rows) { return arrays.contains(rows.path); };
  return std::ranges::any_of(part.places, named) || named(part.types) || named(part.ends) || named(part.corners) ||
         named(part.values) || named(part.hidden_points) || named(part.hidden_cells);
}

}  // namespace

std::optional<LargeGrid> open_array_grid(const VolumeFile& file, std::uint64_t memory) {
  if (!may_exceed(file.content.bytes.size(), memory)) return std::nullopt;
  auto opened = open_dataset_grid(file);
  if (!opened || !std::ranges::all_of(opened->rows.parts, is_sound)) return std::nullopt;
  const auto large = arrays_in_large_chunks(*opened->file, memory);
  if (std::ranges::any_of(opened->rows.parts, [&](const GridPartRows& part) { return uses_any(part, large); }))
    return std::nullopt;
  LargeGrid grid;
  grid.title = opened->rows.title;
  grid.shows_values = opened->rows.has_values;
  for (const GridPartRows& part : opened->rows.parts) grid.parts.push_back({part.points, part.cells, part.space});
  grid.source =
      std::make_shared<ArrayGrid>(std::move(*opened), GridFile::find(file.path, {}, file.content.bytes.size()));
  return grid;
}

}  // namespace gs::app
