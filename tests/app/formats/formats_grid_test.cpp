// Tests of the visible faces of VTK grids, XML and legacy.
#include "app/formats/common/color_key.h"
#include "app/formats/content_types.h"

#include "tests/app/formats_helpers.h"
#include "tests/app/volume_files.h"

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gs::app::grid_test {

using namespace gs::test;

struct Cell {
  int type = 0;
  std::vector<int> corners;
};

std::string joined(const std::vector<int>& values) {
  std::string text;
  for (const int value : values) text += " " + std::to_string(value);
  return text;
}
std::string places_of(const std::vector<glm::vec3>& points) {
  std::string text;
  for (const glm::vec3& p : points)
    text += std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.z) + "\n";
  return text;
}

std::string legacy(const std::vector<glm::vec3>& points, const std::vector<Cell>& cells, const std::string& data = {}) {
  std::string rows, types;
  std::size_t numbers = 0;
  for (const Cell& cell : cells) {
    rows += std::to_string(cell.corners.size()) + joined(cell.corners) + "\n";
    types += std::to_string(cell.type) + "\n";
    numbers += cell.corners.size() + 1;
  }
  const std::string count = std::to_string(cells.size());
  return "# vtk DataFile Version 3.0\ngrid\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS " + std::to_string(points.size()) +
         " float\n" + places_of(points) + "CELLS " + count + " " + std::to_string(numbers) + "\n" + rows +
         "CELL_TYPES " + count + "\n" + types + data;
}

std::string vtu(const std::string& pieces, const std::string& more = {}, const std::string& behind = {}) {
  return "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" byte_order=\"LittleEndian\"" + more +
         "><UnstructuredGrid>\n" + pieces + "</UnstructuredGrid>\n" + behind + "</VTKFile>\n";
}
std::string array_of(const std::string& type, const std::string& name, const std::string& values, int components = 1) {
  return "<DataArray type=\"" + type + "\" Name=\"" + name + "\" NumberOfComponents=\"" + std::to_string(components) +
         "\" format=\"ascii\">" + values + "</DataArray>\n";
}
std::string piece(const std::vector<glm::vec3>& points, const std::vector<Cell>& cells, const std::string& data = {},
                  const std::string& of_cells = {}) {
  std::vector<int> corners, ends, types;
  for (const Cell& cell : cells) {
    corners.insert(corners.end(), cell.corners.begin(), cell.corners.end());
    ends.push_back(static_cast<int>(corners.size()));
    types.push_back(cell.type);
  }
  return "<Piece NumberOfPoints=\"" + std::to_string(points.size()) + "\" NumberOfCells=\"" +
         std::to_string(cells.size()) + "\">\n" + data + "<Points>" +
         array_of("Float32", "Points", places_of(points), 3) + "</Points><Cells>" +
         array_of("Int64", "connectivity", joined(corners)) + array_of("Int64", "offsets", joined(ends)) +
         array_of("UInt8", "types", joined(types)) + of_cells + "</Cells></Piece>\n";
}

// Two boxes side by side along X. The second is a VTK voxel, with its corners in rows.
const std::vector<glm::vec3> kBoxPoints = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1},
                                           {1, 1, 1}, {0, 1, 1}, {2, 0, 0}, {2, 1, 0}, {2, 0, 1}, {2, 1, 1}};
const std::vector<Cell> kBoxes = {{12, {0, 1, 2, 3, 4, 5, 6, 7}}, {11, {1, 8, 2, 9, 5, 10, 6, 11}}};

std::vector<std::vector<std::int32_t>> faces_of(const Imported& result) {
  std::vector<std::vector<std::int32_t>> faces(1);
  for (const std::int32_t corner : result.corners())
    if (corner < 0)
      faces.emplace_back();
    else
      faces.back().push_back(corner);
  faces.pop_back();
  return faces;
}
// Returns six times the enclosed volume, positive if the faces are counter-clockwise from outside.
double volume_within(const Imported& result) {
  const std::vector<glm::vec3> points = result.points();
  double sum = 0;
  for (const auto& face : faces_of(result))
    for (std::size_t i = 2; i < face.size(); ++i) {
      const auto at = [&](std::size_t k) { return glm::dvec3(points[static_cast<std::size_t>(face[k])]); };
      const glm::dvec3 a = at(0), b = at(i - 1), c = at(i);
      sum += a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x);
    }
  return sum;
}

