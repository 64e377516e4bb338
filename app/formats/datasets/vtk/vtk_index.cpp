#include "app/formats/datasets/vtk/vtk_index.h"

#include "app/formats/datasets/conventions/xdmf_tree.h"
#include "base/text.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

// Layouts: https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html and
// https://www.paraview.org/Wiki/ParaView/Data_formats (PVD, .series).

namespace gs::app {
namespace {

constexpr std::size_t kMostMembers = 200'000, kMostNameBytes = 4096;
constexpr std::string_view kLeafTypes[] = {"ImageData", "RectilinearGrid", "StructuredGrid", "PolyData",
                                           "UnstructuredGrid"};
constexpr std::string_view kBlockTypes[] = {
    "vtkMultiBlockDataSet",  "vtkMultiPieceDataSet", "vtkPartitionedDataSet",     "vtkPartitionedDataSetCollection",
    "vtkOverlappingAMR",     "vtkNonOverlappingAMR", "vtkHierarchicalBoxDataSet", "vtkMultiGroupDataSet",
    "vtkHierarchicalDataSet"};
constexpr std::string_view kLegacyVtkMark = "# vtk DataFile";

/// Returns the type that the root element states in the first bytes of a file; empty if it is no VTK XML.
std::string stated_type(std::span<const std::byte> bytes) {
  for (const std::string_view type : kLeafTypes) {
    if (is_vtk_xml(bytes, type)) return std::string(type);
    if (const std::string pieces = "P" + std::string(type); is_vtk_xml(bytes, pieces)) return pieces;
  }
  for (const std::string_view type : kBlockTypes)
    if (is_vtk_xml(bytes, type)) return std::string(type);
  return is_vtk_xml(bytes, "Collection") ? "Collection" : "";
}

bool is_json_series(std::span<const std::byte> bytes) {
  constexpr std::size_t kHead = 4096;
  const std::string_view text = text_of(bytes).substr(0, kHead);
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  return first != std::string_view::npos && text[first] == '{' &&
         text.find("\"file-series-version\"") != std::string_view::npos;
}

class IndexReader {
 public:
  explicit IndexReader(const XdmfElement& root) : root_(root) {}

  std::variant<VtkIndex, std::string> read() {
    const std::string type = root_.attribute("type");
    if (type == "Collection") {
      index_.kind = VtkFileClass::steps;
      add_steps(root_);
    } else if (std::ranges::find(kBlockTypes, type) != std::end(kBlockTypes)) {
      index_.kind = VtkFileClass::blocks;
      add_blocks(root_, {});
    } else if (type.starts_with('P') &&
               std::ranges::find(kLeafTypes, std::string_view(type).substr(1)) != std::end(kLeafTypes)) {
      index_.kind = VtkFileClass::pieces;
      index_.type = type.substr(1);
      add_pieces();
    } else {
      return "the VTKFile is of the type '" + type.substr(0, 80) + "'; expected one that names files";
    }
    if (index_.members.empty()) return std::string("it names no files");
    return std::move(index_);
  }

 private:
  static std::string short_name(std::string name) { return name.substr(0, kMostNameBytes); }
  void add(VtkMember member) {
    if (!member.file.empty() && member.file.size() <= kMostNameBytes && index_.members.size() < kMostMembers)
      index_.members.push_back(std::move(member));
  }
  void add_steps(const XdmfElement& element) {
    for (const auto& child : element.children) {
      if (child->name != "DataSet") {
        add_steps(*child);
        continue;
      }
      const std::vector<double> time = numbers_of(child->attribute("timestep"), 1);
      std::string name = child->attribute("name");
      if (name.empty()) name = child->attribute("group");
      if (name.empty() && !child->attribute("part").empty()) name = "part " + child->attribute("part");
      add({child->attribute("file"),
           short_name(std::move(name)),
           {},
           time.empty() || !std::isfinite(time[0]) ? 0 : time[0]});
    }
  }
  void add_blocks(const XdmfElement& element, const std::string& within) {
    for (const auto& child : element.children) {
      std::string name = child->attribute("name");
      if (name.empty() && !child->attribute("index").empty()) name = child->attribute("index");
      if (name.empty()) name = child->attribute("dataset");
      if (!within.empty() && !name.empty()) name.insert(0, within + "/");
      if (name.empty()) name = within;
      name = short_name(std::move(name));
      if (const std::string file = child->attribute("file"); !file.empty()) add({file, name, {}, 0});
      add_blocks(*child, name);
    }
  }
  void add_pieces() {
    const XdmfElement* const dataset = root_.child("P" + index_.type);
    if (!dataset) return;
    index_.whole_extent = dataset->attribute("WholeExtent");
    index_.origin = dataset->attribute("Origin");
    index_.spacing = dataset->attribute("Spacing");
    index_.direction = dataset->attribute("Direction");
    for (const auto& child : dataset->children) {
      if (child->name == "Piece") add({child->attribute("Source"), {}, child->attribute("Extent"), 0});
      const bool of_points = child->name == "PPointData";
      if (!of_points && child->name != "PCellData") continue;
      (of_points ? index_.point_scalars : index_.cell_scalars) = child->attribute("Scalars");
      for (const auto& array : child->children) {
        constexpr std::size_t kMostArrays = 1000;
        if (array->name.find("DataArray") == std::string::npos || index_.arrays.size() >= kMostArrays) continue;
        const std::vector<double> components = numbers_of(array->attribute("NumberOfComponents"), 1);
        const bool good = !components.empty() && components[0] >= 1 && components[0] <= 1e6;
        index_.arrays.push_back({of_points ? VtkSection::point_data : VtkSection::cell_data,
                                 short_name(array->attribute("Name")), lower_case(array->attribute("type")),
                                 good ? static_cast<std::uint64_t>(components[0]) : 1});
      }
    }
  }

