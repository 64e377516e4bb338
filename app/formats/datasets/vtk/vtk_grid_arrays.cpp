#include "app/formats/datasets/vtk/vtk_grid_arrays.h"

#include "app/formats/vtk/bookkeeping.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <list>
#include <utility>

namespace gs::app {
namespace {

/// Boxes of points or cells, x first.
struct GridBox {
  std::array<std::int64_t, 3> first{}, last{};  // inclusive

  [[nodiscard]] bool empty() const { return first[0] > last[0] || first[1] > last[1] || first[2] > last[2]; }
  [[nodiscard]] std::int64_t count(std::size_t axis) const { return last[axis] - first[axis] + 1; }
  [[nodiscard]] GridBox common(const GridBox& other) const {
    GridBox both;
    for (std::size_t i = 0; i < 3; ++i) {
      both.first[i] = std::max(first[i], other.first[i]);
      both.last[i] = std::min(last[i], other.last[i]);
    }
    return both;
  }
};

/// Returns the points or cells of an extent. A flat extent has one layer of cells.
GridBox box_of(const VtkExtent& extent, VtkSection section) {
  GridBox box;
  for (std::size_t i = 0; i < 3; ++i) {
    box.first[i] = extent[2 * i];
    box.last[i] = extent[2 * i + 1];
    if (section == VtkSection::cell_data && box.last[i] > box.first[i]) --box.last[i];
  }
  return box;
}

template <class T>
T clamped_number(double value) {
  if constexpr (std::is_floating_point_v<T>) {
    return static_cast<T>(value);
  } else {
    constexpr auto kLeast = static_cast<double>(std::numeric_limits<T>::min()),
                   kMost = static_cast<double>(std::numeric_limits<T>::max());
    if (!(value > kLeast)) return std::numeric_limits<T>::min();
    return value >= kMost ? std::numeric_limits<T>::max() : static_cast<T>(value);
  }
}

/// One array of a grid at all times. Each step may have several pieces, which are decoded when they are needed.
class VtkGridFile final : public ArrayFile {
 public:
  VtkGridFile(std::shared_ptr<VtkFiles> files, const VtkGridSteps& grid, const VtkDeclaredArray& array, StoredType type)
      : files_(std::move(files)),
        steps_(grid.steps),
        array_(array),
        type_(type),
        whole_(box_of(grid.extent, array.section)) {
    ArrayInfo info;
    info.path = "/" + array.name;
    if (steps_.size() > 1) info.shape.push_back(steps_.size());
    for (const std::uint64_t size : vtk_grid_shape(grid, array.section)) info.shape.push_back(size);
    info.type = static_cast<NumberType>(type);
    info.parts = static_cast<std::uint32_t>(array.components);
    arrays_.push_back(std::move(info));
    most_bytes_ = files_->first().budget->left(Resource::volumes) / 4;
  }

  const std::vector<ArrayInfo>& arrays() const override { return arrays_; }
  const std::vector<std::string>& groups() const override { return groups_; }
  std::vector<ArrayAttribute> attributes(const std::string&) override { return {}; }
  std::string trouble() const override { return files_->missing(); }

  std::string read(std::size_t number, std::span<const std::uint64_t> first, std::span<const std::uint64_t> count,
                   std::span<std::byte> to) override {
    const std::vector<std::uint64_t>& shape = arrays_.front().shape;
    const std::size_t rank = shape.size(), element = size_of(type_) * static_cast<std::size_t>(array_.components);
    if (number != 0 || first.size() != rank || count.size() != rank) return "its axes differ";
    std::uint64_t values = 1;
    for (std::size_t i = 0; i < rank; ++i) {
      if (first[i] > shape[i] || count[i] > shape[i] - first[i]) return "the part lies outside";
      if (count[i] > 0 && values > to.size() / count[i]) return "the size differs";
      values *= count[i];
    }
    if (values * element != to.size()) return "the size differs";
    if (to.empty()) return {};
    GridBox box;
    for (std::size_t i = 0; i < 3; ++i) {
      box.first[i] = whole_.first[i] + static_cast<std::int64_t>(first[rank - 1 - i]);
      box.last[i] = box.first[i] + static_cast<std::int64_t>(count[rank - 1 - i]) - 1;
    }
    const std::uint64_t first_step = rank > 3 ? first[0] : 0, steps = rank > 3 ? count[0] : 1;
    const std::size_t bytes = to.size() / static_cast<std::size_t>(steps);
    fill_missing(to);
    for (std::uint64_t step = 0; step < steps; ++step)
      for (const VtkGridPiece& piece : steps_[static_cast<std::size_t>(first_step + step)])
        if (!piece.extent || !box.common(box_of(*piece.extent, array_.section)).empty())
          read_piece(piece, box, to.subspan(static_cast<std::size_t>(step) * bytes, bytes));
    return {};
  }