TEST_CASE("shows the faces of a grid that belong to one cell only, from outside") {
  const std::string scalars = "POINT_DATA 12\nSCALARS heat float\nLOOKUP_TABLE default\n0 1 2 3 4 5 6 7 8 9 10 11\n";
  for (const Imported& result :
       {imported("legacy VTK", bytes_of(legacy(kBoxPoints, kBoxes, scalars))),
        imported("VTK UnstructuredGrid",
                 bytes_of(vtu(piece(kBoxPoints, kBoxes,
                                    "<PointData Scalars=\"heat\"><DataArray type=\"Float32\" Name=\"heat\" "
                                    "format=\"ascii\">0 1 2 3 4 5 6 7 8 9 10 11</DataArray></PointData>"))))}) {
    CHECK(result.messages().empty());
    CHECK(faces_of(result).size() == 10);
    CHECK(volume_within(result) == 12);  // 2 cubic units
    const auto key = color_key_of(*result.scene);
    REQUIRE(key);
    CHECK(key->title == "heat");
    CHECK(key->high == 11);
    CHECK(result.colors().size() == 12);
    CHECK(result.colors()[11] == viridis_colors().back());
  }
}

TEST_CASE("closes every solid VTK cell by faces that look outwards") {
  const std::vector<glm::vec3> points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                         {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  const struct {
    Cell cell;
    std::size_t faces;
    double volume;  // six times the volume
  } rows[] = {{{10, {0, 1, 3, 4}}, 4, 1},
              {{24, {0, 1, 3, 4, 0, 0, 0, 0, 0, 0}}, 4, 1},
              {{11, {0, 1, 3, 2, 4, 5, 7, 6}}, 6, 6},
              {{12, {0, 1, 2, 3, 4, 5, 6, 7}}, 6, 6},
              {{13, {0, 3, 1, 4, 7, 5}}, 5, 3},  // the first triangle looks outwards
              {{14, {0, 1, 2, 3, 4}}, 5, 2}};
  for (const auto& row : rows) {
    INFO(row.cell.type);
    const Imported result = imported("legacy VTK", bytes_of(legacy(points, {row.cell})));
    CHECK(result.messages().empty());
    CHECK(faces_of(result).size() == row.faces);
    CHECK(volume_within(result) == Approx(row.volume));
    // Each directed edge must occur once.
    std::map<std::pair<int, int>, int> edges;
    for (const auto& face : faces_of(result))
      for (std::size_t i = 0; i < face.size(); ++i) ++edges[{face[i], face[(i + 1) % face.size()]}];
    for (const auto& [edge, times] : edges) {
      CHECK(times == 1);
      CHECK(edges.count({edge.second, edge.first}) == 1);
    }
  }
}

TEST_CASE("reads a grid of flat cells, lines and vertices in any order, with cell colours") {
  const std::vector<Cell> cells = {{8, {0, 1, 3, 2}}, {1, {4}},           {5, {4, 5, 6}},   {3, {0, 6}},
                                   {7, {4, 5, 6, 7}}, {10, {0, 1, 3, 4}}, {9, {1, 2, 6, 5}}};
  const Imported result = imported(
      "legacy VTK",
      bytes_of(legacy(kBoxPoints, cells, "CELL_DATA 7\nSCALARS part int 1\nLOOKUP_TABLE default\n0 1 2 3 4 5 6\n")));
  CHECK(result.messages().empty());
  const auto faces = faces_of(result);
  REQUIRE(faces.size() == 8);  // four of them flat cells
  CHECK(faces[0] == std::vector<std::int32_t>{0, 1, 2, 3});
  const ColorKey key = *color_key_of(*result.scene);
  const auto colors_of = [&](const char* type) {
    const auto& scene = *result.scene;
    return result.values<vrml::MFColor>(scene.get<vrml::NodeId>(result.only(type), "color"), "color");
  };
  std::vector<vrml::Color> expected;
  for (const double part : {0, 2, 4, 6, 5, 5, 5, 5}) expected.push_back(key.color_of(part));
  CHECK(colors_of("IndexedFaceSet") == expected);
  CHECK(colors_of("IndexedLineSet") == std::vector{key.color_of(3)});
  CHECK(colors_of("PointSet") == std::vector{key.color_of(1)});
}

TEST_CASE("joins the pieces of a grid, packed and appended, with cell data") {
  // Raw and compressed data, as in files of ParaView.
  std::string appended;
  const auto array = [&](const std::string& type, const std::string& name, const Bytes& values, int components = 1) {
    const Bytes packed = zlib_packed(values);
    Bytes head;
    for (const std::size_t word : {std::size_t{1}, values.size(), std::size_t{0}, packed.size()})
      put(head, static_cast<std::uint32_t>(word));
    const std::string text = "<DataArray type=\"" + type + "\" Name=\"" + name + "\" NumberOfComponents=\"" +
                             std::to_string(components) + "\" format=\"appended\" offset=\"" +
                             std::to_string(appended.size()) + "\"/>";
    appended += string_of(head) + string_of(packed);
    return text;
  };
  std::string pieces;
  for (int i = 0; i < 2; ++i) {
    Bytes places, corners, ends, types, ghosts, values;
    for (const glm::vec3& p : {glm::vec3(0), glm::vec3(1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, 0, 1)})
      for (const float part : {p.x + static_cast<float>(i) * 2, p.y, p.z}) put(places, part);
    for (const std::int64_t corner : {0, 1, 2, 3}) put(corners, corner);
    put(ends, std::int64_t{4});
    put(types, std::uint8_t{10});
    put(ghosts, std::uint8_t{0});
    put(values, 3.5 + i);
    pieces += "<Piece NumberOfPoints=\"4\" NumberOfCells=\"1\"><CellData>" + array("UInt8", "vtkGhostType", ghosts) +
              array("Float64", "stress", values) + "</CellData><Points>" + array("Float32", "Points", places, 3) +
              "</Points><Cells>" + array("Int64", "connectivity", corners) + array("Int64", "offsets", ends) +
              array("UInt8", "types", types) + "</Cells></Piece>";
  }
  const Imported result = imported(
      "VTK UnstructuredGrid", bytes_of(vtu(pieces, " compressor=\"vtkZLibDataCompressor\"",
                                           "<AppendedData encoding=\"raw\">\n_" + appended + "\n</AppendedData>")));
  CHECK(result.messages().empty());
  CHECK(faces_of(result).size() == 8);
  CHECK(volume_within(result) == Approx(2));
  REQUIRE(color_key_of(*result.scene));
  CHECK(color_key_of(*result.scene)->title == "stress");
  CHECK(result.colors().front() == viridis_colors().front());
  CHECK(result.colors().back() == viridis_colors().back());
}

// A box of six faces below a roof of five with a common face, and a separate tetrahedron.
const std::vector<glm::vec3> kHousePoints = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},   {0, 0, 1},
                                             {1, 0, 1}, {1, 1, 1}, {0, 1, 1}, {0, .5f, 2}, {1, .5f, 2},
                                             {4, 0, 0}, {5, 0, 0}, {4, 1, 0}, {4, 0, 1}};
