#include "app/formats/datasets/vtk/vtk_datasets.h"

#include "app/formats/datasets/arrays/dataset_module.h"
#include "app/formats/datasets/vtk/vtk_grid_arrays.h"
#include "app/formats/vtk/bookkeeping.h"
#include "app/formats/vtk/vtk_legacy.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace gs::app {
namespace {

/// Files of one surface or grid, with a name for users.
struct VtkBlock {
  std::string name;
  std::vector<VtkGridPiece> files;
  std::shared_ptr<const VtkOpened> index;  // file of pieces, or null
};

/// Time with the files that are shown then.
struct VtkStep {
  double time = 0;
  std::vector<VtkMember> members;  // paths are those of VtkFiles; an empty one is the file itself
};

const char* number_name(StoredType type) {
  static constexpr const char* kNames[] = {"u8", "i8", "u16", "i16", "u32", "i32", "f32", "f64", "u64", "i64"};
  return kNames[static_cast<std::size_t>(type)];
}

class VtkDataFile final : public DatasetFile {
 public:
  explicit VtkDataFile(const VolumeFile& file) : files_(std::make_shared<VtkFiles>(file)) {}

  /// Lists the datasets of the first step. Returns an empty text, or a message.
  std::string list() {
    const auto opened = files_->open({});
    if (const auto* const problem = std::get_if<std::string>(&opened)) return *problem;
    const VtkOpened& first = *std::get<std::shared_ptr<const VtkOpened>>(opened);
    if (first.kind == VtkFileClass::steps)
      add_steps(first);
    else
      steps_.push_back({0, {VtkMember{}}});
    blocks_ = blocks_of(steps_.front());
    plan_grid();
    add_entries();
    return {};
  }

  const std::vector<DatasetEntry>& entries() const override { return entries_; }

  VolumeResult volume(std::size_t entry, const VoxelComponent& choice) override {
    VtkGridSteps grid = grid_;
    if (steps_.size() > 1 && !choice.step) {
      grid.steps.clear();
      for (const VtkStep& step : steps_) {
        grid.steps.push_back(pieces_of(step));
        grid.times.push_back(step.time);
      }
    } else {
      const auto step = chosen_step(choice);
      if (const auto* const problem = std::get_if<std::string>(&step)) return *problem;
      grid.steps.assign(1, pieces_of(steps_[std::get<std::size_t>(step)]));
    }
    VoxelComponent of_step = choice;
    of_step.step.reset();
    return open_vtk_grid(files_, grid, arrays_[entry], of_step);
  }

  void mesh(std::size_t entry, const VoxelComponent& choice, MeshBuilder& builder) override {
    const auto step = chosen_step(choice);
    if (const auto* const problem = std::get_if<std::string>(&step)) return builder.fail(*problem);
    const std::size_t number = std::get<std::size_t>(step);
    if (steps_.size() > 1 && !choice.step)
      builder.note("step 0 of " + std::to_string(steps_.size()) + " is shown (--time chooses another)");
    TimeSteps steps{{}, number};
    for (const VtkStep& one : steps_) steps.times.push_back(one.time);
    builder.set_steps(std::move(steps));
    const VtkShownArray shown = entry < shown_.size() ? shown_[entry] : VtkShownArray{};
    const std::vector<VtkBlock> blocks = number == 0 ? blocks_ : blocks_of(steps_[number]);
    std::vector<PolyBlock> made;
    for (const VtkBlock& block : blocks) {
      PolyBlock one{blocks.size() > 1 ? block.name : std::string(), {}};
      read_block(block, shown, choice, builder, one.data);
      if (!one.data.points.empty()) made.push_back(std::move(one));
    }
    if (const std::string missing = files_->missing(); !missing.empty())
      made.empty() ? builder.fail(missing) : builder.warn(missing);
    else if (made.empty())
      builder.warn("no points in the file");
    build_poly_blocks(std::move(made), builder);
  }

