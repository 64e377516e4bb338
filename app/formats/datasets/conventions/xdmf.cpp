#include "app/formats/datasets/conventions/xdmf.h"

#include "app/formats/datasets/arrays/classic_netcdf.h"
#include "app/formats/datasets/arrays/dataset_module.h"
#include "app/formats/datasets/conventions/conventions_table.h"
#include "app/formats/datasets/conventions/mesh_arrays.h"
#include "app/formats/datasets/conventions/xdmf_tree.h"
#include "app/formats/vtk/grid_cells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

// XDMF: XML that names arrays of HDF5 files. https://www.xdmf.org/index.php/XDMF_Model_and_Format

namespace gs::app {
namespace {

constexpr std::uint64_t kMostXdmfNumbers = std::uint64_t{1} << 40;
constexpr std::uint8_t kVtkHexahedron = 12, kVtkQuad = 9;

/// Grid at one time: its parts, which may be several.
struct XdmfStep {
  double time = 0;
  std::vector<const XdmfElement*> grids;
};

struct XdmfTopology {
  std::string_view name;  // lower case, without numbers of nodes
  std::uint8_t vtk;       // type of the cells (vtkCellType.h)
  std::size_t nodes;      // of a cell; 0 if the file states it
  int mixed;              // number in mixed topologies; -1 if none
};
constexpr XdmfTopology kTopologies[] = {{"polyvertex", 2, 0, 1},        {"polyline", 4, 0, 2},
                                        {"polygon", 7, 0, 3},           {"triangle", 5, 3, 4},
                                        {"quadrilateral", 9, 4, 5},     {"tetrahedron", 10, 4, 6},
                                        {"pyramid", 14, 5, 7},          {"wedge", 13, 6, 8},
                                        {"hexahedron", 12, 8, 9},       {"edge_3", 21, 3, 34},
                                        {"triangle_6", 22, 6, 36},      {"quadrilateral_8", 23, 8, 37},
                                        {"quadrilateral_9", 28, 9, 35}, {"tetrahedron_10", 24, 10, 38},
                                        {"pyramid_13", 27, 13, 39},     {"wedge_15", 26, 15, 40},
                                        {"wedge_18", 32, 18, 41},       {"hexahedron_20", 25, 20, 48},
                                        {"hexahedron_24", 25, 24, 49},  {"hexahedron_27", 29, 27, 50}};

std::vector<std::uint64_t> sizes_of(const std::string& text) {
  std::vector<std::uint64_t> sizes;
  for (const double number : numbers_of(text, 8))
    if (number >= 0 && number < 1e15) sizes.push_back(static_cast<std::uint64_t>(number));
  return sizes;
}

std::uint64_t product_of(std::span<const std::uint64_t> sizes) {
  std::uint64_t all = 1;
  for (const std::uint64_t size : sizes) {
    if (size != 0 && all > kMostXdmfNumbers / size) return kMostXdmfNumbers;
    all *= size;
  }
  return all;
}

class XdmfFile final : public DatasetFile {
 public:
  XdmfFile(VolumeFile file, std::unique_ptr<XdmfElement> root) : file_(std::move(file)), root_(std::move(root)) {}

  /// Lists grids and attributes. Returns an empty text, or a message.
  std::string list() {
    const XdmfElement* const domain = root_->child("Domain");
    if (!domain) return "it has no Domain";
    for (const auto& child : domain->children)
      if (child->name == "Grid") add_grid_tree(*child, 0);
    std::ranges::stable_sort(steps_, {}, &XdmfStep::time);
    if (steps_.empty()) return "it has no Grid with Topology and Geometry";
    add_entries(steps_.front());
    return {};
  }

  const std::vector<DatasetEntry>& entries() const override { return entries_; }

  VolumeResult volume(std::size_t entry, const VoxelComponent& choice) override {
    if (!choice.step && steps_.size() > 1) {
      std::vector<qnv::VolumeSource> all;
      std::vector<double> times;
      for (const XdmfStep& step : steps_) {
        VolumeResult made = volume_of(step, entry, choice);
        if (auto* const problem = std::get_if<std::string>(&made)) return std::move(*problem);
        all.push_back(std::move(std::get<qnv::VolumeSource>(made)));
        times.push_back(step.time);
      }
      qnv::VolumeSource source = all.front();
      source.steps = std::move(all);
      source.times = std::move(times);
      return source;
    }
    const auto step = chosen_step(choice);
    if (const auto* const problem = std::get_if<std::string>(&step)) return *problem;
    return volume_of(steps_[std::get<std::size_t>(step)], entry, choice);
  }