const std::vector<std::vector<std::vector<int>>> kHouse = {
    {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}},
    {{4, 7, 6, 5}, {4, 5, 9, 8}, {6, 7, 8, 9}, {5, 6, 9}, {7, 4, 8}}};
// Returns the faces of a cell as in legacy files and in the array `faces` of XML.
std::vector<int> stream_of(const std::vector<std::vector<int>>& faces) {
  std::vector<int> stream{static_cast<int>(faces.size())};
  for (const auto& face : faces) {
    stream.push_back(static_cast<int>(face.size()));
    stream.insert(stream.end(), face.begin(), face.end());
  }
  return stream;
}
const std::vector<Cell> kHouseCells = {
    {42, {0, 1, 2, 3, 4, 5, 6, 7}}, {10, {10, 11, 12, 13}}, {42, {4, 5, 6, 7, 8, 9}}};
std::string old_faces() {
  std::vector<int> faces = stream_of(kHouse[0]), ends{static_cast<int>(faces.size()), -1};
  for (const int value : stream_of(kHouse[1])) faces.push_back(value);
  ends.push_back(static_cast<int>(faces.size()));
  return array_of("Int64", "faces", joined(faces)) + array_of("Int64", "faceoffsets", joined(ends));
}
std::string numbered_faces() {
  std::vector<int> corners, ends, numbers;
  for (const auto& cell : kHouse)
    for (const auto& face : cell) {
      corners.insert(corners.end(), face.begin(), face.end());
      numbers.push_back(static_cast<int>(ends.size()));
      ends.push_back(static_cast<int>(corners.size()));
    }
  return array_of("Int64", "face_connectivity", joined(corners)) + array_of("Int64", "face_offsets", joined(ends)) +
         array_of("Int64", "polyhedron_to_faces", joined(numbers)) +
         array_of("Int64", "polyhedron_offsets", joined({6, 6, 11}));
}

