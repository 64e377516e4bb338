// Tests of VTK surfaces: XML PolyData and legacy files.
#include "app/formats/common/color_key.h"
#include "app/formats/common/dataset_list.h"
#include "app/formats/content_types.h"

#include "tests/app/formats_helpers.h"
#include "tests/app/volume_files.h"

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace gs::app::vtk_test {

using namespace gs::test;
using vrml::Color;

/// Writer of DataArrays in one encoding of the format.
struct VtpWriter {
  enum class Way : std::uint8_t { ascii, base64_inside, appended_raw, appended_base64 };
  Way way = Way::ascii;
  bool packed = false, big_endian = false, wide = false;
  std::string appended = {};

  template <class T>
  [[nodiscard]] std::string array(const std::string& type, const std::string& name, const std::vector<T>& values,
                                  int components = 1) {
    std::string text = "<DataArray type=\"" + type + "\" Name=\"" + name + "\" NumberOfComponents=\"" +
                       std::to_string(components) + "\" format=\"";
    if (way == Way::ascii) {
      text += "ascii\">";
      for (const T value : values) text += " " + std::to_string(value);
      return text + "</DataArray>\n";
    }
    Bytes data;
    for (const T value : values) big_endian ? put_big(data, value) : put(data, value);
    if (way == Way::base64_inside) return text + "binary\">\n" + body(data, true) + "</DataArray>\n";
    const std::string body_text = body(data, way == Way::appended_base64);
    text += "appended\" offset=\"" + std::to_string(appended.size()) + "\"/>\n";
    appended += body_text;
    return text;
  }
  [[nodiscard]] std::string file(const std::string& pieces) const {
    std::string text =
        std::string("<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"") +
        (big_endian ? "BigEndian" : "LittleEndian") + "\" header_type=\"" + (wide ? "UInt64" : "UInt32") + "\"" +
        (packed ? " compressor=\"vtkZLibDataCompressor\"" : "") + "><PolyData>\n" + pieces + "</PolyData>\n";
    if (way == Way::appended_raw) text += "<AppendedData encoding=\"raw\">\n_" + appended + "\n</AppendedData>";
    if (way == Way::appended_base64) text += "<AppendedData encoding=\"base64\">\n_" + appended + "\n</AppendedData>";
    return text + "</VTKFile>\n";
  }

 private:
  void put_word(Bytes& to, std::size_t value) const {
    const auto narrow = static_cast<std::uint32_t>(value);
    const auto whole = static_cast<std::uint64_t>(value);
    if (wide)
      big_endian ? put_big(to, whole) : put(to, whole);
    else
      big_endian ? put_big(to, narrow) : put(to, narrow);
  }
  [[nodiscard]] std::string body(const Bytes& data, bool as_base64) const {
    Bytes head, content = data;
    if (packed) {
      content = zlib_packed(data);
      for (const std::size_t word : {std::size_t{1}, data.size(), std::size_t{0}, content.size()}) put_word(head, word);
    } else {
      put_word(head, data.size());
    }
    if (!as_base64) return string_of(head + content);
    return packed ? base64(head) + base64(content) : base64(head + content);
  }
};

const std::vector<float> kSquare = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};

// Returns a polygon, a strip of two triangles, a line and a vertex over a square, with temperatures at its corners.
std::string square_piece(VtpWriter& writer, const std::string& data) {
  std::string text =
      "<Piece NumberOfPoints=\"4\" NumberOfVerts=\"1\" NumberOfLines=\"1\" NumberOfStrips=\"1\" "
      "NumberOfPolys=\"1\">\n" +
      data;
  text += "<Points>" + writer.array<float>("Float32", "Points", kSquare, 3) + "</Points>\n";
  const auto cells = [&](const std::string& element, const std::vector<std::int64_t>& corners) {
    text += "<" + element + ">" + writer.array<std::int64_t>("Int64", "connectivity", corners) +
            writer.array<std::int32_t>("Int32", "offsets", {static_cast<std::int32_t>(corners.size())}) + "</" +
            element + ">\n";
  };
  cells("Verts", {3});
  cells("Lines", {0, 2});
  cells("Strips", {0, 1, 3, 2});
  cells("Polys", {0, 1, 2, 3});
  return text + "</Piece>\n";
}
std::string square_file(VtpWriter writer) {
  const std::string data =
      "<PointData Scalars=\"temperature\" Normals=\"n\">" + writer.array<std::int16_t>("Int16", "other", {9, 9, 9, 9}) +
      writer.array<double>("Float64", "temperature", {-20, 30, 80, 80}) +
      writer.array<float>("Float32", "n", {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, 3) + "</PointData>\n";
  const std::string piece = square_piece(writer, data);
  return writer.file(piece);
}

void check_square(const Imported& result) {
  CHECK(result.diagnostics.errors() == 0);
  CHECK(result.diagnostics.warnings() == 0);
  const auto faces = result.only("IndexedFaceSet"), lines = result.only("IndexedLineSet"),
             points = result.only("PointSet");
  const auto& scene = *result.scene;
  const auto& corners = scene.get<vrml::MFInt32>(faces, "coordIndex");
  CHECK(std::vector<std::int32_t>(corners.begin(), corners.end()) ==
        std::vector<std::int32_t>{0, 1, 2, 3, -1, 0, 1, 3, -1, 3, 1, 2, -1});
  const auto& ends = scene.get<vrml::MFInt32>(lines, "coordIndex");
  CHECK(std::vector<std::int32_t>(ends.begin(), ends.end()) == std::vector<std::int32_t>{0, 2, -1});
  const auto& place = scene.get<vrml::MFVec3f>(scene.get<vrml::NodeId>(points, "coord"), "point");
  REQUIRE(place.size() == 1);
  CHECK(place[0] == glm::vec3(0, 1, 0));
  const auto key = color_key_of(scene);
  REQUIRE(key);
  CHECK(key->title == "temperature");
  CHECK(key->low == -20);
  CHECK(key->high == 80);
  const auto& colors = scene.get<vrml::MFColor>(scene.get<vrml::NodeId>(faces, "color"), "color");
  REQUIRE(colors.size() == 4);
  CHECK(colors[0] == viridis_colors().front());
  CHECK(colors[1] == viridis_colors()[2]);
  CHECK(colors[3] == viridis_colors().back());
  CHECK(scene.get<vrml::MFVec3f>(scene.get<vrml::NodeId>(faces, "normal"), "vector").size() == 4);
}

// Returns a function that imports a text in a format, checks its messages, and returns the number of its Shapes.
auto shapes_of(const char* format) {
  return [format](const std::string& text, const std::string& said) {
    INFO(text);
    const Imported result = imported(format, bytes_of(text));
    INFO(result.messages());
    CHECK(result.messages().find(said) != std::string::npos);
    return result.all("Shape").size();
  };
}

TEST_CASE("VTP: reads every encoding of arrays") {
  using Way = VtpWriter::Way;
  check_square(imported("VTK PolyData", bytes_of(square_file({Way::ascii}))));
  for (const Way way : {Way::base64_inside, Way::appended_raw, Way::appended_base64})
    for (const bool packed : {false, true})
      for (const bool big_endian : {false, true})
        for (const bool wide : {false, true}) {
          INFO(static_cast<int>(way) << packed << big_endian << wide);
          check_square(imported("VTK PolyData", bytes_of(square_file({way, packed, big_endian, wide}))));
        }
}

TEST_CASE("VTP: reads cell values, vector lengths, byte colours, and points alone") {
  VtpWriter writer;
  const Imported cells =
      imported("VTK PolyData",
               bytes_of(writer.file(square_piece(
                   writer, "<CellData>" + writer.array<std::int32_t>("Int32", "part", {0, 0, 1, 2}) + "</CellData>"))));
  // VTK numbers its cells in this order: vertices, lines, polygons, strips.
  const auto faces = cells.only("IndexedFaceSet");
  CHECK_FALSE(cells.scene->get<bool>(faces, "colorPerVertex"));
  const auto& colors = cells.scene->get<vrml::MFColor>(cells.scene->get<vrml::NodeId>(faces, "color"), "color");
  CHECK(std::vector<Color>(colors.begin(), colors.end()) ==
        std::vector<Color>{viridis_colors()[2], viridis_colors().back(), viridis_colors().back()});
  CHECK(color_key_of(*cells.scene)->title == "part");

  const Imported vectors = imported(
      "VTK PolyData",
      bytes_of(writer.file(square_piece(
          writer, "<PointData>" + writer.array<float>("Float32", "wind", {3, 4, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0}, 3) +
                      "</PointData>"))));
  REQUIRE(color_key_of(*vectors.scene));
  CHECK(color_key_of(*vectors.scene)->title == "wind (length)");
  CHECK(color_key_of(*vectors.scene)->high == 5);

  const Imported bytes =
      imported("VTK PolyData",
               bytes_of(writer.file(square_piece(
                   writer, "<PointData Scalars=\"c\">" +
                               writer.array<std::int32_t>("UInt8", "c", {255, 0, 51, 0, 0, 0, 0, 0, 0, 0, 0, 0}, 3) +
                               "</PointData>"))));
  CHECK_FALSE(color_key_of(*bytes.scene));
  CHECK(bytes.scene->get<vrml::MFColor>(bytes.scene->get<vrml::NodeId>(bytes.only("IndexedFaceSet"), "color"),
                                        "color")[0] == Color{1, 0, 0.2f});

  const Imported alone = imported(
      "VTK PolyData", bytes_of(writer.file("<Piece NumberOfPoints=\"4\"><Points>" +
                                           writer.array<float>("Float32", "p", kSquare, 3) + "</Points></Piece>")));
  CHECK(alone.all("IndexedFaceSet").empty());
  CHECK(alone.points().size() == 4);
}

TEST_CASE("VTP: joins pieces, and makes those without an array grey") {
  VtpWriter writer;
  const std::string piece = square_piece(writer, ""),
                    with = square_piece(writer, "<PointData Scalars=\"t\">" +
                                                    writer.array<float>("Float32", "t", {1, 2, 3, 4}) + "</PointData>");
  const Imported result = imported("VTK PolyData", bytes_of(writer.file(piece + with)));
  CHECK(result.messages().empty());
  const auto faces = result.only("IndexedFaceSet");
  const auto& corners = result.scene->get<vrml::MFInt32>(faces, "coordIndex");
  CHECK(std::vector<std::int32_t>(corners.begin(), corners.end()) ==
        std::vector<std::int32_t>{0, 1, 2, 3, -1, 4, 5, 6, 7, -1, 0, 1, 3, -1, 3, 1, 2, -1, 4, 5, 7, -1, 7, 5, 6, -1});
  const auto& colors = result.scene->get<vrml::MFColor>(result.scene->get<vrml::NodeId>(faces, "color"), "color");
  REQUIRE(colors.size() == 8);
  CHECK(colors[3] == Color{0.5f, 0.5f, 0.5f});
  CHECK(colors[4] == viridis_colors().front());
}

TEST_CASE("VTP: reports errors, and shows the rest") {
  const auto told = shapes_of("VTK PolyData");
  VtpWriter writer;
  const std::string good = square_file({});
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    const std::size_t at = text.find(from);
    REQUIRE(at != std::string::npos);
    return text.replace(at, from.size(), to);
  };
  CHECK(told("<VTKFile type=\"ImageData\"></VTKFile>", "no points") == 0);
  CHECK(told("<VTKFile type=\"PolyData\"", "XML") == 0);
  CHECK(told("<VTKFile type=\"PolyData\"></VTKFile>", "no points") == 0);
  CHECK(told(changed("NumberOfPoints=\"4\"", "NumberOfPoints=\"100000000000\""), "2^31") == 0);
  CHECK(told(changed("NumberOfPoints=\"4\"", "NumberOfPoints=\"2000000000\""), "cannot contain") == 0);
  CHECK(told(changed("NumberOfPolys=\"1\"", "NumberOfPolys=\"2000000000\""), "offsets") == 3);
  CHECK(told(changed("> 0 1 2 3</DataArray>", "> 0 1 2 77</DataArray>"), "") == 3);
  CHECK(told(changed("type=\"Float64\" Name=\"temperature\"", "type=\"String\" Name=\"temperature\""), "") == 3);
  CHECK(told(changed("type=\"Int32\" Name=\"offsets\" NumberOfComponents=\"1\" format=\"ascii\"> 4",
                     "type=\"Int32\" Name=\"offsets\" NumberOfComponents=\"1\" format=\"ascii\"> -4"),
             "offsets") == 3);
  CHECK(told(changed("<Points>", "<Punkte>"), "") == 0);
}

TEST_CASE("VTP: survives every prefix and every flipped bit") {
  using Way = VtpWriter::Way;
  VtpWriter small{Way::ascii};
  const auto make = [](VtpWriter writer) {
    const std::string piece = "<Piece NumberOfPoints=\"3\" NumberOfPolys=\"1\"><PointData>" +
                              writer.array<std::int8_t>("Int8", "t", {1, 2, 3}) + "</PointData><Points>" +
                              writer.array<float>("Float32", "p", {0, 0, 0, 1, 0, 0, 0, 1, 0}, 3) + "</Points><Polys>" +
                              writer.array<std::int32_t>("Int32", "connectivity", {0, 1, 2}) +
                              writer.array<std::int32_t>("Int32", "offsets", {3}) + "</Polys></Piece>";
    return bytes_of(writer.file(piece));
  };
  check_prefixes_and_flips("VTK PolyData", make({Way::ascii}));
  check_prefixes_and_flips("VTK PolyData", make({Way::appended_raw, true}));
}

const std::string kLegacy =
    "# vtk DataFile Version 3.0\na square\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n"
    "0 0 0 1 0 0 1 1 0\n0 1 0\n";
const std::string kLegacyCells =
    "VERTICES 1 2\n1 3\nLINES 1 3\n2 0 2\nPOLYGONS 1 5\n4 0 1 2 3\n"
    "TRIANGLE_STRIPS 1 5\n4 0 1 3 2\n";
const std::string kLegacyData =
    "POINT_DATA 4\nSCALARS temperature double\nLOOKUP_TABLE default\n-20 30 80 80\n"
    "NORMALS n float\n0 0 1 0 0 1 0 0 1 0 0 1\n";

TEST_CASE("legacy VTK: reads text of old and new versions") {
  check_square(imported("legacy VTK", bytes_of(kLegacy + kLegacyCells + kLegacyData)));
  const auto cells = [](const std::string& name, const std::string& corners, int count) {
    return name + " 2 " + std::to_string(count) + "\nOFFSETS vtktypeint64\n0 " + std::to_string(count) +
           "\nCONNECTIVITY vtktypeint64\n" + corners + "\n";
  };
  const std::string of_51 = cells("VERTICES", "3", 1) + cells("LINES", "0 2", 2) + cells("POLYGONS", "0 1 2 3", 4) +
                            cells("TRIANGLE_STRIPS", "0 1 3 2", 4);
  check_square(
      imported("legacy VTK", bytes_of(kLegacy + "METADATA\nINFORMATION 0\n\n" + of_51 +
                                      "\nPOINT_DATA 4\nFIELD FieldData 2\n"
                                      "wind 3 4 float\n1 2 3 4 5 6 7 8 9 10 11 12\ntemperature 1 4 int\n-20 30 80 80\n"
                                      "NORMALS n float\n0 0 1 0 0 1 0 0 1 0 0 1\nMETADATA\nNAME x\n\n")));
}

TEST_CASE("legacy VTK: reads big-endian binary files") {
  Bytes file = bytes_of("# vtk DataFile Version 4.2\na square\nBINARY\nDATASET POLYDATA\nPOINTS 4 float\n");
  for (const float value : kSquare) put_big(file, value);
  const auto cells = [&](const std::string& line, const std::vector<std::int32_t>& values) {
    file = file + bytes_of("\n" + line + "\n");
    for (const std::int32_t value : values) put_big(file, value);
  };
  cells("VERTICES 1 2", {1, 3});
  cells("LINES 1 3", {2, 0, 2});
  cells("POLYGONS 1 5", {4, 0, 1, 2, 3});
  cells("TRIANGLE_STRIPS 1 5", {4, 0, 1, 3, 2});
  file = file + bytes_of("\nPOINT_DATA 4\nSCALARS temperature short 1\nLOOKUP_TABLE default\n");
  for (const std::int16_t value : {-20, 30, 80, 80}) put_big(file, value);
  file = file + bytes_of("\nNORMALS n float\n");
  for (int i = 0; i < 4; ++i)
    for (const float value : {0.0f, 0.0f, 1.0f}) put_big(file, value);
  check_square(imported("legacy VTK", file));
  Bytes colored = file + bytes_of("\nCELL_DATA 4\nCOLOR_SCALARS c 3\n");
  for (int i = 0; i < 12; ++i) colored.push_back(std::byte{51});
  check_square(imported("legacy VTK", colored));
}

TEST_CASE("legacy VTK: reports errors, and shows the rest") {
  const auto told = shapes_of("legacy VTK");
  CHECK(told("#VRML V2.0 utf8\n", "vtk DataFile") == 0);
  CHECK(told("# vtk DataFile Version 3.0\nx\nASCII\nDATASET STRUCTURED_GRID\n", "structured_grid") == 0);
  CHECK(told("# vtk DataFile Version 3.0\nx\nEBCDIC\n", "ASCII or BINARY") == 0);
  CHECK(told(kLegacy + "POLYGONS 2 9\n3 0 1 2\n4 0 1", "numbers") == 1);
  CHECK(told(kLegacy + "POLYGONS 1 -5\n", "whole number") == 1);
  CHECK(told(kLegacy + "POLYGONS 2000000000 2000000000\n3 0 1 2", "numbers") == 1);
  CHECK(told(kLegacy + "POLYGONS 2 3\nOFFSETS int\n0 9\nCONNECTIVITY int\n0 1 2\n", "OFFSETS") == 1);
  CHECK(told(kLegacy + "POLYGONS 2 4\nOFFSETS int\n0 4\nCONNECTIVITY int\n0 1 2 3\nPOLYGONS 2 3\nOFFSETS int\n0 3\n"
                       "CONNECTIVITY int\n0 1 2\n",
             "") == 1);
  CHECK(told(kLegacy + "POLYGONS 1 4\n3 0 1 9\nCHEESE 1\n", "cheese") == 0);
  CHECK(told(kLegacy + "POLYGONS 1 4\n3 0 1 2\nPOINT_DATA 4\nSCALARS s bit\n", "bit") == 1);
}

TEST_CASE("legacy VTK: survives every prefix and every flipped bit") {
  check_prefixes_and_flips("legacy VTK", bytes_of(kLegacy + kLegacyCells + kLegacyData));
  Bytes binary = bytes_of("# vtk DataFile Version 5.1\nb\nBINARY\nDATASET POLYDATA\nPOINTS 3 float\n");
  for (const float value : {0.0f, 0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 0.0f, 1.0f, 0.0f}) put_big(binary, value);
  binary = binary + bytes_of("\nPOLYGONS 2 3\nOFFSETS vtktypeint64\n");
  for (const std::int64_t end : {0, 3}) put_big(binary, end);
  binary = binary + bytes_of("\nCONNECTIVITY vtktypeint64\n");
  for (const std::int64_t corner : {0, 1, 2}) put_big(binary, corner);
  CHECK(imported("legacy VTK", binary).corners() == std::vector<std::int32_t>{0, 1, 2, -1});
  check_prefixes_and_flips("legacy VTK", binary);
}

TEST_CASE("VTK surfaces: list their arrays, and show the chosen one") {
  const std::string xml =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\"><PolyData>\n"
      "<Piece NumberOfPoints=\"3\" NumberOfPolys=\"1\"><PointData>"
      "<DataArray type=\"Float32\" Name=\"heat\" format=\"ascii\">1 2 3</DataArray>"
      "<DataArray type=\"Float32\" Name=\"wind\" NumberOfComponents=\"2\" format=\"ascii\">3 4 0 1 0 0</DataArray>"
      "</PointData><CellData><DataArray type=\"Int32\" Name=\"load\" format=\"ascii\">7</DataArray></CellData>"
      "<Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 "
      "0</DataArray></Points>"
      "<Polys><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 2</DataArray>"
      "<DataArray type=\"Int32\" Name=\"offsets\" "
      "format=\"ascii\">3</DataArray></Polys></Piece></PolyData></VTKFile>\n";
  const std::string legacy = kLegacy +
                             "POLYGONS 1 4\n3 0 1 2\nPOINT_DATA 4\nSCALARS heat float\nLOOKUP_TABLE default\n1 2 3 3\n"
                             "FIELD F 1\nwind 2 4 float\n3 4 0 1 0 0 0 0\n"
                             "CELL_DATA 1\nSCALARS load float\nLOOKUP_TABLE default\n7\n";
  for (const auto& [type, text] : {std::pair("VTK PolyData", xml), std::pair("legacy VTK", legacy)}) {
    INFO(type);
    const auto shown = [&](const std::string& dataset, std::optional<std::uint32_t> component = {}) {
      Import import(type);
      import.choice.dataset = dataset;
      import.choice.chosen = component.has_value();
      import.choice.index = component.value_or(0);
      import.choice.found = std::make_shared<DatasetList>();
      const Imported made = imported(import, bytes_of(text));
      const auto key = color_key_of(*made.scene);
      const DatasetList& list = *import.choice.found;
      CHECK(list.entries.size() == (type == std::string_view("legacy VTK") ? 3 : 4));  // with the mesh alone
      return list.shown + " " + std::to_string(list.components) + " " + (key ? key->title : made.messages()) + " " +
             (key ? std::to_string(static_cast<int>(key->high)) : "");
    };
    CHECK(shown("") == "/PointData/heat 1 heat 3");
    CHECK(shown("wind") == "/PointData/wind 2 wind (length) 5");
    CHECK(shown("/PointData/wind", 1) == "/PointData/wind 2 wind (component 1) 4");
    CHECK(shown("/CellData/load") == "/CellData/load 1 load 7");
    CHECK(shown("wend").find("no dataset 'wend'; the nearest ones are /PointData/wind") != std::string::npos);
  }
}

TEST_CASE("VTK surfaces: draw vectors of points as arrows over a grey surface") {
  const std::string text = kLegacy +
                           "POLYGONS 1 4\n3 0 1 2\nPOINT_DATA 4\nSCALARS heat float\nLOOKUP_TABLE default\n1 2 3 3\n"
                           "VECTORS wind float\n3 4 0 0 0 0 nan 1 0 0 0 2\n";
  const auto shown = [&](const std::string& dataset, FlowForm form) {
    Import import("legacy VTK");
    import.choice.dataset = dataset;
    import.choice.flow = form;
    return imported(import, bytes_of(text));
  };
  const Imported arrows = shown("wind", FlowForm::arrows);
  CHECK(arrows.messages().empty());
  const auto key = color_key_of(*arrows.scene);
  REQUIRE(key);
  CHECK(key->title == "wind (length)");
  CHECK(key->low == 2);
  CHECK(key->high == 5);
  const auto shapes = arrows.all("IndexedFaceSet");
  REQUIRE(shapes.size() == 2);
  CHECK(arrows.scene->get<vrml::SFNode>(shapes[0], "color") == vrml::NodeId());
  CHECK(arrows.values<vrml::MFInt32>(shapes[0], "coordIndex") == std::vector<std::int32_t>{0, 1, 2, -1});
  // The arrow of the first point, (3, 4, 0), ends on its line. Zero and missing vectors have no arrows.
  const auto places = arrows.values<vrml::MFVec3f>(arrows.scene->get<vrml::SFNode>(shapes[1], "coord"), "point");
  const std::size_t one = places.size() / 2;
  REQUIRE(one > 0);
  const glm::vec3 tip = places[one - 1] - places[0];
  CHECK(glm::length(tip) > 0);
  CHECK(glm::length(glm::normalize(tip) - glm::vec3(0.6f, 0.8f, 0)) < 0.01f);

  const Imported values = shown("heat", FlowForm::arrows);
  CHECK(values.messages().find("no vectors of 2 or 3 components at points") != std::string::npos);
  CHECK(color_key_of(*values.scene)->title == "heat");
  const Imported lines = shown("wind", FlowForm::streamlines);
  CHECK(lines.messages().find("streamlines need the vectors of a volume") != std::string::npos);
  CHECK(color_key_of(*lines.scene)->title == "wind (length)");
}

TEST_CASE("detects VTK files by their content") {
  CHECK(content_type_of("a", bytes_of("<VTKFile type=\"PolyData\">")).name == "VTK PolyData");
  CHECK(content_type_of("a", bytes_of("<?xml?><VTKFile type='ImageData'>")).name == "VTK ImageData");
  CHECK(content_type_of("a", bytes_of(kLegacy)).name == "legacy VTK");
  CHECK(content_type_of("a.vtp", {}).name == "VTK PolyData");
  CHECK(content_type_of("a.VTK", {}).name == "legacy VTK");
}

}  // namespace gs::app::vtk_test
