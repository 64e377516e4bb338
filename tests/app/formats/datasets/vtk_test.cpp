#include "app/base/local_file.h"
#include "app/formats/vtk/bookkeeping.h"
#include "qnv/sampling/volume/volume_slices.h"
#include "tests/app/formats/datasets/dataset_helpers.h"
#include "tests/app/shared_facts.h"

#include <functional>
#include <map>

using namespace gs;
using namespace gs::app;
using namespace gs::test;

namespace {

std::string ascii(const std::string& type, const std::string& name, const std::vector<double>& values,
                  int components = 1) {
  std::string text = "<DataArray type=\"" + type + "\" Name=\"" + name + "\" NumberOfComponents=\"" +
                     std::to_string(components) + "\" format=\"ascii\">";
  for (const double value : values) text += " " + std::to_string(value);
  return text + "</DataArray>";
}

std::string vtk_file(const std::string& type, const std::string& content, const std::string& more = {}) {
  return "<?xml version=\"1.0\"?>\n<VTKFile type=\"" + type + "\" version=\"1.0\" byte_order=\"LittleEndian\"" + more +
         ">" + content + "</VTKFile>\n";
}

/// Grid of points, which `at` places.
std::string structured(int nx, int ny, int nz, const std::function<glm::dvec3(int, int, int)>& at,
                       const std::string& cell_data = {}) {
  std::vector<double> points, values;
  for (int z = 0; z < nz; ++z)
    for (int y = 0; y < ny; ++y)
      for (int x = 0; x < nx; ++x) {
        const glm::dvec3 p = at(x, y, z);
        points.insert(points.end(), {p.x, p.y, p.z});
        values.push_back(x + 10 * y + 100 * z);
      }
  const std::string extent =
      "0 " + std::to_string(nx - 1) + " 0 " + std::to_string(ny - 1) + " 0 " + std::to_string(nz - 1);
  return vtk_file("StructuredGrid", "<StructuredGrid WholeExtent=\"" + extent + "\"><Piece Extent=\"" + extent +
                                        "\"><PointData>" + ascii("Float32", "t", values) + "</PointData>" + cell_data +
                                        "<Points>" + ascii("Float64", "Points", points, 3) +
                                        "</Points></Piece></StructuredGrid>");
}

/// Image of 4 x 2 x 2 points with x from `first` on; values are `base` + x.
std::string image(int first, double base) {
  const std::string extent = std::to_string(first) + " " + std::to_string(first + 3) + " 0 1 0 1";
  std::vector<double> values;
  for (int i = 0; i < 16; ++i) values.push_back(base + first + i % 4);
  return vtk_file("ImageData", "<ImageData WholeExtent=\"" + extent +
                                   "\" Origin=\"1 2 3\" Spacing=\"0.5 1 1\"><Piece Extent=\"" + extent +
                                   "\"><PointData Scalars=\"d\">" + ascii("Float32", "d", values) +
                                   "</PointData></Piece></ImageData>");
}

std::string triangle(double z, const std::string& data = {}) {
  return vtk_file("PolyData", "<PolyData><Piece NumberOfPoints=\"3\" NumberOfPolys=\"1\">" + data + "<Points>" +
                                  ascii("Float32", "Points", {0, 0, z, 1, 0, z, 0, 1, z}, 3) + "</Points><Polys>" +
                                  ascii("Int32", "connectivity", {0, 1, 2}) + ascii("Int32", "offsets", {3}) +
                                  "</Polys></Piece></PolyData>");
}

/// Reads files of a list by their names.
ReadFile files_in(std::map<std::string, std::string> files) {
  return [files = std::move(files)](const std::string& name) -> BytesResult {
    const auto found = files.find(name);
    if (found == files.end()) return name + " does not exist";
    return shared_bytes(bytes_of(found->second));
  };
}

DatasetSample sample_of(const std::string& text, ReadFile read = nullptr, VoxelComponent choice = {}) {
  DatasetSample sample(bytes_of(text), "sample", std::move(choice));
  sample.read_file = std::move(read);
  return sample;
}

std::size_t polygons_of(const MeshAsset& mesh) {
  std::size_t faces = 0;
  for (const MeshPart& part : mesh.parts)
    faces += static_cast<std::size_t>(std::ranges::count(std::span(part.geometry.coord_index), -1));
  return faces;
}

std::vector<float> slice_of(const qnv::VolumeSource& volume, std::uint32_t z) {
  std::vector<std::byte> scratch;
  std::vector<float> values(qnv::slice_voxels(volume.layout));
  REQUIRE(qnv::read_slice(volume, z, scratch, values));
  return values;
}

VoxelComponent at_step(std::uint32_t number) {
  VoxelComponent choice;
  choice.step = qnv::ShownStep{number, std::nullopt};
  return choice;
}

}  // namespace