  /// Returns the files of a surface; see vtk_grid_files().
  std::optional<VtkPartFiles> grid_files(std::size_t entry, const VoxelComponent& choice) {
    const auto step = chosen_step(choice);
    if (is_grid_ || std::holds_alternative<std::string>(step)) return std::nullopt;
    VtkPartFiles grid;
    if (entry < shown_.size()) grid.shown = shown_[entry];
    const std::size_t number = std::get<std::size_t>(step);
    // Maximum number of arrays and pieces in all headers. An index may name one file many times.
    constexpr std::size_t kMostRows = std::size_t{1} << 21;
    std::size_t rows = 0;
    for (const VtkBlock& block : number == 0 ? blocks_ : blocks_of(steps_[number]))
      for (const VtkGridPiece& piece : block.files) {
        const auto file = opened_leaf(piece.path);
        if (!file || file->header.type != "UnstructuredGrid" || !is_whole(file->header)) return std::nullopt;
        grid.files.push_back({piece.path, file->bytes.bytes.size(), file->header});
        std::erase_if(grid.files.back().header.arrays, [&](const VtkArray& array) {
          const bool shown = array.section == grid.shown.section && array.name == grid.shown.name;
          return array.section != VtkSection::points && array.section != VtkSection::cells && !shown &&
                 array.name != kGhostArray && array.name != kOldGhostArray;
        });
        grid.files.back().header.arrays.shrink_to_fit();
        rows += grid.files.back().header.arrays.size() + file->header.pieces.size();
        if (rows > kMostRows) return std::nullopt;
      }
    return files_->missing().empty() ? std::optional(std::move(grid)) : std::nullopt;
  }

 private:
  /// Reports whether a header has all pieces and arrays of its file.
  static bool is_whole(const VtkXmlHeader& header) {
    constexpr std::size_t kMostArrays = 1000;  // of a header
    return header.piece_count == header.pieces.size() && header.arrays.size() < kMostArrays;
  }
  void read_block(const VtkBlock& block, const VtkShownArray& shown, const VoxelComponent& choice, MeshBuilder& builder,
                  PolyData& data) {
    VtkSurfaceReader reader(shown, choice, builder);
    for (const VtkGridPiece& piece : block.files) {
      const auto opened = files_->open(piece.path);
      if (const auto* const problem = std::get_if<std::string>(&opened)) {
        if (piece.path.empty())
          builder.fail(*problem);
        else
          files_->note_missing(piece.path, *problem);
        continue;
      }
      const VtkOpened& file = *std::get<std::shared_ptr<const VtkOpened>>(opened);
      if (file.kind == VtkFileClass::legacy)
        data = read_vtk_legacy(file.bytes.bytes, builder);
      else if (file.kind == VtkFileClass::leaf)
        reader.add(file.bytes, file.header);
    }
    if (data.points.empty()) data = reader.take();
  }

  void add_steps(const VtkOpened& file) {
    for (const VtkMember& member : file.index.members) {
      VtkMember one = member;
      one.file = VtkFiles::path_of(file, member);
      const auto known = std::ranges::find(steps_, member.time, &VtkStep::time);
      if (known != steps_.end())
        known->members.push_back(std::move(one));
      else
        steps_.push_back({member.time, {std::move(one)}});
    }
    std::ranges::stable_sort(steps_, {}, &VtkStep::time);
  }

