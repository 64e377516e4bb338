#include "tests/app/volume_files.h"

using namespace gs;
using namespace gs::test;

namespace {

/// Encodings of an array in a file.
template <class Word>
void check_vti(const ScratchFolder& folder, const Bytes& data, const char* type, bool big_endian,
               const char* word_name) {
  const std::string order = std::string("byte_order=\"") + (big_endian ? "BigEndian" : "LittleEndian") +
                            "\" header_type=\"" + word_name + "\"";
  const std::string packer = " compressor=\"vtkZLibDataCompressor\"";
  const std::string start = std::string("<DataArray type=\"") + type + "\" Name=\"s\" ";
  const auto inline_array = [&](const std::string& body) {
    return start + "format=\"binary\">\n  " + body + "\n</DataArray>\n";
  };
  const std::string appended_array = start + "format=\"appended\" offset=\"4\"/>\n";
  const auto appended = [&](const std::string& encoding, const std::string& body) {
    return "<AppendedData encoding=\"" + encoding + "\">\n  _AAAA" + body + "\n</AppendedData>\n";
  };
  const Bytes length = words<Word>(big_endian, {data.size()});
  check_values(opened(folder.write("a.vti", vti(inline_array(base64(length + data)), "", order))));
  check_values(opened(folder.write("a.vti", vti(inline_array(base64(length) + base64(data)), "", order))));
  check_values(opened(folder.write("a.vti", vti(appended_array, appended("base64", base64(length + data)), order))));
  check_values(opened(folder.write("a.vti", vti(appended_array, appended("raw", string_of(length + data)), order))));

  const std::size_t block = data.size() / 12 * 5;  // two whole blocks and a remainder
  const auto part = [&](std::size_t i) {
    return Bytes(data.begin() + static_cast<std::ptrdiff_t>(i * block),
                 data.begin() + static_cast<std::ptrdiff_t>(std::min(data.size(), (i + 1) * block)));
  };
  const Bytes a = zlib_packed(part(0)), b = zlib_packed(part(1)), c = zlib_packed(part(2));
  const Bytes table = words<Word>(big_endian, {3, block, data.size() - 2 * block, a.size(), b.size(), c.size()});
  check_values(opened(
      folder.write("a.vti", vti(appended_array, appended("raw", string_of(table + a + b + c)), order + packer))));
  check_values(opened(folder.write("a.vti", vti(inline_array(base64(table) + base64(a + b + c)), "", order + packer))));
  const Bytes whole = zlib_packed(data), one = words<Word>(big_endian, {1, data.size(), 0, whole.size()});
  check_values(opened(
      folder.write("a.vti", vti(appended_array, appended("base64", base64(one) + base64(whole)), order + packer))));
}

}  // namespace

TEST_CASE("reads the unit of VTI arrays before or after their values") {
  ScratchFolder folder;
  const auto with = [](const std::string& before, const std::string& behind) {
    return "<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"0 1 0 1 0 1\"><Piece Extent=\"0 1 0 1 0 "
           "1\"><PointData>"
           "<DataArray type=\"UInt8\" Name=\"heat\" format=\"ascii\">" +
           before + "1 2 3 4 5 6 7 8" + behind + "</DataArray></PointData></Piece></ImageData></VTKFile>";
  };
  const std::string unit =
      "\n<InformationKey name=\"UNITS_LABEL\" location=\"vtkDataArray\">\n K/m\n</InformationKey>\n";
  const std::string other =
      "<InformationKey name=\"L2_NORM_RANGE\" location=\"vtkDataArray\" length=\"2\"><Value index=\"0\">"
      "9</Value><Value index=\"1\">12</Value></InformationKey>";
  for (const auto& text :
       {with(other + unit, ""), with(unit + other, "\n"), with("", unit + other), with(" ", other + unit)}) {
    INFO(text);
    const qnv::VolumeSource source = opened(folder.write("a.vti", text));
    const auto& said = source.layout.metadata;
    CHECK(std::find(said.begin(), said.end(), std::pair<std::string, std::string>("units", "K/m")) != said.end());
    CHECK(source.layout.dimensions == std::array<std::uint32_t, 3>{2, 2, 2});
  }
  const qnv::VolumeSource plain = opened(folder.write("a.vti", with(other, "")));
  CHECK(plain.layout.metadata.size() == 1);
}

