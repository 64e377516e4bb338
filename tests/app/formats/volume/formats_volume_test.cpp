#include "tests/app/volume_files.h"

using namespace gs;
using namespace gs::test;

TEST_CASE("reads sizes and types of raw voxels from the command line") {
  app::RawVolume raw;
  CHECK(app::read_dimensions("256x255X113", raw));
  CHECK(raw.dimensions == std::array<std::uint32_t, 3>{256, 255, 113});
  for (const char* bad : {"", "1x2", "1x2x", "1x2x3x4", "0x2x3", "-1x2x3", "1x2x3 ", "1x2x99999999999"})
    CHECK_FALSE(app::read_dimensions(bad, raw));
  CHECK(raw.dimensions[0] == 256);
  CHECK(app::read_voxel_type("U16BE", raw));
  CHECK((raw.type == VoxelType::u16 && raw.big_endian));
  CHECK(app::read_voxel_type("f64", raw));
  CHECK((raw.type == VoxelType::f64 && !raw.big_endian));
  CHECK(app::read_voxel_type("i8le", raw));
  for (const char* bad : {"", "u", "u7", "u16xe", "float", "u161"}) CHECK_FALSE(app::read_voxel_type(bad, raw));
}

TEST_CASE("opens raw voxels of every type") {
  ScratchFolder folder;
  app::RawVolume raw;
  raw.dimensions = {3, 2, 2};
  raw.spacing = {1, 2, 3};
  raw.offset = 5;
  for_all_types([&](auto kind, const auto& names) {
    if (names.wide) return;
    for (const bool big_endian : {false, true}) {
      raw.type = names.type;
      raw.big_endian = big_endian;
      const qnv::VolumeSource source =
          opened(folder.write("a.raw", "abcde" + string_of(voxels<decltype(kind)>(big_endian)) + "behind"), raw);
      CHECK(source.layout.type == names.type);
      CHECK(source.layout.axes[2] == glm::vec3(0, 0, 3));
      check_values(source);
    }
  });
  CHECK(problem_of(folder.write("short.raw", "abcdefgh"), raw).find("need") != std::string::npos);
  CHECK(problem_of(folder.path("short.raw")).find("--dims") != std::string::npos);
  raw.offset = ~std::uint64_t{0};
  CHECK_FALSE(problem_of(folder.path("a.raw"), raw).empty());
  CHECK_FALSE(problem_of(folder.path("none.raw"), raw).empty());
}

TEST_CASE("detects volumes by their first bytes, else by their names") {
  CHECK(app::is_volume("x", bytes_of("NRRD0005\n")));
  CHECK(app::is_volume("x", bytes_of("# AVS field file\n")));
  CHECK(app::is_volume("x", bytes_of("ObjectType = Image\n")));
  CHECK(app::is_volume("x", bytes_of("SIMPLE  =                    T")));
  CHECK(app::is_volume("x", bytes_of("<?xml version=\"1.0\"?><VTKFile type=\"ImageData\">")));
  CHECK(app::is_volume("x", Nifti1(true, 2, 8, "n+1", 352).bytes));
  CHECK(app::is_volume("x", gzipped(Nifti1(false, 2, 8, "n+1", 352).bytes)));
  CHECK(app::is_volume("a.NII.gz", bytes_of("")));
  CHECK(app::is_volume("a.raw", bytes_of("abc")));
  CHECK_FALSE(app::is_volume("x", bytes_of("")));
  CHECK_FALSE(app::is_volume("a.wrl", bytes_of("#VRML V2.0 utf8\n")));
  CHECK_FALSE(app::is_volume("a.ply", bytes_of("ply\n")));
  CHECK_FALSE(app::is_volume("a.vtu", bytes_of("<VTKFile type=\"UnstructuredGrid\">")));
  for (const char* const name : {"DICOM", "NRRD", "TIFF", "HDF5", "NetCDF", "Zarr", "raw voxels"})
    CHECK(std::ranges::count(app::volume_format_names(), name, &app::VolumeFormatName::name) == 1);
  ScratchFolder folder;
  CHECK(problem_of(folder.write("a.xyz", "abc")).find("NIfTI") != std::string::npos);
  CHECK(problem_of(folder.write("a.nrrd", "")).find("empty") != std::string::npos);
}