  /// Returns the pieces of a grid at a time. Without files of pieces, nothing is read.
  [[nodiscard]] std::vector<VtkGridPiece> pieces_of(const VtkStep& step) {
    std::vector<VtkGridPiece> pieces;
    if (!blocks_.front().index) {
      for (const VtkMember& member : step.members) pieces.push_back({member.file, std::nullopt});
      return pieces;
    }
    for (VtkBlock& block : blocks_of(step))
      for (VtkGridPiece& piece : block.files) pieces.push_back(std::move(piece));
    return pieces;
  }
  [[nodiscard]] std::vector<VtkBlock> blocks_of(const VtkStep& step) {
    std::vector<VtkBlock> blocks;
    for (const VtkMember& member : step.members) add_blocks(member.file, member.name, 0, blocks);
    return blocks;
  }
  /// Adds the blocks of a file, and of those that it names.
  void add_blocks(const std::string& path, const std::string& name, int depth, std::vector<VtkBlock>& blocks) {
    constexpr int kMostNested = 8;
    constexpr std::size_t kMostVtkBlocks = 100'000;
    if (depth > kMostNested || blocks.size() >= kMostVtkBlocks) return;
    const auto opened = files_->open(path);
    if (const auto* const problem = std::get_if<std::string>(&opened)) {
      if (!path.empty()) return files_->note_missing(path, *problem);
      blocks.push_back({name, {{path, std::nullopt}}, nullptr});  // reports the problem when it is read
      return;
    }
    const auto& file = std::get<std::shared_ptr<const VtkOpened>>(opened);
    if (file->kind == VtkFileClass::pieces) {
      VtkBlock block{name, {}, file};
      for (const VtkMember& member : file->index.members)
        block.files.push_back({VtkFiles::path_of(*file, member), vtk_extent(member.extent)});
      blocks.push_back(std::move(block));
    } else if (file->kind == VtkFileClass::blocks) {
      for (const VtkMember& member : file->index.members)
        add_blocks(VtkFiles::path_of(*file, member),
                   name.empty() || member.name.empty() ? name + member.name : name + "/" + member.name, depth + 1,
                   blocks);
    } else if (file->kind == VtkFileClass::steps) {
      if (!path.empty()) files_->note_missing(path, "it has time steps of its own; expected data");
    } else {
      blocks.push_back({name, {{path, std::nullopt}}, nullptr});
    }
  }

  /// Finds out whether the first step is a grid that can be shown as a volume.
  void plan_grid() {
    if (blocks_.size() != 1) return;
    const VtkBlock& block = blocks_.front();
    const std::shared_ptr<const VtkOpened> first = block.index ? nullptr : opened_leaf(block.files.front().path);
    const std::string type = block.index ? block.index->index.type : first ? first->header.type : std::string();
    const auto extent = vtk_extent(block.index ? block.index->index.whole_extent
                                   : first     ? whole_extent(first->header)
                                               : std::string());
    if (!extent) return;
    if (type == "ImageData") {
      const VtkGridPlaces places =
          block.index ? vtk_image_places(*extent, block.index->index.origin, block.index->index.spacing,
                                         block.index->index.direction)
                      : vtk_image_places(*extent, first->header.origin, first->header.spacing, first->header.direction);
      grid_.axes = places.axes;
      grid_.directions = places.directions;
    } else if (type == "RectilinearGrid") {
      if (!read_coordinates(block, *extent)) return;
    } else if (type == "StructuredGrid" && first && first->header.pieces.size() == 1) {
      const auto lattice = vtk_lattice_of(*first, *extent, files_->first().budget);
      if (!lattice) return;
      grid_.axes = lattice->axes;
      grid_.directions = lattice->directions;
    } else {
      return;
    }
    grid_.extent = *extent;
    grid_.steps.assign(1, block.files);
    is_grid_ = true;
  }
  static std::string whole_extent(const VtkXmlHeader& header) {
    return header.pieces.size() == 1 && !header.pieces[0].extent.empty() ? header.pieces[0].extent
                                                                         : header.whole_extent;
  }
  [[nodiscard]] std::shared_ptr<const VtkOpened> opened_leaf(const std::string& path) {
    auto opened = files_->open(path);
    auto* const file = std::get_if<std::shared_ptr<const VtkOpened>>(&opened);
    return file && (*file)->kind == VtkFileClass::leaf ? std::move(*file) : nullptr;
  }