  void mesh(std::size_t entry, const VoxelComponent& choice, MeshBuilder& builder) override {
    const auto step = chosen_step(choice);
    if (const auto* const problem = std::get_if<std::string>(&step)) return builder.fail(*problem);
    TimeSteps all{{}, std::get<std::size_t>(step)};
    for (const XdmfStep& one : steps_) all.times.push_back(one.time);
    builder.set_steps(std::move(all));
    if (steps_.size() > 1 && !choice.step)
      builder.note("step 0 of " + std::to_string(steps_.size()) + " is shown (--time chooses another)");
    PolyData data;
    GridCells grid;
    for (const XdmfElement* const one : steps_[std::get<std::size_t>(step)].grids)
      if (!add_mesh(*one, entry, data, grid, builder)) return;
    if (data.points.empty()) return builder.warn("no points in the file");
    finish(data.of_points, data.points.size());
    finish(data.of_cells, grid.types.size());
    if (!grid.types.empty()) add_grid(grid, data, builder);
    build_poly_data(std::move(data), builder);
  }

 private:
  static void finish(PolyData::Data& data, std::size_t count) {
    if (!data.values.empty()) data.values.resize(count, NAN);
  }

  void add_grid_tree(const XdmfElement& grid, int depth) {
    constexpr int kMostNested = 16;
    constexpr std::size_t kMostGrids = 100'000;
    if (depth > kMostNested || steps_.size() > kMostGrids) return;
    const std::string kind = lower_case(grid.attribute("GridType"));
    if (kind != "collection" && kind != "tree") {
      const auto children = xdmf_children(*root_, grid);
      const auto has = [&](std::string_view name) {
        return std::ranges::any_of(children, [&](const XdmfElement* one) { return one->name == name; });
      };
      if (has("Topology") && has("Geometry")) add_step(time_of(grid), {&grid});
      return;
    }
    const bool series = lower_case(grid.attribute("CollectionType")) == "temporal";
    if (series || kind == "tree") {
      for (const auto& child : grid.children)
        if (child->name == "Grid") add_grid_tree(*child, depth + 1);
      return;
    }
    std::vector<const XdmfElement*> parts;
    for (const auto& child : grid.children)
      if (child->name == "Grid" && lower_case(child->attribute("GridType")) != "collection")
        parts.push_back(child.get());
    if (!parts.empty()) add_step(time_of(grid), std::move(parts));
  }

  [[nodiscard]] double time_of(const XdmfElement& grid) const {
    const XdmfElement* const time = grid.child("Time");
    const std::vector<double> numbers = time ? numbers_of(time->attribute("Value"), 1) : std::vector<double>();
    return numbers.empty() ? static_cast<double>(steps_.size()) : numbers.front();
  }
  /// Adds a step. A single grid outside of a series is left out if steps of a series refer to it.
  void add_step(double time, std::vector<const XdmfElement*> grids) {
    const bool in_collection = grids.front()->parent && grids.front()->parent->name == "Grid";
    if (!in_collection && !steps_.empty() && steps_.front().grids.front()->parent->name == "Grid") return;
    steps_.push_back({time, std::move(grids)});
  }

  static std::string attribute_path(const XdmfElement& grid, const XdmfElement& attribute) {
    const std::string name = grid.attribute("Name");
    return "/" + (name.empty() ? "grid" : name) + "/" + attribute.attribute("Name");
  }
  [[nodiscard]] const XdmfElement* part_of(const XdmfElement& grid, std::string_view name) const {
    for (const XdmfElement* const child : xdmf_children(*root_, grid))
      if (child->name == name) return child;
    return nullptr;
  }
  static bool is_regular(const XdmfElement& topology) {
    const std::string kind = lower_case(topology.attribute("TopologyType") + topology.attribute("Type"));
    return kind == "3dcorectmesh" || kind == "2dcorectmesh" || kind == "3drectmesh" || kind == "2drectmesh";
  }