TEST_CASE("opens NIfTI files of every type and byte order") {
  ScratchFolder folder;
  const std::map<std::string, std::int16_t> codes = {{"UInt8", 2},    {"Int16", 4},    {"Int32", 8},    {"Float32", 16},
                                                     {"Float64", 64}, {"Int8", 256},   {"UInt16", 512}, {"UInt32", 768},
                                                     {"Int64", 1024}, {"UInt64", 1280}};
  for_all_types([&](auto kind, const auto& names) {
    for (const bool big_endian : {false, true}) {
      INFO(names.vti);
      const Bytes data = voxels<decltype(kind)>(big_endian);
      const auto bits = static_cast<std::int16_t>(8 * sizeof(kind));
      Nifti1 one(big_endian, codes.at(names.vti), bits, "n+1", 352);
      const qnv::VolumeSource source = opened(folder.write("a.nii", string_of(one.bytes + data)));
      check_values(source);
      CHECK(source.layout.type == names.type);
      CHECK(source.layout.axes[0] == glm::vec3(1.5f, 0, 0));
      CHECK(source.layout.axes[2] == glm::vec3(0, 0, 3.5f));
      one.set<float>(112, 2);
      one.set<float>(116, -5);
      check_values(opened(folder.write("a.nii.gz", string_of(gzipped(one.bytes + data)))), 2, -5);
      const Nifti1 two(big_endian, codes.at(names.vti), bits, "ni1", 0);
      folder.write("b.hdr", string_of(two.bytes).substr(0, 348));
      folder.write("b.img", string_of(data));
      check_values(opened(folder.path("b.hdr")));
      check_values(opened(folder.path("b.img")));
    }
  });
}

TEST_CASE("takes NIfTI positions from the sform, else from the qform") {
  ScratchFolder folder;
  const Bytes data = voxels<std::uint8_t>(false);
  Nifti1 header(false, 2, 8, "n+1", 352);
  header.set<std::int16_t>(252, 1);  // qform_code
  header.set<float>(76, -1);         // qfac
  header.set<float>(264, 1);         // quatern_d = 1: half a turn about z
  for (std::size_t i = 0; i < 3; ++i) header.set<float>(268 + 4 * i, static_cast<float>(i + 1));
  const qnv::VolumeSource turned = opened(folder.write("q.nii", string_of(header.bytes + data)));
  CHECK(turned.layout.axes[0] == glm::vec3(-1.5f, 0, 0));
  CHECK(turned.layout.axes[2] == glm::vec3(0, 0, -3.5f));
  CHECK(turned.layout.origin == glm::dvec3(1, 2, 3));
  header.set<std::int16_t>(254, 1);  // sform_code
  const std::array<float, 12> rows = {0, -2, 0, 10, 3, 0, 0, 20, 0, 0, 4, 30};
  for (std::size_t i = 0; i < 12; ++i) header.set<float>(280 + 4 * i, rows[i]);
  const qnv::VolumeSource placed = opened(folder.write("s.nii", string_of(header.bytes + data)));
  CHECK(placed.layout.axes[0] == glm::vec3(0, 3, 0));
  CHECK(placed.layout.axes[1] == glm::vec3(-2, 0, 0));
  CHECK(placed.layout.origin == glm::dvec3(10, 20, 30));
  // If the matrix is singular, the step sizes apply.
  for (std::size_t i = 0; i < 12; ++i) header.set<float>(280 + 4 * i, 0.0f);
  CHECK(opened(folder.write("s.nii", string_of(header.bytes + data))).layout.axes[1] == glm::vec3(0, 2.5f, 0));

  Nifti1 rgb(false, 128, 24, "n+1", 352);
  Bytes colors;
  for (const int value : kValues)
    for (const int c : {value, 1, 2}) colors.push_back(static_cast<std::byte>(c));
  const qnv::VolumeSource painted = opened(folder.write("c.nii", string_of(rgb.bytes + colors)));
  CHECK(painted.layout.colors);
  REQUIRE(painted.components.size() == 3);
  check_values(painted.components[0]);

  Nifti1 broken(false, 2, 8, "n+1", 352);
  broken.set<std::int16_t>(42, -3);
  CHECK(problem_of(folder.write("p.nii", string_of(broken.bytes + data))).find("dimensions") != std::string::npos);
  Nifti1 strange(false, 1536, 128, "n+1", 352);
  CHECK(problem_of(folder.write("p.nii", string_of(strange.bytes + data))).find("1536") != std::string::npos);
  CHECK(problem_of(folder.write("p.nii", string_of(Nifti1(false, 2, 8, "n+1", 352).bytes))).find("need") !=
        std::string::npos);
  folder.write("lonely.hdr", string_of(Nifti1(false, 2, 8, "ni1", 0).bytes));
  CHECK(problem_of(folder.path("lonely.hdr")).find("lonely.img") != std::string::npos);
}