TEST_CASE("shows the outer faces of a curvilinear StructuredGrid") {
  const auto curved = [](int x, int y, int z) { return glm::dvec3(x + 0.3 * y * y, y, z + 0.1 * x * x); };
  DatasetSample sample = sample_of(structured(4, 3, 3, curved));
  const MeshAsset mesh = sample.mesh();
  CHECK(polygons_of(mesh) == 2 * (3 * 2 + 3 * 2 + 2 * 2));
  REQUIRE(mesh.color_key);
  CHECK(mesh.color_key->title == "t");
  CHECK(mesh.color_key->high == 223);
  // A flat one is a surface, also if it is regular.
  DatasetSample flat = sample_of(structured(4, 3, 1, [](int x, int y, int) { return glm::dvec3(x, y, 0); }));
  CHECK(polygons_of(flat.mesh()) == 6);
}

TEST_CASE("leaves out hidden cells of a StructuredGrid, and shows the faces behind them") {
  const auto curved = [](int x, int y, int z) { return glm::dvec3(x + 0.3 * y * y, y, z); };
  const std::string hidden = "<CellData>" + ascii("UInt8", "vtkGhostType", {0, 32, 0, 0, 0, 0, 0, 0}) + "</CellData>";
  DatasetSample sample = sample_of(structured(3, 3, 3, curved, hidden));
  CHECK(polygons_of(sample.mesh()) == 24);  // three faces less, three more
  CHECK(sample.entries()[1].path == "/CellData/vtkGhostType");
}

TEST_CASE("reads a StructuredGrid with points on a lattice as a volume, also if it is turned") {
  const auto turned = [](int x, int y, int z) {
    const double u = 2.0 * x, v = y * y + y;  // uneven along y
    return glm::dvec3(0.6 * u - 0.8 * v, 0.8 * u + 0.6 * v, 5 + z);
  };
  const qnv::VolumeSource volume = sample_of(structured(4, 3, 3, turned)).opened();
  CHECK(volume.layout.dimensions == std::array<std::uint32_t, 3>{4, 4, 3});  // y: 0, 2, 6 at distances of 2
  CHECK(volume.layout.axes[0].x == Approx(1.2));
  CHECK(volume.layout.axes[1].y == Approx(1.2));
  CHECK((volume.layout.base + volume.layout.origin).z == Approx(5));
  CHECK(slice_of(volume, 1)[1 * 4 + 3] == Approx(113));
  CHECK(slice_of(volume, 1)[2 * 4 + 3] == Approx(118));  // half way from y = 2 to y = 6
}

TEST_CASE("reads the uneven axes and the cells of a RectilinearGrid") {
  const std::string coordinates = "<Coordinates>" + ascii("Float32", "x", {0, 1, 3}) + ascii("Float32", "y", {0, 2}) +
                                  ascii("Float32", "z", {-1, 0, 1}) + "</Coordinates>";
  const std::string grid =
      vtk_file("RectilinearGrid",
               "<RectilinearGrid WholeExtent=\"0 2 0 1 0 2\"><Piece Extent=\"0 2 0 1 0 2\"><CellData>" +
                   ascii("Float32", "p", {1, 2, 3, 4}) + "</CellData>" + coordinates + "</Piece></RectilinearGrid>");
  const qnv::VolumeSource volume = sample_of(grid).opened();
  CHECK(volume.layout.dimensions == std::array<std::uint32_t, 3>{2, 1, 2});
  CHECK((volume.layout.base + volume.layout.origin).x == Approx(0.5));
  CHECK(volume.layout.axes[0].x == Approx(1.5));  // to the centre of the second cell, 2
  CHECK(slice_of(volume, 1) == std::vector<float>{3, 4});
  const auto entries = sample_of(grid).entries();
  REQUIRE(entries.size() == 1);
  CHECK(entries[0].path == "/CellData/p");
  CHECK(entries[0].shape == std::vector<std::uint64_t>{2, 1, 2});
}