  /// Reads the coordinates of a RectilinearGrid from its pieces. Those of missing pieces are spaced evenly.
  bool read_coordinates(const VtkBlock& block, const VtkExtent& extent) {
    constexpr std::int64_t kLongest = std::int64_t{1} << 24;
    std::array<std::vector<double>, 3> all;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::int64_t count = extent[2 * i + 1] - extent[2 * i] + 1;
      if (count > kLongest) return false;
      all[i].assign(static_cast<std::size_t>(count), NAN);
    }
    for (const VtkGridPiece& piece : block.files) {
      const auto file = opened_leaf(piece.path);
      for (std::size_t part = 0; file && part < file->header.pieces.size(); ++part) {
        const std::string& text = file->header.pieces[part].extent;
        const auto here = vtk_extent(text.empty() ? file->header.whole_extent : text);
        if (!here) continue;
        const VtkGridAxes axes = vtk_grid_axes(file->bytes, file->header, part, *here, files_->first().budget);
        for (std::size_t i = 0; axes.problem.empty() && i < 3; ++i)
          for (std::size_t k = 0; k < axes.positions[i].size(); ++k) {
            const std::int64_t at = (*here)[2 * i] + static_cast<std::int64_t>(k) - extent[2 * i];
            if (at >= 0 && static_cast<std::size_t>(at) < all[i].size())
              all[i][static_cast<std::size_t>(at)] = axes.positions[i][k];
          }
      }
    }
    for (std::size_t i = 0; i < 3; ++i) {
      fill_gaps(all[i]);
      grid_.axes[i] = vtk_axis_of(std::move(all[i]));
    }
    return true;
  }
  static void fill_gaps(std::vector<double>& positions) {
    double step = 1;
    for (std::size_t i = 1; i < positions.size(); ++i)
      if (std::isfinite(positions[i] - positions[i - 1])) step = positions[i] - positions[i - 1];
    if (!std::isfinite(positions[0])) {
      const auto known = std::ranges::find_if(positions, [](double one) { return std::isfinite(one); });
      positions[0] = known == positions.end() ? 0 : *known - step * static_cast<double>(known - positions.begin());
    }
    for (std::size_t i = 1; i < positions.size(); ++i)
      if (!std::isfinite(positions[i])) positions[i] = positions[i - 1] + step;
  }

  void add_entries() {
    std::vector<VtkDeclaredArray> arrays;
    std::string point_scalars, cell_scalars, point_normals;
    std::vector<std::string> units;
    const auto add = [&](VtkDeclaredArray array, const std::string& unit) {
      const bool known = std::ranges::any_of(
          arrays, [&](const VtkDeclaredArray& one) { return one.section == array.section && one.name == array.name; });
      if (known || array.name.empty()) return;
      arrays.push_back(std::move(array));
      units.push_back(unit);
    };
    constexpr std::size_t kMostListed = 64;
    constexpr std::size_t kNowhere = std::string::npos;
    std::uint64_t points = 0, cells = 0;
    for (std::size_t i = 0; i < std::min(blocks_.size(), kMostListed); ++i) {
      const VtkBlock& block = blocks_[i];
      if (block.index) {
        point_scalars = block.index->index.point_scalars;
        cell_scalars = block.index->index.cell_scalars;
        for (const VtkDeclaredArray& array : block.index->index.arrays) add(array, {});
        continue;
      }
      const auto file = opened_leaf(block.files.front().path);
      if (!file) continue;
      const VtkXmlHeader& header = file->header;
      if (i == 0) {
        point_scalars = header.point_scalars;
        cell_scalars = header.cell_scalars;
        point_normals = header.point_normals;
      }
      for (const VtkArray& array : header.arrays)
        if (array.section == VtkSection::point_data || array.section == VtkSection::cell_data)
          add({array.section, array.name, array.type, array.components}, array.units);
      for (const VtkPiece& piece : header.pieces) {
        points += piece.points;
        cells += piece.cells + piece.vertices + piece.lines + piece.strips + piece.polygons;
      }
    }
    grid_.arrays = arrays;
    for (std::size_t i = 0; i < arrays.size(); ++i) {
      const VtkDeclaredArray& array = arrays[i];
      const bool of_points = array.section == VtkSection::point_data;
      const auto type = vtk_type_of(array.type);
      DatasetEntry entry;
      entry.path = (of_points ? "/PointData/" : "/CellData/") + array.name;
      entry.type = type ? number_name(*type) : array.type.substr(0, 40);
      if (array.components > 1) entry.type = std::to_string(array.components) + " x " + entry.type;
      entry.unit = units[i];
      if (is_grid_)
        entry.shape = vtk_grid_shape(grid_, array.section);
      else if (const std::uint64_t rows = of_points ? points : cells; rows > 0)
        entry.shape = {rows};
      entry.note = of_points ? "data of points" : "data of cells";
      if (steps_.size() > 1) entry.note += ", " + std::to_string(steps_.size()) + " steps";
      if (type && array.components > 0) entry.form = is_grid_ ? DatasetForm::volume : DatasetForm::mesh;
      const bool active = array.name == (of_points ? point_scalars : cell_scalars);
      const bool normals =
          array.components == 3 && (array.name == point_normals || lower_case(array.name).find("normals") != kNowhere);
      entry.is_minor = is_bookkeeping(array.name) || normals;
      const bool whole = type && *type != StoredType::f32 && *type != StoredType::f64;
      // Prefer arrays of points to arrays of cells, and floats to integers: those are usually results.
      entry.rank =
          entry.is_minor ? 2 : (of_points ? 20 : 10) + (active ? 5 : (array.components == 1 ? 2 : 0) + (whole ? 0 : 1));
      entries_.push_back(std::move(entry));
      shown_.push_back({array.section, array.name});
      arrays_.push_back(i);
    }
    if (is_grid_) return;
    DatasetEntry mesh;
    mesh.path = "/mesh";
    mesh.type = "mesh";
    if (points > 0) mesh.shape = {points};
    mesh.form = DatasetForm::mesh;
    mesh.note = "the mesh without data";
    if (blocks_.size() > 1) mesh.note += ", " + std::to_string(blocks_.size()) + " blocks";
    mesh.is_minor = !entries_.empty();
    mesh.rank = 3;  // before bookkeeping
    entries_.push_back(std::move(mesh));
    shown_.emplace_back();
  }