TEST_CASE("reads a NIfTI header of unknown version as ANALYZE") {
  ScratchFolder folder;
  for (const char* magic : {"n+5", "ni9", "n+2", "n-1"})
    for (const bool big_endian : {false, true}) {
      INFO(magic);
      const Nifti1 header(big_endian, 2, 8, magic, 352);
      CHECK(
          problem_of(folder.write("a.nii", string_of(header.bytes + voxels<std::uint8_t>(big_endian)))).find("a.img") !=
          std::string::npos);
    }
}

TEST_CASE("opens NIfTI-2 files") {
  ScratchFolder folder;
  for (const bool big_endian : {false, true}) {
    Nifti1 header(big_endian, 0, 0, "n+2", 0);
    header.bytes.assign(544, std::byte{0});
    header.set<std::int32_t>(0, 540);
    std::memcpy(header.bytes.data() + 4, "n+2\0\r\n\032\n", 8);
    header.set<std::int16_t>(12, 512);
    header.set<std::int16_t>(14, 16);
    const std::array<std::int64_t, 8> dimensions = {3, 3, 2, 2, 1, 1, 1, 1};
    for (std::size_t i = 0; i < 8; ++i) header.set<std::int64_t>(16 + 8 * i, dimensions[i]);
    for (std::size_t i = 0; i < 4; ++i) header.set<double>(104 + 8 * i, 1.0 + static_cast<double>(i));
    header.set<std::int64_t>(168, 544);
    const qnv::VolumeSource source =
        opened(folder.write("a.nii", string_of(header.bytes + voxels<std::uint16_t>(big_endian))));
    check_values(source);
    CHECK(source.layout.axes[1] == glm::vec3(0, 3, 0));
  }
}