TEST_CASE("joins the pieces of an image on demand, and counts missing ones") {
  const std::string pieces =
      "<PImageData WholeExtent=\"0 9 0 1 0 1\" Origin=\"1 2 3\" Spacing=\"0.5 1 1\"><PPointData Scalars=\"d\">"
      "<PDataArray type=\"Float32\" Name=\"d\"/></PPointData><Piece Extent=\"0 3 0 1 0 1\" Source=\"parts/a.vti\"/>"
      "<Piece Extent=\"3 6 0 1 0 1\" Source=\"parts/b.vti\"/><Piece Extent=\"6 9 0 1 0 1\" "
      "Source=\"parts/c.vti\"/></PImageData>";
  std::vector<std::string> asked;
  const ReadFile files = files_in({{"parts/a.vti", image(0, 0)}, {"parts/c.vti", image(6, 0)}});
  DatasetSample sample = sample_of(vtk_file("PImageData", pieces), [&](const std::string& name) {
    asked.push_back(name);
    return files(name);
  });
  const qnv::VolumeSource volume = sample.opened();
  CHECK(asked.empty());
  CHECK(volume.layout.dimensions == std::array<std::uint32_t, 3>{10, 2, 2});
  CHECK(volume.layout.axes[0].x == 0.5f);
  CHECK((volume.layout.base + volume.layout.origin) == glm::dvec3(1, 2, 3));
  const std::vector<float> values = slice_of(volume, 1);
  CHECK(values[3] == 3);
  CHECK(std::isnan(values[4]));
  CHECK(values[9] == 9);
  CHECK(asked.size() == 3);
  CHECK(volume.trouble() == "1 file is missing and left out: parts/b.vti: parts/b.vti does not exist");
}

TEST_CASE("reads time steps of images as a series") {
  const std::string steps =
      "<Collection><DataSet timestep=\"2.5\" file=\"b.vti\"/><DataSet timestep=\"1\" part=\"0\" "
      "file=\"a.vti\"/></Collection>";
  const ReadFile files = files_in({{"a.vti", image(0, 0)}, {"b.vti", image(0, 100)}});
  const qnv::VolumeSource all = sample_of(vtk_file("Collection", steps), files).opened();
  CHECK(all.times == std::vector<double>{1, 2.5});
  REQUIRE(all.steps.size() == 2);
  CHECK(slice_of(all.steps[1], 0)[2] == 102);
  VoxelComponent choice;
  choice.step = qnv::ShownStep{0, 2.4};
  CHECK(slice_of(sample_of(vtk_file("Collection", steps), files, choice).opened(), 0)[0] == 100);
  CHECK_THAT(sample_of(vtk_file("Collection", steps), files, at_step(2)).problem(), Catch::Contains("expected 0 to 1"));
  const std::string json =
      R"({"file-series-version":"1.0","files":[{"name":"a.vti","time":0.5},{"name":"b.vti","time":1.5}]})";
  CHECK(sample_of(json, files).opened().times == std::vector<double>{0.5, 1.5});
}

TEST_CASE("shows the blocks of a MultiBlock with their names and one colour key") {
  const auto values = [](double base) {
    return "<PointData>" + ascii("Int32", "GlobalNodeId", {90, 91, 92}) +
           ascii("Float32", "t", {base, base + 1, base + 2}) + "</PointData>";
  };
  const std::string blocks =
      "<vtkMultiBlockDataSet><Block index=\"0\" name=\"wing\"><DataSet index=\"0\" name=\"upper\" file=\"m/a.vtp\"/>"
      "<DataSet index=\"1\" file=\"m/b.vtp\"/></Block><DataSet index=\"1\" name=\"lost\" file=\"m/c.vtp\"/>"
      "</vtkMultiBlockDataSet>";
  DatasetSample sample =
      sample_of(vtk_file("vtkMultiBlockDataSet", blocks),
                files_in({{"m/a.vtp", triangle(0, values(0))}, {"m/b.vtp", triangle(1, values(10))}}));
  const MeshAsset mesh = sample.mesh();
  REQUIRE(mesh.parts.size() == 2);
  CHECK(mesh.parts[0].name == "wing/upper");
  CHECK(mesh.parts[1].name == "wing/1");
  REQUIRE(mesh.color_key);
  CHECK(mesh.color_key->title == "t");
  CHECK(mesh.color_key->low == 0);
  CHECK(mesh.color_key->high == 12);
  CHECK_THAT(sample.diagnostics.entries().back().message,
             Catch::Contains("1 file is missing and left out: m/c.vtp: m/c.vtp does not exist"));
}