 private:
  /// Decoded array of a piece.
  struct Decoded {
    std::string path;
    std::size_t piece = 0;
    StoredVoxels values;
  };

  void fill_missing(std::span<std::byte> to) const {
    with_stored_type(type_, [&](auto kind) {
      using T = decltype(kind);
      T none{};
      if constexpr (std::is_floating_point_v<T>) none = std::numeric_limits<T>::quiet_NaN();
      for (std::size_t i = 0; i + sizeof(T) <= to.size(); i += sizeof(T))
        std::memcpy(to.data() + i, &none, sizeof none);
    });
  }

  void read_piece(const VtkGridPiece& piece, const GridBox& box, std::span<std::byte> to) {
    const auto opened = files_->open(piece.path);
    if (const auto* const problem = std::get_if<std::string>(&opened))
      return files_->note_missing(piece.path, *problem);
    const VtkOpened& file = *std::get<std::shared_ptr<const VtkOpened>>(opened);
    bool found = false;
    for (const VtkArray& array : file.header.arrays) {
      if (array.section != array_.section || array.name != array_.name || array.piece >= file.header.pieces.size())
        continue;
      found = true;
      const VtkPiece& part = file.header.pieces[array.piece];
      const auto extent = vtk_extent(part.extent.empty() ? file.header.whole_extent : part.extent);
      if (!extent) return files_->note_missing(piece.path, "its extent is damaged");
      const GridBox has = box_of(*extent, array_.section), common = has.common(box);
      if (common.empty()) continue;
      if (array.components != array_.components)
        return files_->note_missing(piece.path, "its array has " + std::to_string(array.components) +
                                                    " components; expected " + std::to_string(array_.components));
      const StoredVoxels* const values = decoded(file, array, has);
      if (!values) return;
      copy(*values, has, common, box, to);
    }
    if (!found) files_->note_missing(piece.path, "it has no array '" + array_.name.substr(0, 80) + "'");
  }

  const StoredVoxels* decoded(const VtkOpened& file, const VtkArray& array, const GridBox& box) {
    for (auto known = decoded_.begin(); known != decoded_.end(); ++known)
      if (known->path == file.path && known->piece == array.piece) {
        decoded_.splice(decoded_.begin(), decoded_, known);
        return &decoded_.front().values;
      }
    double numbers = static_cast<double>(array.components);
    for (std::size_t i = 0; i < 3; ++i) numbers *= static_cast<double>(box.count(i));
    constexpr double kMost = 1e14;
    if (numbers > kMost) {
      files_->note_missing(file.path, "its array is too large");
      return nullptr;
    }
    while (!decoded_.empty() && (decoded_.size() >= kMostDecoded || decoded_bytes() > most_bytes_)) decoded_.pop_back();
    auto values =
        vtk_values(file.bytes, file.header, array, static_cast<std::uint64_t>(numbers), files_->first().budget);
    if (std::holds_alternative<std::string>(values) && !decoded_.empty()) {
      decoded_.clear();  // perhaps they left too little memory
      values = vtk_values(file.bytes, file.header, array, static_cast<std::uint64_t>(numbers), files_->first().budget);
    }
    if (const auto* const problem = std::get_if<std::string>(&values)) {
      files_->note_missing(file.path, *problem);
      return nullptr;
    }
    decoded_.push_front({file.path, array.piece, std::get<StoredVoxels>(std::move(values))});
    return &decoded_.front().values;
  }
  [[nodiscard]] std::uint64_t decoded_bytes() const {
    std::uint64_t bytes = 0;
    for (const Decoded& one : decoded_) bytes += one.values.content.file ? 0 : one.values.content.bytes.size();
    return bytes;
  }

  /// Copies the numbers of `common` from a piece, which has the box `has`, to those of `box`.
  void copy(const StoredVoxels& values, const GridBox& has, const GridBox& common, const GridBox& box,
            std::span<std::byte> to) const {
    const auto parts = static_cast<std::size_t>(array_.components);
    const std::size_t from_size = size_of(values.type), to_size = size_of(type_);
    const std::size_t run = static_cast<std::size_t>(common.count(0)) * parts;
    const std::span<const std::byte> stored = values.content.bytes.subspan(
        std::min<std::size_t>(static_cast<std::size_t>(values.offset), values.content.bytes.size()));
    const auto place = [](const GridBox& in, std::int64_t x, std::int64_t y, std::int64_t z) {
      return static_cast<std::size_t>(((z - in.first[2]) * in.count(1) + y - in.first[1]) * in.count(0) + x -
                                      in.first[0]);
    };
    for (std::int64_t z = common.first[2]; z <= common.last[2]; ++z)
      for (std::int64_t y = common.first[1]; y <= common.last[1]; ++y) {
        const std::size_t from = place(has, common.first[0], y, z) * parts * from_size;
        std::byte* next = to.data() + place(box, common.first[0], y, z) * parts * to_size;
        if (from > stored.size() || run * from_size > stored.size() - from) return;
        if (values.type == type_ && (!values.big_endian || to_size == 1)) {
          std::memcpy(next, stored.data() + from, run * to_size);
          continue;
        }
        StoredVoxels row = values;
        row.offset = values.offset + from;
        with_stored_type(type_, [&](auto kind) {
          using T = decltype(kind);
          each_number(row, run, [&](double value) {
            const T number = clamped_number<T>(value);
            std::memcpy(next, &number, sizeof number);
            next += sizeof number;
          });
        });
      }
  }