TEST_CASE("shows the outer faces of polyhedra as each version of VTK writes them") {
  const std::vector<Cell> streams = {{42, stream_of(kHouse[0])}, kHouseCells[1], {42, stream_of(kHouse[1])}};
  const std::string old = piece(kHousePoints, kHouseCells, {}, old_faces());
  for (const Imported& result :
       {imported("legacy VTK", bytes_of(legacy(kHousePoints, streams))),
        imported("VTK UnstructuredGrid", bytes_of(vtu(old))),
        imported("VTK UnstructuredGrid", bytes_of(vtu(piece(kHousePoints, kHouseCells, {}, numbered_faces()))))}) {
    CHECK(result.messages().empty());
    CHECK(faces_of(result).size() == 13);  // 5 of the box, 4 of the roof, 4 of the tetrahedron
    CHECK(volume_within(result) == Approx(6 + 3 + 1));
  }
  // Each piece counts its corners from 0.
  const Imported two = imported("VTK UnstructuredGrid", bytes_of(vtu(piece(kBoxPoints, kBoxes) + old)));
  CHECK(two.messages().empty());
  CHECK(volume_within(two) == Approx(12 + 10));
}

TEST_CASE("matches the faces of a hexahedron with coincident corners with its neighbours") {
  // A wedge, written as a hexahedron, with a tetrahedron on one of its triangles.
  const Imported result = imported(
      "legacy VTK", bytes_of(legacy({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {0, 0, 2}},
                                    {{12, {0, 1, 2, 2, 3, 4, 5, 5}}, {10, {3, 4, 5, 6}}})));
  CHECK(result.messages().empty());
  CHECK(faces_of(result).size() == 7);
  CHECK(volume_within(result) == Approx(3 + 1));
}