TEST_CASE("shows the chosen step of surfaces that change with time") {
  const std::string steps =
      "<Collection><DataSet timestep=\"0\" part=\"0\" file=\"a.vtp\"/><DataSet timestep=\"0\" part=\"1\" "
      "file=\"b.vtp\"/><DataSet timestep=\"1\" part=\"0\" file=\"c.vtp\"/></Collection>";
  const ReadFile files = files_in({{"a.vtp", triangle(0)}, {"b.vtp", triangle(1)}, {"c.vtp", triangle(2)}});
  DatasetSample first = sample_of(vtk_file("Collection", steps), files);
  CHECK(polygons_of(first.mesh()) == 2);
  CHECK_THAT(first.diagnostics.entries().front().message, Catch::Contains("step 0 of 2"));
  DatasetSample second = sample_of(vtk_file("Collection", steps), files, at_step(1));
  const MeshAsset mesh = second.mesh();
  REQUIRE(mesh.parts.size() == 1);
  CHECK(mesh.parts[0].geometry.positions[0].z == 2);
  // Legacy files.
  const std::string legacy =
      "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n0 0 7 1 0 7 0 1 7\n"
      "POLYGONS 1 4\n3 0 1 2\n";
  DatasetSample series =
      sample_of(R"({"file-series-version":"1.0","files":[{"name":"a.vtk","time":0}]})", files_in({{"a.vtk", legacy}}));
  CHECK(series.mesh().parts[0].geometry.positions[0].z == 7);
}

TEST_CASE("joins the pieces of a surface, with data of cells, without copies of cells") {
  const auto piece = [](double z, int ghost, double value) {
    return triangle(z, "<CellData>" + ascii("UInt8", "vtkGhostType", {double(ghost)}) + ascii("Float32", "c", {value}) +
                           "</CellData>");
  };
  const std::string pieces =
      "<PPolyData GhostLevel=\"1\"><PCellData><PDataArray type=\"UInt8\" Name=\"vtkGhostType\"/><PDataArray "
      "type=\"Float32\" Name=\"c\"/></PCellData><Piece Source=\"a.vtp\"/><Piece Source=\"b.vtp\"/><Piece "
      "Source=\"c.vtp\"/></PPolyData>";
  DatasetSample sample =
      sample_of(vtk_file("PPolyData", pieces),
                files_in({{"a.vtp", piece(0, 0, 5)}, {"b.vtp", piece(1, 1, 6)}, {"c.vtp", piece(2, 0, 7)}}));
  const MeshAsset mesh = sample.mesh();
  CHECK(polygons_of(mesh) == 2);
  REQUIRE(mesh.color_key);
  CHECK(mesh.color_key->title == "c");
  CHECK(mesh.color_key->low == 5);
  CHECK(mesh.color_key->high == 7);
}

TEST_CASE("never shows arrays that number points or cells by default") {
  for (const char* const name : {"vtkOriginalPointIds", "vtkOriginalCellIds", "vtkGhostType", "GlobalNodeId",
                                 "GlobalElementId", "PedigreeNodeId", "ObjectId"})
    CHECK(is_bookkeeping(name));
  for (const char* const name : {"temperature", "Ghost pressure", "Idle"}) CHECK(!is_bookkeeping(name));
  const std::string data = "<PointData Scalars=\"vtkOriginalPointIds\">" +
                           ascii("Int32", "vtkOriginalPointIds", {0, 1, 2}) + "</PointData><CellData>" +
                           ascii("Float32", "stress", {4}) + "</CellData>";
  DatasetSample sample = sample_of(triangle(0, data));
  const MeshAsset mesh = sample.mesh();
  REQUIRE(mesh.color_key);
  CHECK(mesh.color_key->title == "stress");
  DatasetSample chosen = sample_of(triangle(0, data), nullptr, dataset_choice("vtkOriginalPointIds"));
  CHECK(chosen.mesh().color_key->high == 2);
  const std::string only = "<PointData>" + ascii("Int32", "GlobalNodeId", {0, 1, 2}) + "</PointData>";
  DatasetSample plain = sample_of(triangle(0, only));
  CHECK(!plain.mesh().color_key);
}