TEST_CASE("opens FITS cubes of every type") {
  ScratchFolder folder;
  const auto cube = [&](int bits, const Bytes& data, const std::vector<std::string>& more = {}) {
    std::vector<std::string> cards = {"SIMPLE  =                    T", "BITPIX  = " + std::to_string(bits),
                                      "NAXIS   =                    3", "NAXIS1  =                    3",
                                      "NAXIS2  =                    2", "NAXIS3  =                    2"};
    cards.insert(cards.end(), more.begin(), more.end());
    return folder.write("a.fits", fits(cards, data));
  };
  check_values(opened(cube(8, voxels<std::uint8_t>(true))));
  check_values(opened(cube(16, voxels<std::int16_t>(true))));
  check_values(opened(cube(32, voxels<std::int32_t>(true))));
  check_values(opened(cube(64, voxels<std::int64_t>(true))));
  check_values(opened(cube(-32, voxels<float>(true))));
  check_values(opened(cube(-64, voxels<double>(true))));
  check_values(opened(cube(16, voxels<std::int16_t>(true), {"BSCALE  = 0.5", "BZERO   = 32768"})), 0.5f, 32768);
  folder.write("a.fits.gz", string_of(gzipped(bytes_of(folder.read("a.fits")))));
  check_values(opened(folder.path("a.fits.gz")), 0.5f, 32768);

  SECTION("with missing voxels") {
    const std::vector<float> blank =
        values_of(opened(cube(16, voxels<std::int16_t>(true), {"BLANK   = 77", "BSCALE  = 2.0"})));
    CHECK(std::isnan(blank[7]));
    CHECK(blank[10] == 200);
    Bytes data = voxels<float>(true);
    Bytes nan;
    test::put_big(nan, std::nanf(""));
    std::copy(nan.begin(), nan.end(), data.begin() + 8);
    CHECK(std::isnan(values_of(opened(cube(-32, data)))[2]));
  }
  SECTION("with steps of one unit, else in voxels") {
    const Bytes data = voxels<std::uint8_t>(true);
    const std::vector<std::string> degrees = {"CDELT1  = -0.5", "CDELT2  = 0.5", "CDELT3  = 1.5",
                                              "OBJECT  = 'M 31    '", "BUNIT   = 'K       '"};
    const qnv::VolumeSource source = opened(cube(8, data, degrees));
    CHECK(source.layout.axes[0] == glm::vec3(0.5f, 0, 0));
    CHECK(source.layout.axes[2] == glm::vec3(0, 0, 1.5f));
    CHECK(source.layout.metadata ==
          std::vector<std::pair<std::string, std::string>>{{"title", "M 31"}, {"units", "K"}});
    std::vector<std::string> mixed = degrees;
    mixed.insert(mixed.end(), {"CUNIT1  = 'deg'", "CUNIT2  = 'deg'", "CUNIT3  = 'm/s'"});
    CHECK(opened(cube(8, data, mixed)).layout.axes[2] == glm::vec3(0, 0, 1));
  }
  SECTION("as a slice, with an axis too many, and behind an empty first header") {
    const Bytes data = voxels<std::uint8_t>(true);
    const qnv::VolumeSource flat = opened(folder.write(
        "b.fits", fits({"SIMPLE  = T", "BITPIX  = 8", "NAXIS   = 2", "NAXIS1  = 6", "NAXIS2  = 2"}, data)));
    CHECK(flat.layout.dimensions == std::array<std::uint32_t, 3>{6, 2, 1});
    check_values(opened(folder.write("b.fits", fits({"SIMPLE  = T", "BITPIX  = 8", "NAXIS   = 4", "NAXIS1  = 3",
                                                     "NAXIS2  = 2", "NAXIS3  = 1", "NAXIS4  = 2"},
                                                    data))));
    const std::string empty = fits({"SIMPLE  = T", "BITPIX  = 8", "NAXIS   = 0", "EXTEND  = T"}, {});
    check_values(
        opened(folder.write("b.fits", empty + fits({"XTENSION= 'IMAGE   '", "BITPIX  = 8", "NAXIS   = 3", "NAXIS1  = 3",
                                                    "NAXIS2  = 2", "NAXIS3  = 2", "PCOUNT  = 0", "GCOUNT  = 1"},
                                                   data))));
    CHECK(problem_of(folder.write("b.fits", empty)).find("image") != std::string::npos);
    CHECK(problem_of(folder.write("b.fits", fits({"SIMPLE  = T", "BITPIX  = 8", "NAXIS   = 4", "NAXIS1  = 3",
                                                  "NAXIS2  = 2", "NAXIS3  = 2", "NAXIS4  = 2"},
                                                 data + data)))
              .find("axes") != std::string::npos);
    CHECK(problem_of(folder.write("b.fits", fits({"SIMPLE  = T", "BITPIX  = 8", "NAXIS   = 3", "NAXIS1  = 300",
                                                  "NAXIS2  = 200", "NAXIS3  = 200"},
                                                 data)))
              .find("need") != std::string::npos);
  }
}