  void add_entries(const XdmfStep& step) {
    const XdmfElement& grid = *step.grids.front();
    const XdmfElement* const topology = part_of(grid, "Topology");
    const bool regular = is_regular(*topology);
    for (const XdmfElement* const child : xdmf_children(*root_, grid)) {
      const XdmfElement* const item = child->child("DataItem");
      if (child->name != "Attribute" || !item) continue;
      DatasetEntry entry;
      entry.path = attribute_path(grid, *child);
      entry.shape = sizes_of(item->attribute("Dimensions"));
      const std::string type = item->attribute("NumberType") + item->attribute("DataType");
      entry.type =
          lower_case(type.empty() ? "Float" : type) +
          (item->attribute("Precision").empty() ? "" : std::to_string(8 * sizes_or(item->attribute("Precision"), 4)));
      entry.unit = child->attribute("Unit");
      const std::string centre = lower_case(child->attribute("Center"));
      const bool of_cells = centre == "cell", of_points = centre.empty() || centre == "node";
      entry.form = regular ? DatasetForm::volume : of_cells || of_points ? DatasetForm::mesh : DatasetForm::nothing;
      entry.note = of_cells ? "data of cells" : "data of points";
      const bool single = lower_case(child->attribute("AttributeType")) != "vector";
      entry.rank = is_bookkeeping(entry.path) ? 1 : (of_points ? 10 : 5) + (single ? 2 : 0);
      entries_.push_back(std::move(entry));
      attributes_.push_back(child->attribute("Name"));
    }
    if (entries_.empty() && !regular) {
      DatasetEntry entry;
      entry.path = "/" + grid.attribute("Name");
      entry.type = "mesh";
      entry.form = DatasetForm::mesh;
      entry.note = "the mesh without data";
      entries_.push_back(std::move(entry));
      attributes_.emplace_back();
    }
  }
  static std::uint64_t sizes_or(const std::string& text, std::uint64_t otherwise) {
    const auto sizes = sizes_of(text);
    return sizes.empty() || sizes[0] > 16 ? otherwise : sizes[0];
  }

  [[nodiscard]] std::variant<std::size_t, std::string> chosen_step(const VoxelComponent& choice) const {
    const qnv::ShownStep wanted = choice.step.value_or(qnv::ShownStep());
    std::vector<double> times;
    for (const XdmfStep& step : steps_) times.push_back(step.time);
    if (choice.found && times.size() > 1) choice.found->times = times;
    const std::size_t number = wanted.time ? qnv::step_number(wanted, times) : wanted.number;
    if (number < steps_.size()) return number;
    return "no step " + std::to_string(number) + "; expected 0 to " + std::to_string(steps_.size() - 1);
  }

  /// Array that a DataItem names: a file with its path, or numbers in the text.
  struct HeavyArray {
    DatasetTree* tree = nullptr;
    std::string path;
  };

  std::variant<HeavyArray, std::string> heavy_array(const XdmfElement& item) {
    const std::string text(trimmed_text(item.text));
    const std::size_t colon = text.rfind(":/");
    if (colon == std::string::npos) return "a DataItem names no array; expected FILE:/PATH";
    const std::string name = text.substr(0, colon);
    auto found = trees_.find(name);
    if (found == trees_.end()) {
      constexpr std::size_t kMostFiles = 1000;
      if (trees_.size() >= kMostFiles) return std::string("it names too many files");
      BytesResult loaded = load_beside(file_, name);
      if (auto* const problem = std::get_if<std::string>(&loaded)) return std::move(*problem);
      const auto& bytes = std::get<SharedBytes>(loaded);
      constexpr std::size_t kCache = std::size_t{16} << 20;
      ArrayFileResult opened = open_with_module("HDF5", bytes, kCache);
      if (auto* const problem = std::get_if<std::string>(&opened)) return name + ": " + *problem;
      found = trees_
                  .emplace(name, std::make_unique<DatasetTree>(std::get<std::shared_ptr<ArrayFile>>(std::move(opened)),
                                                               bytes, file_.budget))
                  .first;
    }
    HeavyArray array{found->second.get(), text.substr(colon + 1)};
    if (!array.tree->find(array.path)) return name + " has no dataset " + array.path;
    return array;
  }
  static std::string_view trimmed_text(std::string_view text) {
    while (!text.empty() && static_cast<unsigned char>(text.front()) <= ' ') text.remove_prefix(1);
    while (!text.empty() && static_cast<unsigned char>(text.back()) <= ' ') text.remove_suffix(1);
    return text;
  }