TEST_CASE("shows a component of vectors of a surface") {
  const std::string data = "<PointData>" + ascii("Float32", "v", {3, 4, 0, 0, 8, 0, 0, 0, 1}, 3) + "</PointData>";
  DatasetSample length = sample_of(triangle(0, data));
  CHECK(length.mesh().color_key->title == "v (length)");
  VoxelComponent choice;
  choice.index = 1;
  choice.chosen = true;
  DatasetSample second = sample_of(triangle(0, data), nullptr, choice);
  const MeshAsset mesh = second.mesh();
  CHECK(mesh.color_key->title == "v (component 1)");
  CHECK(mesh.color_key->high == 8);
}

TEST_CASE("unpacks arrays that LZ4 and LZMA compressed") {
  // The numbers 1, 2, 3, 4 as VTK and, of LZMA, xz write them.
  const std::pair<std::string, std::string> kinds[] = {
      {"vtkLZ4DataCompressor", "AQAAABAAAAAAAAAAEgAAAA==8AEAAIA/AAAAQAAAQEAAAIBA"},
      {"vtkLZMADataCompressor",
       "AQAAABAAAAAAAAAARAAAAA==/Td6WFoAAAFpIt42AgAhARYAAAB0L+WjAQAPAACAPwAAAEAAAEBAAACAQABUFKeLAA"
       "EkEOlE2cyQQpkNAQAAAAABWVo="}};
  for (const auto& [compressor, data] : kinds) {
    const std::string grid = vtk_file(
        "ImageData",
        "<ImageData WholeExtent=\"0 1 0 1 0 0\"><Piece Extent=\"0 1 0 1 0 0\"><PointData><DataArray type=\"Float32\" "
        "Name=\"d\" format=\"binary\">" +
            data + "</DataArray></PointData></Piece></ImageData>",
        " header_type=\"UInt32\" compressor=\"" + compressor + "\"");
    INFO(compressor);
    CHECK(slice_of(sample_of(grid).opened(), 0) == std::vector<float>{1, 2, 3, 4});
    std::string damaged = grid;
    damaged.replace(damaged.find("AAA", damaged.find("==") + 8), 3, "zzz");
    const auto result = sample_of(damaged).volume();
    if (const auto* const volume = std::get_if<qnv::VolumeSource>(&result)) {
      std::vector<std::byte> bytes(16);
      (void)volume->read(0, bytes);
      CHECK_THAT(volume->trouble(), Catch::Contains("is no") || Catch::Contains("not valid") || Catch::Equals(""));
    }
  }
}

TEST_CASE("reads files that a VTK file names only below its folder") {
  const ScratchFolder folder;
  (void)folder.write("secret.vtp", triangle(0));
  const std::string path =
      folder.write("run/main.vtm",
                   vtk_file("vtkMultiBlockDataSet",
                            "<vtkMultiBlockDataSet><DataSet index=\"0\" file=\"../secret.vtp\"/><DataSet index=\"1\" "
                            "file=\"/etc/passwd\"/><DataSet index=\"2\" file=\"http://127.0.0.1:1/a.vtp\"/>"
                            "</vtkMultiBlockDataSet>"));
  DatasetSample sample = sample_of(folder.read("run/main.vtm"), reader_beside(path, {}));
  REQUIRE(holds_dataset_mesh(sample.source()));
  const Asset asset = read_dataset_mesh(sample.source());
  const auto* const mesh = std::get_if<MeshAsset>(&asset);
  CHECK((!mesh || mesh->parts.empty()));
  CHECK(sample.diagnostics.errors() == 1);
  CHECK_THAT(sample.diagnostics.entries().back().message, Catch::Contains("3 files are missing"));
}