TEST_CASE("reports errors in a grid, and shows the rest") {
  const auto told = [](const Import& import, const std::string& text, const std::string& said) {
    INFO(text);
    const Imported result = imported(import, bytes_of(text));
    INFO(result.messages());
    CHECK(result.messages().find(said) != std::string::npos);
    check_sound(result);
    return result.all("Shape").size();
  };
  const Cell box = kBoxes[0];
  CHECK(told("legacy VTK", legacy(kBoxPoints, {box, {36, {0, 1, 2}}}), "of unsupported types") == 1);
  for (const std::vector<int>& faces : std::vector<std::vector<int>>{
           {2, 3, 0, 1, 2}, {1, 4, 0, 1, 2}, {-1, 3, 0, 1, 2}, {1, -3, 0, 1, 2}, {1, 2, 0, 1}, {2000000000, 3, 0}, {0}})
    CHECK(told("legacy VTK", legacy(kBoxPoints, {box, {42, faces}}), "without all of their corners") == 1);
  CHECK(told("legacy VTK", legacy(kBoxPoints, {{42, {1, 3, 0, 1, 99}}}), "") == 0);
  CHECK(told("legacy VTK", legacy(kBoxPoints, {box, {12, {0, 1, 2}}}), "without all of their corners") == 1);
  CHECK(told("legacy VTK", legacy(kBoxPoints, {{12, {0, 1, 2, 3, 4, 5, 6, 99}}}), "") == 1);
  CHECK(told("legacy VTK", legacy(kBoxPoints, {{12, {-1, 1, 2, 3, 4, 5, 6, -7}}}), "") == 1);
  const std::string text = legacy(kBoxPoints, {box, box});
  CHECK(told("legacy VTK", text.substr(0, text.find("CELL_TYPES")), "are left out") == 1);  // its points show
  CHECK(told("legacy VTK", legacy(kBoxPoints, {box}) + "CELLS 1 2000000000\n", "numbers") == 1);
  std::string grid = vtu(piece(kBoxPoints, {box}));
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string copy = grid;
    return copy.replace(copy.find(from), from.size(), to);
  };
  CHECK(told("VTK UnstructuredGrid", changed("NumberOfCells=\"1\"", "NumberOfCells=\"100000000000\""), "types") == 1);
  CHECK(told("VTK UnstructuredGrid", changed("NumberOfCells=\"1\"", "NumberOfCells=\"2000000000\""), "types") == 1);
  CHECK(told("VTK UnstructuredGrid", changed("Name=\"types\"", "Name=\"kinds\""), "types") == 1);
  CHECK(told("VTK UnstructuredGrid", changed("Name=\"offsets\"", "Name=\"ends\""), "offsets") == 1);
  CHECK(told("VTK UnstructuredGrid", changed("> 8<", "> 7<"), "without all of their corners") == 1);
  CHECK(told("VTK UnstructuredGrid", changed("> 12<", "> -3<"), "are left out") == 1);  // its points show
  CHECK(told("VTK UnstructuredGrid", "<VTKFile type=\"PolyData\"></VTKFile>", "no points") == 0);
  CHECK(told("VTK UnstructuredGrid", vtu(piece(kHousePoints, kHouseCells)), "'faceoffsets'") == 1);
  const std::pair<const char*, const char*> wrong[] = {
      {" 6 6 11", " 6 6 12"},       {" 6 6 11", " 6 6 5"}, {" 6 6 11", " 0 0 0"},     {" 6 6 11", " -1 -1 -1"},
      {" 9 10<", " 9 2000000000<"}, {" 9 10<", " 9 99<"},  {" 36 39 42", " 36 39 1"}, {" 36 39 42", " 36 -8 42"}};
  for (const auto& [from, to] : wrong) {
    std::string faces = numbered_faces();
    REQUIRE(faces.find(from) != std::string::npos);
    faces.replace(faces.find(from), std::string_view(from).size(), to);
    CHECK(told("VTK UnstructuredGrid", vtu(piece(kHousePoints, kHouseCells, {}, faces)), "") == 1);
  }
}

TEST_CASE("survives every prefix and every flipped bit of a grid") {
  const std::vector<glm::vec3> points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const std::vector<Cell> cells = {{10, {0, 1, 2, 3}}, {5, {0, 1, 2}}, {1, {3}}};
  check_prefixes_and_flips(
      "legacy VTK", bytes_of(legacy(points, cells, "CELL_DATA 3\nSCALARS s int\nLOOKUP_TABLE default\n1 2 3\n")));
  check_prefixes_and_flips("VTK UnstructuredGrid", bytes_of(vtu(piece(points, cells))));
  const std::vector<Cell> solid = {{42, {0, 1, 2, 3}}};
  const std::vector<int> faces = stream_of({{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}});
  check_prefixes_and_flips("legacy VTK", bytes_of(legacy(points, {{42, faces}})));
  check_prefixes_and_flips(
      "VTK UnstructuredGrid",
      bytes_of(vtu(piece(points, solid, {},
                         array_of("Int8", "faces", joined(faces)) + array_of("Int8", "faceoffsets", joined({17}))))));
}

TEST_CASE("detects VTK grids by their content") {
  CHECK(content_type_of("a", bytes_of("<VTKFile type=\"UnstructuredGrid\">")).name == "VTK UnstructuredGrid");
  CHECK(content_type_of("a.vtu", {}).name == "VTK UnstructuredGrid");
}

}  // namespace gs::app::grid_test