  static constexpr std::size_t kMostDecoded = 256;

  std::shared_ptr<VtkFiles> files_;
  std::vector<std::vector<VtkGridPiece>> steps_;
  VtkDeclaredArray array_;
  StoredType type_;
  GridBox whole_;
  std::vector<ArrayInfo> arrays_;
  std::vector<std::string> groups_;
  std::list<Decoded> decoded_;  // the last one used first
  std::uint64_t most_bytes_ = 0;
};

/// Returns the axis of the centres of cells.
GridAxis cell_axis(const GridAxis& points, std::uint64_t cells) {
  GridAxis axis = points;
  if (points.positions.size() == cells + 1) {
    axis.positions.pop_back();
    for (std::size_t i = 0; i < axis.positions.size(); ++i)
      axis.positions[i] = (points.positions[i] + points.positions[i + 1]) / 2;
    return axis;
  }
  axis.first += axis.step / 2;
  return axis;
}

}  // namespace

std::vector<std::uint64_t> vtk_grid_shape(const VtkGridSteps& grid, VtkSection section) {
  const GridBox box = box_of(grid.extent, section);
  return {static_cast<std::uint64_t>(box.count(2)), static_cast<std::uint64_t>(box.count(1)),
          static_cast<std::uint64_t>(box.count(0))};
}

VolumeResult open_vtk_grid(std::shared_ptr<VtkFiles> files, const VtkGridSteps& grid, std::size_t array,
                           const VoxelComponent& choice) {
  const VtkDeclaredArray& declared = grid.arrays[array];
  const auto type = vtk_type_of(declared.type);
  constexpr std::uint64_t kMostParts = 64;
  if (!type) return "the type is '" + declared.type.substr(0, 80) + "'; expected Int8 to UInt64, Float32 or Float64";
  if (declared.components == 0 || declared.components > kMostParts)
    return std::to_string(declared.components) + " components; expected 1 to " + std::to_string(kMostParts);
  const auto file = std::make_shared<VtkGridFile>(files, grid, declared, *type);
  const SharedBytes content = files->first().content;
  const DatasetTree tree(file, content, files->first().budget);
  GridSpec spec;
  spec.arrays = {0};
  spec.path = (declared.section == VtkSection::point_data ? "/PointData/" : "/CellData/") + declared.name;
  spec.title = declared.name;
  const std::vector<std::uint64_t>& shape = file->arrays().front().shape;
  spec.axes.resize(shape.size());
  const std::size_t lead = shape.size() - 3;
  if (lead > 0) {
    spec.axes[0].role = AxisRole::time;
    spec.axes[0].positions = grid.times;
  }
  for (std::size_t i = 0; i < 3; ++i) {
    GridAxis& axis = spec.axes[lead + 2 - i];
    const bool flat = grid.extent[2 * i] == grid.extent[2 * i + 1];
    axis = declared.section == VtkSection::cell_data && !flat ? cell_axis(grid.axes[i], shape[lead + 2 - i])
                                                              : grid.axes[i];
    axis.role = static_cast<AxisRole>(i);
  }
  spec.directions = grid.directions;
  const std::string name = lower_case(declared.name);
  spec.colors = name.find("rgb") != std::string::npos || name.find("color") != std::string::npos ||
                name.find("colour") != std::string::npos;
  files->read_lazily();
  VolumeResult result = open_grid(tree, std::move(spec), choice);
  if (auto* const source = std::get_if<qnv::VolumeSource>(&result))
    source->trouble = [file] { return file->trouble(); };
  return result;
}

GridAxis vtk_axis_of(std::vector<double> positions) {
  GridAxis axis;
  if (positions.empty()) return axis;
  axis.first = positions.front();
  if (positions.size() > 1)
    axis.step = (positions.back() - positions.front()) / static_cast<double>(positions.size() - 1);
  if (!std::isfinite(axis.step) || axis.step == 0) axis.step = 1;
  if (!is_even(positions)) axis.positions = std::move(positions);
  return axis;
}

VtkGridPlaces vtk_image_places(const VtkExtent& extent, const std::string& origin_text, const std::string& spacing_text,
                               const std::string& direction_text) {
  VtkGridPlaces places;
  std::vector<double> origin = numbers_of(origin_text, 3), spacing = numbers_of(spacing_text, 3);
  const std::vector<double> direction = numbers_of(direction_text, 9);
  if (origin.size() != 3) origin = {0, 0, 0};
  if (spacing.size() != 3) spacing = {1, 1, 1};
  if (direction.size() == 9)
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column)
        places.directions[column][row] = direction[static_cast<std::size_t>(row * 3 + column)];
  // GridAxis::first counts along the directions, so the origin is turned back.
  if (!(std::abs(glm::determinant(places.directions)) > 1e-9)) places.directions = glm::dmat3(1);
  const glm::dvec3 base = glm::inverse(places.directions) * glm::dvec3(origin[0], origin[1], origin[2]);
  for (std::size_t i = 0; i < 3; ++i) {
    places.axes[i].step = spacing[i];
    places.axes[i].first = base[static_cast<int>(i)] + spacing[i] * static_cast<double>(extent[2 * i]);
  }
  return places;
}