  /// Reads the numbers of the DataItem in an element.
  std::variant<std::vector<double>, std::string> numbers_in(const XdmfElement& parent) {
    const XdmfElement* const item = parent.child("DataItem");
    if (!item) return parent.name + " has no DataItem";
    const std::string kind = lower_case(item->attribute("ItemType"));
    if (!kind.empty() && kind != "uniform")
      return "DataItems of the type " + kind.substr(0, 40) + " are not read; expected Uniform";
    const std::string format = lower_case(item->attribute("Format"));
    if (format == "hdf" || format == "hdf5" || format == "h5") {
      auto heavy = heavy_array(*item);
      if (auto* const problem = std::get_if<std::string>(&heavy)) return std::move(*problem);
      const auto& array = std::get<HeavyArray>(heavy);
      return array.tree->values(array.path);
    }
    if (!format.empty() && format != "xml")
      return "DataItems in the format " + format.substr(0, 40) + " are not read; expected HDF or XML";
    return numbers_of(item->text, item->text.size());
  }

  VolumeResult volume_of(const XdmfStep& step, std::size_t entry, const VoxelComponent& choice) {
    const XdmfElement& grid = *step.grids.front();
    const XdmfElement *const topology = part_of(grid, "Topology"), *const geometry = part_of(grid, "Geometry");
    const XdmfElement* const attribute = attribute_of(grid, entry);
    if (!attribute || !attribute->child("DataItem")) return entries_[entry].path + " has no DataItem at this time";
    auto heavy = heavy_array(*attribute->child("DataItem"));
    if (auto* const problem = std::get_if<std::string>(&heavy)) return std::move(*problem);
    DatasetTree& tree = *std::get<HeavyArray>(heavy).tree;
    const ArrayInfo& array = *tree.find(std::get<HeavyArray>(heavy).path);
    GridSpec spec;
    spec.arrays = {*tree.index_of(array.path)};
    spec.path = entries_[entry].path;
    spec.unit = entries_[entry].unit;
    spec.title = attributes_[entry];
    const std::string kind = lower_case(topology->attribute("TopologyType") + topology->attribute("Type"));
    const std::size_t space = kind.starts_with("2d") ? 2 : 3, rank = array.shape.size();
    if (rank < space || rank > space + 2)
      return spec.path + " has " + std::to_string(rank) + " axes; expected " + std::to_string(space);
    spec.axes.resize(rank);
    const bool vector =
        rank > space && lower_case(attribute->attribute("AttributeType")) != "scalar" && array.shape.back() <= 9;
    const std::size_t lead = rank - space - (vector ? 1 : 0);
    if (vector) spec.axes.back().role = AxisRole::component;
    const bool of_cells = lower_case(attribute->attribute("Center")) == "cell";
    std::vector<std::vector<double>> items;
    for (const auto& child : geometry->children)
      if (child->name == "DataItem") {
        XdmfElement one;
        one.name = "Geometry";
        one.children.push_back(std::make_unique<XdmfElement>());
        one.children.back()->name = "DataItem";
        one.children.back()->attributes = child->attributes;
        one.children.back()->text = child->text;
        auto numbers = numbers_in(one);
        if (auto* const problem = std::get_if<std::string>(&numbers)) return std::move(*problem);
        items.push_back(std::move(std::get<std::vector<double>>(numbers)));
      }
    for (std::size_t i = 0; i < space; ++i) {
      GridAxis& axis = spec.axes[lead + i];
      axis.role = static_cast<AxisRole>(space - 1 - i);
      if (kind.ends_with("corectmesh")) {
        // Origin and spacing have the order z, y, x.
        if (items.size() > 0 && i < items[0].size()) axis.first = items[0][i];
        if (items.size() > 1 && i < items[1].size()) axis.step = items[1][i];
        if (of_cells) axis.first += axis.step / 2;
      } else if (const std::size_t at = space - 1 - i; at < items.size()) {
        std::vector<double> places = items[at];
        if (of_cells && places.size() > 1) {
          for (std::size_t k = 0; k + 1 < places.size(); ++k) places[k] = (places[k] + places[k + 1]) / 2;
          places.pop_back();
        }
        if (places.size() == array.shape[lead + i] && !places.empty()) {
          axis.first = places.front();
          if (is_even(places) && places.size() > 1)
            axis.step = (places.back() - places.front()) / static_cast<double>(places.size() - 1);
          else if (places.size() > 1)
            axis.positions = std::move(places);
        }
      }
    }
    VoxelComponent one = choice;
    one.step.reset();
    return open_grid(tree, std::move(spec), one);
  }