TEST_CASE("survives every prefix and every changed byte of a volume file") {
  ScratchFolder folder;
  const Bytes data = voxels<std::int16_t>(false);
  const std::string nrrd = "NRRD0004\ntype: short\ndimension: 3\nsizes: 3 2 2\nspacings: 1 2 3\nendian: little\n";
  check_prefixes_and_flips(folder, "a.nrrd", bytes_of(nrrd + "encoding: raw\n\n") + data);
  check_prefixes_and_flips(folder, "b.nrrd", bytes_of(nrrd + "encoding: gzip\n\n") + gzipped(data));
  check_prefixes_and_flips(folder, "c.nrrd", bytes_of(nrrd + "encoding: ascii\n\n0 1 2 3 4 5 6 7 8 9 10 11"));
  check_prefixes_and_flips(
      folder, "d.nrrd",
      bytes_of("NRRD0004\ntype: uchar\ndimension: 4\nsizes: 2 3 2 2\nspace directions: none (1,0,0) (0,1,0) (0,0,1)\n"
               "encoding: raw\n\n") +
          data);
  check_prefixes_and_flips(
      folder, "a.mha",
      bytes_of("ObjectType = Image\nNDims = 3\nDimSize = 3 2 2\nElementType = MET_SHORT\n"
               "ElementSpacing = 1 2 3\nTransformMatrix = 1 0 0 0 1 0 0 0 1\nCompressedData = True\n"
               "ElementDataFile = LOCAL\n") +
          zlib_packed(data));
  check_prefixes_and_flips(folder, "a.fld", bytes_of(kAvs + "short\nmin_ext=0 0 0\nmax_ext=1 1 1\n\f\f") + data + data);
  Nifti1 nifti(false, 4, 16, "n+1", 352);
  nifti.set<std::int16_t>(252, 1);
  nifti.set<std::int16_t>(254, 1);
  check_prefixes_and_flips(folder, "a.nii", nifti.bytes + data);
  check_prefixes_and_flips(folder, "a.nii.gz", gzipped(nifti.bytes + data));
  const Bytes packed = zlib_packed(data);
  check_prefixes_and_flips(folder, "a.vti",
                           bytes_of(vti("<DataArray type=\"Int16\" Name=\"s\" format=\"appended\" offset=\"0\"/>",
                                        "<AppendedData encoding=\"raw\">_" +
                                            string_of(words<std::uint32_t>(false, {1, 24, 0, packed.size()}) + packed),
                                        "byte_order=\"LittleEndian\" compressor=\"vtkZLibDataCompressor\"")));
  check_prefixes_and_flips(folder, "b.vti",
                           bytes_of(vti("<DataArray type=\"Int16\" Name=\"s\" format=\"binary\">" +
                                            base64(words<std::uint32_t>(false, {24}) + data) + "</DataArray>",
                                        "", "")));
}

TEST_CASE("survives every prefix and every changed byte of a FITS file") {
  ScratchFolder folder;
  const std::string whole =
      fits({"SIMPLE  =                    T", "BITPIX  =                   16", "NAXIS   =                    3",
            "NAXIS1  =                    3", "NAXIS2  =                    2", "NAXIS3  =                    2",
            "CDELT1  = 1.0", "BSCALE  = 2.0", "BLANK   = 5", "OBJECT  = 'x'"},
           voxels<std::int16_t>(true));
  std::mt19937 random(2);
  for (std::size_t n = 0; n < whole.size(); n += n < 900 ? 7 : 97)
    check_sound(folder.write("a.fits", whole.substr(0, n)));
  for (std::size_t i = 0; i < 880; ++i) {
    std::string changed = whole;
    changed[i] = static_cast<char>(i % 2 == 0 ? '0' + random() % 10 : random() % 256);
    check_sound(folder.write("a.fits", changed));
  }
}

TEST_CASE("opens real volumes with the values that their sources publish") {
  const auto folder = test::shared_folder() / "data" / "volumes";
  if (!std::filesystem::is_directory(folder)) {
    WARN("no volumes in ../shared/data");
    return;
  }
  struct Expected {
    const char* path;
    std::array<std::uint32_t, 3> dimensions;
    VoxelType type;
    glm::vec3 steps;
    float least, most;
  };
  const Expected all[] = {
      {"cthead/CThead.nhdr", {256, 256, 113}, VoxelType::u16, {1, 1, 2}, 0, 3272},
      {"headsq/headsq_quarter.nhdr", {64, 64, 93}, VoxelType::u16, {3.2f, 3.2f, 1.5f}, 0, 3926},
      {"seg3d/tooth.nhdr", {103, 94, 161}, VoxelType::u16, {1, 1, 1}, 0, 1300},
      {"openscivis/bonsai.nii.gz", {256, 256, 256}, VoxelType::u8, {1, 1, 1}, 0, 255},
      {"openscivis/fuel.nii.gz", {64, 33, 32}, VoxelType::u8, {1, 1, 1}, 0, 255},
      {"vtkjs/engine.vti", {256, 256, 128}, VoxelType::u8, {1, 1, 1}, 0, 255},
      {"astro/l1448_13co.fits", {105, 105, 53}, VoxelType::f32, {1, 1, 1}, -0.66f, 4.0f},
      {"astro/orion_12CO_mom0.fits", {209, 177, 1}, VoxelType::f64, {0.125f, 0.125f, 0.125f}, -4.8f, 323.4f},
  };
  for (const Expected& expected : all) {
    const auto path = folder / expected.path;
    if (!std::filesystem::exists(path)) {
      WARN("no " << expected.path);
      continue;
    }
    INFO(expected.path);
    const Bytes bytes = test::file_bytes(path);
    CHECK(app::is_volume("unnamed", std::span(bytes).first(std::min<std::size_t>(bytes.size(), 1024))));
    const qnv::VolumeSource source = opened(path.string());
    CHECK(source.layout.dimensions == expected.dimensions);
    CHECK(source.layout.type == expected.type);
    for (int i = 0; i < 3; ++i) CHECK(source.layout.axes[static_cast<std::size_t>(i)][i] == Approx(expected.steps[i]));
    float least = INFINITY, most = -INFINITY;
    for (const float value : values_of(source)) {
      least = std::min(least, value);
      most = std::max(most, value);
    }
    CHECK(least == Approx(expected.least).margin(0.05));
    CHECK(most == Approx(expected.most).margin(0.05));
  }
}