std::optional<VtkGridPlaces> vtk_lattice_of(const VtkOpened& file, const VtkExtent& extent, const WorldBudget& budget) {
  const VtkArray* stored = nullptr;
  for (const VtkArray& array : file.header.arrays)
    if (array.section == VtkSection::points) stored = &array;
  std::array<std::uint64_t, 3> size{};
  double count = 3;
  for (std::size_t i = 0; i < 3; ++i) {
    size[i] = static_cast<std::uint64_t>(extent[2 * i + 1] - extent[2 * i] + 1);
    count *= static_cast<double>(size[i]);
    if (size[i] < 2) return std::nullopt;
  }
  constexpr double kMost = 1e12;
  if (!stored || stored->components != 3 || count > kMost) return std::nullopt;
  const auto numbers = static_cast<std::uint64_t>(count);
  const auto values = vtk_values(file.bytes, file.header, *stored, numbers, budget);
  const auto* const points = std::get_if<StoredVoxels>(&values);
  if (!points) return std::nullopt;
  const auto each_point = [&](auto take) {
    glm::dvec3 point(0);
    std::uint64_t at = 0;
    each_number(*points, numbers, [&](double value) {
      point[static_cast<int>(at % 3)] = value;
      if (++at % 3 != 0) return;
      const std::uint64_t number = at / 3 - 1;
      take(std::array{number % size[0], number / size[0] % size[1], number / (size[0] * size[1])}, point);
    });
  };
  // The edges from the first point.
  std::array<std::vector<glm::dvec3>, 3> edges;
  each_point([&](const std::array<std::uint64_t, 3>& place, const glm::dvec3& point) {
    for (std::size_t i = 0; i < 3; ++i)
      if (place[(i + 1) % 3] == 0 && place[(i + 2) % 3] == 0) edges[i].push_back(point);
  });
  VtkGridPlaces places;
  std::array<std::vector<double>, 3> along;
  double extent_length = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    if (edges[i].size() != size[i]) return std::nullopt;
    const glm::dvec3 whole = edges[i].back() - edges[i].front();
    const double length = glm::length(whole);
    if (!(length > 0) || !std::isfinite(length)) return std::nullopt;
    places.directions[static_cast<int>(i)] = whole / length;
    extent_length = std::max(extent_length, length);
    for (const glm::dvec3& point : edges[i])
      along[i].push_back(glm::dot(point - edges[i].front(), places.directions[static_cast<int>(i)]));
  }
  constexpr double kTolerance = 1e-5, kFlat = 1e-6;
  if (!(std::abs(glm::determinant(places.directions)) > kFlat)) return std::nullopt;
  bool fits = true;
  const glm::dvec3 origin = edges[0].front();
  each_point([&](const std::array<std::uint64_t, 3>& place, const glm::dvec3& point) {
    const glm::dvec3 expected =
        origin + places.directions * glm::dvec3(along[0][place[0]], along[1][place[1]], along[2][place[2]]);
    fits = fits && glm::length(point - expected) <= kTolerance * extent_length;
  });
  if (!fits) return std::nullopt;
  const glm::dvec3 base = glm::inverse(places.directions) * origin;
  for (std::size_t i = 0; i < 3; ++i) {
    for (double& one : along[i]) one += base[static_cast<int>(i)];
    places.axes[i] = vtk_axis_of(std::move(along[i]));
  }
  return places;
}

}  // namespace gs::app