  [[nodiscard]] const XdmfElement* attribute_of(const XdmfElement& grid, std::size_t entry) const {
    for (const XdmfElement* const child : xdmf_children(*root_, grid))
      if (child->name == "Attribute" && child->attribute("Name") == attributes_[entry]) return child;
    return nullptr;
  }

  bool add_mesh(const XdmfElement& grid, std::size_t entry, PolyData& data, GridCells& cells, MeshBuilder& builder) {
    const XdmfElement *const topology = part_of(grid, "Topology"), *const geometry = part_of(grid, "Geometry");
    const auto fail = [&](std::string why) {
      builder.fail(std::move(why));
      return false;
    };
    if (!topology || !geometry) return fail("a Grid has no Topology or no Geometry");
    const std::string places = lower_case(geometry->attribute("GeometryType") + geometry->attribute("Type"));
    const std::size_t parts = places == "xy" ? 2 : 3;
    if (!places.empty() && places != "xyz" && places != "xy")
      return fail("the geometry is " + places.substr(0, 40) + "; expected XYZ or XY");
    auto read = numbers_in(*geometry);
    if (auto* const problem = std::get_if<std::string>(&read)) return fail(std::move(*problem));
    const auto& points = std::get<std::vector<double>>(read);
    const std::size_t first = data.points.size(), first_cell = cells.types.size();
    builder.draw(points.size() / parts * sizeof(glm::vec3));
    append_points(points, parts, data.points);
    if (std::string problem = add_topology(*topology, first, data.points.size() - first, cells, builder);
        !problem.empty())
      return fail(std::move(problem));
    const XdmfElement* const attribute = attribute_of(grid, entry);
    if (!attribute || attributes_[entry].empty()) return true;
    auto values = numbers_in(*attribute);
    if (auto* const problem = std::get_if<std::string>(&values)) return fail(std::move(*problem));
    const bool of_cells = lower_case(attribute->attribute("Center")) == "cell";
    PolyData::Data& shown = of_cells ? data.of_cells : data.of_points;
    const std::size_t rows = of_cells ? cells.types.size() - first_cell : data.points.size() - first;
    const auto& numbers = std::get<std::vector<double>>(values);
    const std::size_t each = rows > 0 ? numbers.size() / rows : 0;
    if (each == 0 || each > 64) return true;
    builder.draw(rows * sizeof(float));
    if (shown.title.empty()) set_title(attributes_[entry], each, entries_[entry].unit, builder.choice(), shown);
    shown.values.resize(of_cells ? first_cell : first, NAN);
    append_values(std::span(numbers).first(rows * each), each, builder.choice(), shown);
    return true;
  }

  std::string add_topology(const XdmfElement& topology, std::size_t first, std::size_t points, GridCells& cells,
                           MeshBuilder& builder) {
    const std::string kind = lower_case(topology.attribute("TopologyType") + topology.attribute("Type"));
    if (kind == "3dsmesh" || kind == "2dsmesh") return add_structured(topology, first, points, cells, builder);
    auto read = numbers_in(topology);
    if (auto* const problem = std::get_if<std::string>(&read)) return std::move(*problem);
    const auto& ids = std::get<std::vector<double>>(read);
    const std::vector<double> base = numbers_of(topology.attribute("BaseOffset"), 1);
    const double start = base.empty() ? 0 : base.front();
    builder.draw(ids.size() * (sizeof(std::int32_t) + sizeof(std::size_t) + 1));
    const auto add_cell = [&](std::uint8_t type, std::span<const double> corners) {
      for (const double corner : corners) {
        const std::int32_t index = index_below(corner - start, points);
        cells.cells.corners.push_back(index == kBadIndex ? index : index + static_cast<std::int32_t>(first));
      }
      cells.cells.ends.push_back(cells.cells.corners.size());
      cells.types.push_back(type);
    };
    if (kind == "mixed") {
      for (std::size_t at = 0; at < ids.size();) {
        const auto* const row = std::ranges::find(kTopologies, static_cast<int>(ids[at]), &XdmfTopology::mixed);
        if (row == std::end(kTopologies))
          return "a mixed topology has the unknown type " + std::to_string(static_cast<int>(ids[at]));
        ++at;
        double nodes = static_cast<double>(row->nodes);
        if (row->nodes == 0) {
          if (at >= ids.size()) break;
          nodes = ids[at++];
        }
        if (!(nodes >= 0 && nodes <= static_cast<double>(ids.size() - at))) return "a mixed topology ends early";
        add_cell(row->vtk, std::span(ids).subspan(at, static_cast<std::size_t>(nodes)));
        at += static_cast<std::size_t>(nodes);
      }
      return {};
    }
    const auto* const row = std::ranges::find(kTopologies, kind, &XdmfTopology::name);
    if (row == std::end(kTopologies))
      return "the topology is '" + kind.substr(0, 40) + "'; expected Triangle, Tetrahedron, Mixed or similar";
    std::size_t nodes = row->nodes;
    if (nodes == 0) {
      const auto stated = sizes_of(topology.attribute("NodesPerElement"));
      nodes = !stated.empty() && stated[0] > 0 && stated[0] <= ids.size() ? static_cast<std::size_t>(stated[0]) : 1;
    }
    for (std::size_t at = 0; at + nodes <= ids.size(); at += nodes)
      add_cell(row->vtk, std::span(ids).subspan(at, nodes));
    return {};
  }