  [[nodiscard]] std::variant<std::size_t, std::string> chosen_step(const VoxelComponent& choice) const {
    const qnv::ShownStep wanted = choice.step.value_or(qnv::ShownStep());
    std::vector<double> times;
    for (const VtkStep& step : steps_) times.push_back(step.time);
    const std::size_t number = wanted.time ? qnv::step_number(wanted, times) : wanted.number;
    if (number < steps_.size()) return number;
    return "no step " + std::to_string(number) + "; expected 0 to " + std::to_string(steps_.size() - 1);
  }

  std::shared_ptr<VtkFiles> files_;
  std::vector<VtkStep> steps_;
  std::vector<VtkBlock> blocks_;  // of the first step
  bool is_grid_ = false;
  VtkGridSteps grid_;  // of the first step, if it is a grid
  std::vector<DatasetEntry> entries_;
  std::vector<VtkShownArray> shown_;  // one per entry
  std::vector<std::size_t> arrays_;   // in grid_.arrays, one per entry with an array
};

}  // namespace

bool is_vtk_datasets(std::span<const std::byte> bytes) {
  const VtkFileClass kind = vtk_class_of(bytes);
  return kind != VtkFileClass::other && kind != VtkFileClass::legacy;
}

bool needs_module_for_vtk(std::span<const std::byte> bytes) {
  const VtkFileClass kind = vtk_class_of(bytes);
  if (kind != VtkFileClass::leaf) return kind != VtkFileClass::other && kind != VtkFileClass::legacy;
  const std::string_view head = text_of(bytes).substr(0, 4096);
  return head.find("vtkLZ4DataCompressor") != std::string_view::npos ||
         head.find("vtkLZMADataCompressor") != std::string_view::npos;
}

std::optional<std::string> unpack_vtk_block(VtkPacking packing, std::span<const std::byte> from,
                                            std::span<std::byte> to) {
  const auto module = dataset_module();
  if (const auto* const problem = std::get_if<std::string>(&module)) return *problem;
  const bool lz4 = packing == VtkPacking::lz4;
  if (std::get<const DatasetModule*>(module)->unpack(lz4 ? ChunkCodec::lz4_block : ChunkCodec::xz, from, to))
    return std::nullopt;
  return std::string("a block is not valid ") + (lz4 ? "LZ4" : "LZMA") + " data";
}

std::optional<VtkPartFiles> vtk_grid_files(const VolumeFile& file) {
  VtkDataFile opened(file);
  if (!opened.list().empty()) return std::nullopt;
  const auto entry = choose_dataset(opened.entries(), file.component.dataset);
  const auto* const number = std::get_if<std::size_t>(&entry);
  return number ? opened.grid_files(*number, file.component) : std::nullopt;
}

DatasetFileResult open_vtk_datasets(const VolumeFile& file) {
  auto made = std::make_unique<VtkDataFile>(file);
  if (std::string problem = made->list(); !problem.empty()) return problem;
  return std::unique_ptr<DatasetFile>(std::move(made));
}

}  // namespace gs::app