  const XdmfElement& root_;
  VtkIndex index_;
};

std::variant<VtkIndex, std::string> read_json_series(std::span<const std::byte> bytes) {
  using Json = nlohmann::json;
  constexpr std::size_t kMostBytes = std::size_t{64} << 20;
  constexpr int kMostSeriesDepth = 16;
  if (bytes.size() > kMostBytes) return std::string("the series is too large");
  int depth = 0;
  const Json::parser_callback_t limit = [&](int at, Json::parse_event_t, Json&) {
    depth = std::max(depth, at);
    return at < kMostSeriesDepth;
  };
  const std::string_view text = text_of(bytes);
  const Json parsed = Json::parse(text.begin(), text.end(), limit, false);
  if (parsed.is_discarded() || depth >= kMostSeriesDepth || !parsed.is_object())
    return std::string("it is no valid JSON; expected an object with the list 'files'");
  const auto files = parsed.find("files");
  if (files == parsed.end() || !files->is_array()) return std::string("it has no list 'files'");
  VtkIndex index;
  index.kind = VtkFileClass::steps;
  for (const Json& one : *files) {
    const auto name = one.is_object() ? one.find("name") : one.end();
    if (!one.is_object() || name == one.end() || !name->is_string()) continue;
    auto file = name->get<std::string>();
    if (file.empty() || file.size() > kMostNameBytes || index.members.size() >= kMostMembers) continue;
    const auto time = one.find("time");
    const double stated = time != one.end() && time->is_number() ? time->get<double>() : NAN;
    index.members.push_back(
        {std::move(file), {}, {}, std::isfinite(stated) ? stated : static_cast<double>(index.members.size())});
  }
  if (index.members.empty()) return std::string("it names no files");
  return index;
}

}  // namespace

VtkFileClass vtk_class_of(std::span<const std::byte> bytes) {
  if (text_of(bytes).starts_with(kLegacyVtkMark)) return VtkFileClass::legacy;
  if (is_json_series(bytes)) return VtkFileClass::steps;
  const std::string type = stated_type(bytes);
  if (type.empty()) return VtkFileClass::other;
  if (type == "Collection") return VtkFileClass::steps;
  if (type.starts_with("vtk")) return VtkFileClass::blocks;
  return std::ranges::find(kLeafTypes, type) != std::end(kLeafTypes) ? VtkFileClass::leaf : VtkFileClass::pieces;
}

bool is_vtk_xml_or_pieces(std::span<const std::byte> bytes, std::string_view type) {
  return is_vtk_xml(bytes, type) || is_vtk_xml(bytes, "P" + std::string(type));
}

bool is_vts(std::span<const std::byte> bytes) { return is_vtk_xml_or_pieces(bytes, "StructuredGrid"); }
bool is_vtr(std::span<const std::byte> bytes) { return is_vtk_xml_or_pieces(bytes, "RectilinearGrid"); }
bool is_vti(std::span<const std::byte> bytes) { return is_vtk_xml_or_pieces(bytes, "ImageData"); }
bool is_vtp(std::span<const std::byte> bytes) { return is_vtk_xml_or_pieces(bytes, "PolyData"); }
bool is_vtu(std::span<const std::byte> bytes) { return is_vtk_xml_or_pieces(bytes, "UnstructuredGrid"); }
bool is_vtm(std::span<const std::byte> bytes) {
  return std::ranges::any_of(kBlockTypes, [&](std::string_view type) { return is_vtk_xml(bytes, type); });
}
bool is_pvd(std::span<const std::byte> bytes) { return is_vtk_xml(bytes, "Collection"); }
bool is_vtk_series(std::span<const std::byte> bytes) { return is_json_series(bytes); }

std::variant<VtkIndex, std::string> read_vtk_index(std::span<const std::byte> bytes) {
  if (is_json_series(bytes)) return read_json_series(bytes);
  const auto parsed = parse_xdmf(bytes, "VTKFile");
  if (const auto* const problem = std::get_if<std::string>(&parsed)) return *problem;
  return IndexReader(*std::get<std::unique_ptr<XdmfElement>>(parsed)).read();
}

}  // namespace gs::app