TEST_CASE("reports one message for a damaged file that names others") {
  const auto problem = [](const std::string& text) { return sample_of(text).problem(); };
  CHECK_THAT(problem(vtk_file("Collection", "<Collection/>")), Catch::Contains("names no files"));
  CHECK_THAT(problem("{\"file-series-version\":\"1.0\",\"files\":[3]}"), Catch::Contains("names no files"));
  CHECK_THAT(problem("{\"file-series-version\":\"1.0\",\"files\":"), Catch::Contains("no valid JSON"));
  CHECK_THAT(problem(vtk_file("PImageData", "<PImageData WholeExtent=\"0 1\">")), Catch::Contains("line"));
  // A file that names itself ends.
  const std::string self =
      vtk_file("vtkMultiBlockDataSet", "<vtkMultiBlockDataSet><DataSet file=\"sample\"/></vtkMultiBlockDataSet>");
  DatasetSample endless = sample_of(self, files_in({{"sample", self}}));
  (void)read_dataset_mesh(endless.source());
  CHECK(!endless.diagnostics.entries().empty());
}

TEST_CASE("reads the same facts as VTK from VTK XML files of other programs") {
  const std::string folder = shared_data("vtkxml");
  if (folder.empty()) return;
  std::size_t compared = 0;
  for (const SharedFact& fact : shared_facts(folder + "README.md")) {
    const auto points = number_in(fact.text, " points ");
    const std::size_t array = fact.text.find("; ");
    if (!points || fact.file.ends_with(".vtm")) continue;
    INFO(fact.file);
    DatasetSample sample(file_bytes(folder + fact.file), folder + fact.file);
    sample.read_file = reader_beside(folder + fact.file, {});
    const std::vector<DatasetEntry> entries = sample.entries();
    // Each array with its range, but bookkeeping.
    for (std::size_t at = array; at != std::string::npos; at = fact.text.find("; ", at + 1)) {
      std::string name = fact.text.substr(at + 2, fact.text.find(';', at + 1) - at - 2);
      const bool of_points = name.starts_with("point ");
      name = name.substr(name.find(' ') + 1);
      const std::size_t end = std::min({name.find(" float x"), name.find(" double x"), name.find(" int x"),
                                        name.find(" long long x"), name.find(" idtype x")});
      REQUIRE(end != std::string::npos);
      const std::string range = name.substr(end);
      name.resize(end);
      const bool single = range.find("x1 ") != std::string::npos;
      const auto low = number_in(range, "["), high = number_in(range, ", ");
      DatasetSample one(file_bytes(folder + fact.file), folder + fact.file,
                        dataset_choice((of_points ? "/PointData/" : "/CellData/") + name));
      one.read_file = reader_beside(folder + fact.file, {});
      INFO(name);
      if (!single || !low || !high) continue;
      ++compared;
      if (fact.text.starts_with("vtkRectilinearGrid")) {
        const ValueFacts facts = facts_of(one.opened());
        // Interpolation along uneven axes stays within the range.
        CHECK(facts.least >= *low - std::abs(*low) * 1e-5);
        CHECK(facts.most <= *high + std::abs(*high) * 1e-5);
        CHECK(facts.missing == 0);
      } else {
        const MeshAsset mesh = one.mesh();
        REQUIRE(mesh.color_key);
        CHECK(mesh.color_key->low == Approx(*low).epsilon(1e-4));
        CHECK(mesh.color_key->high == Approx(*high).epsilon(1e-4));
      }
    }
  }
  CHECK(compared >= 30);
}

TEST_CASE("reads the same blocks as VTK from a MultiBlock of another program") {
  const std::string folder = shared_data("vtkxml");
  if (folder.empty()) return;
  DatasetSample blow(file_bytes(folder + "ex-blow_5.vtm"), folder + "ex-blow_5.vtm");
  blow.read_file = reader_beside(folder + "ex-blow_5.vtm", {});
  const MeshAsset mesh = blow.mesh();
  CHECK(mesh.parts.size() == 16);
  std::size_t points = 0;
  for (const MeshPart& part : mesh.parts) points += part.geometry.positions.size();
  CHECK(points == 945);
  REQUIRE(mesh.color_key);
  CHECK(mesh.color_key->title == "THICKNESS");
  VoxelComponent last = at_step(10);
  DatasetSample spheres(file_bytes(folder + "pvd/dualSphereAnimation.pvd"), folder + "pvd/dualSphereAnimation.pvd",
                        last);
  spheres.read_file = reader_beside(folder + "pvd/dualSphereAnimation.pvd", {});
  CHECK(spheres.mesh().parts.size() == 2);
}