  static std::string add_structured(const XdmfElement& topology, std::size_t first, std::size_t points,
                                    GridCells& cells, MeshBuilder& builder) {
    std::vector<std::uint64_t> sizes =
        sizes_of(topology.attribute("Dimensions") + topology.attribute("NumberOfElements"));
    while (sizes.size() < 3) sizes.insert(sizes.begin(), 1);
    if (sizes.size() != 3 || product_of(sizes) != points)
      return "the sizes of a structured mesh are not those of its points";
    const std::size_t nx = sizes[2], ny = sizes[1], nz = sizes[0];
    builder.draw(points * (8 * sizeof(std::int32_t) + sizeof(std::size_t) + 1));
    const auto at = [&](std::size_t x, std::size_t y, std::size_t z) {
      return static_cast<std::int32_t>(first + (z * ny + y) * nx + x);
    };
    for (std::size_t z = 0; z + (nz > 1 ? 1 : 0) < nz; ++z)
      for (std::size_t y = 0; y + 1 < ny; ++y)
        for (std::size_t x = 0; x + 1 < nx; ++x) {
          for (std::size_t up = 0; up < (nz > 1 ? 2u : 1u); ++up)
            for (const std::int32_t corner :
                 {at(x, y, z + up), at(x + 1, y, z + up), at(x + 1, y + 1, z + up), at(x, y + 1, z + up)})
              cells.cells.corners.push_back(corner);
          cells.cells.ends.push_back(cells.cells.corners.size());
          cells.types.push_back(nz > 1 ? kVtkHexahedron : kVtkQuad);
        }
    return {};
  }

  VolumeFile file_;
  std::unique_ptr<XdmfElement> root_;
  std::vector<XdmfStep> steps_;
  std::vector<DatasetEntry> entries_;
  std::vector<std::string> attributes_;  // names, one per entry
  std::map<std::string, std::unique_ptr<DatasetTree>> trees_;
};

}  // namespace

bool is_xdmf(std::span<const std::byte> bytes) {
  constexpr std::size_t kHead = 2048;
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), std::min(bytes.size(), kHead));
  const std::size_t mark = text.find("<Xdmf");
  if (mark == std::string_view::npos) return false;
  const std::string_view before = text.substr(0, mark);
  return before.empty() || before.find_first_not_of(" \t\r\n\xef\xbb\xbf") == std::string_view::npos ||
         before.find("<?xml") != std::string_view::npos || before.find("<!") != std::string_view::npos;
}

DatasetFileResult open_xdmf_file(const VolumeFile& file) {
  auto parsed = parse_xdmf(file.content.bytes);
  if (auto* const problem = std::get_if<std::string>(&parsed)) return std::move(*problem);
  auto made = std::make_unique<XdmfFile>(file, std::get<std::unique_ptr<XdmfElement>>(std::move(parsed)));
  if (std::string problem = made->list(); !problem.empty()) return problem;
  return std::unique_ptr<DatasetFile>(std::move(made));
}

}  // namespace gs::app