TEST_CASE("opens VTI files of every type, byte order and encoding") {
  ScratchFolder folder;
  for_all_types([&](auto kind, const auto& names) {
    for (const bool big_endian : {false, true}) {
      INFO(names.vti);
      const Bytes data = voxels<decltype(kind)>(big_endian);
      check_vti<std::uint32_t>(folder, data, names.vti, big_endian, "UInt32");
      check_vti<std::uint64_t>(folder, data, names.vti, big_endian, "UInt64");
    }
  });
  const std::string ascii =
      "<DataArray type=\"Int16\" Name=\"s\" format=\"ascii\">0 1 2 3 40 5\n6 77 8 9 100 11</DataArray>";
  const std::string other =
      "<DataArray type=\"Float32\" Name=\"v\" NumberOfComponents=\"3\" format=\"ascii\">1 2 3</DataArray>";
  const qnv::VolumeSource source = opened(folder.write("a.vti", vti(other + ascii, "", "")));
  check_values(source);
  CHECK(source.layout.origin == glm::dvec3(6, 6, 7));
  CHECK(source.layout.axes[2] == glm::vec3(0, 0, 3));
  CHECK(source.layout.metadata == std::vector<std::pair<std::string, std::string>>{{"array", "s"}});
}

TEST_CASE("places VTI cell values at the cell centres") {
  ScratchFolder folder;
  const qnv::VolumeSource source = opened(folder.write(
      "c.vti",
      "<VTKFile type='ImageData'><ImageData WholeExtent='0 3 0 2 0 2' Origin='0 0 0' Spacing='2 2 2' "
      "Direction='0 -1 0 1 0 0 0 0 1'><Piece Extent='0 3 0 2 0 2'><CellData><DataArray type='UInt8' Name='c' "
      "format='ascii'>0 1 2 3 40 5 6 77 8 9 100 11</DataArray></CellData></Piece></ImageData></VTKFile>"));
  check_values(source);
  CHECK(source.layout.axes[0] == glm::vec3(0, 2, 0));
  CHECK(source.layout.axes[1] == glm::vec3(-2, 0, 0));
  CHECK(source.layout.origin == glm::dvec3(-1, 1, 1));
}

TEST_CASE("reports VTI files with unexpected content") {
  ScratchFolder folder;
  const std::string array = "<DataArray type=\"UInt8\" Name=\"s\" format=\"appended\" offset=\"0\"/>";
  const auto problem = [&](const std::string& content) { return problem_of(folder.write("p.vti", content)); };
  CHECK(problem("<VTKFile type=\"PolyData\"></VTKFile>").find("PolyData") != std::string::npos);
  CHECK(problem("<VTKFile type=\"ImageData\"").find("XML") != std::string::npos);
  CHECK(problem(vti("", "", "")).find("DataArray") != std::string::npos);
  CHECK(problem(vti(array, "", "")).find("AppendedData") != std::string::npos);
  CHECK(problem(vti(array, "<AppendedData encoding=\"raw\">_\x05", "")).find("ends") != std::string::npos);
  CHECK(problem(vti(array, "<AppendedData encoding=\"raw\">_", "compressor=\"vtkQ4DataCompressor\"")).find("q4") !=
        std::string::npos);
  const Bytes huge = words<std::uint64_t>(false, {~std::size_t{0}, ~std::size_t{0}, 1, 1});
  CHECK(problem(vti(array, "<AppendedData encoding=\"raw\">_" + string_of(huge),
                    "header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\""))
            .find("table") != std::string::npos);
}
