#include "tests/app/volume_files.h"

using namespace gs;
using namespace gs::test;

TEST_CASE("opens NRRD files of every type, byte order and encoding") {
  ScratchFolder folder;
  for_all_types([&](auto kind, const auto& names) {
    for (const bool big_endian : {false, true}) {
      const Bytes data = voxels<decltype(kind)>(big_endian);
      const std::string header =
          std::string("NRRD0004\n# comment\ntype: ") + names.nrrd +
          "\ndimension: 3\nsizes: 3 2 2\nspacings: 1 2 0.5\nendian: " + (big_endian ? "big" : "little") +
          "\ncontent: a test\nkey:=value\n";
      INFO(header);
      const qnv::VolumeSource raw = opened(folder.write("a.nrrd", header + "encoding: raw\n\n" + string_of(data)));
      CHECK(raw.layout.type == names.type);
      CHECK(raw.layout.axes[1] == glm::vec3(0, 2, 0));
      CHECK(raw.layout.metadata ==
            std::vector<std::pair<std::string, std::string>>{{"title", "a test"}, {"key", "value"}});
      check_values(raw);
      check_values(opened(folder.write("a.nrrd", header + "encoding: gzip\n\n" + string_of(gzipped(data)))));
      check_values(
          opened(folder.write("a.nrrd.gz", string_of(gzipped(bytes_of(header + "encoding: raw\n\n") + data)))));
      folder.write("a.raw", "line one\nline two\n12345" + string_of(data));
      check_values(
          opened(folder.write("a.nhdr", header + "encoding: raw\nline skip: 2\nbyte skip: 5\ndata file: ./a.raw\n")));
      check_values(opened(folder.write("a.nhdr", header + "encoding: raw\nbyte skip: -1\ndatafile: a.raw\n")));
      folder.write("a.raw.gz", string_of(gzipped(data)));
      check_values(opened(folder.write("a.nhdr", header + "encoding: gz\ndata file: a.raw.gz\n")));
    }
  });
  const std::string ascii = "NRRD0004\ntype: short\ndimension: 3\nsizes: 3 2 2\nencoding: ascii\n\n";
  check_values(opened(folder.write("t.nrrd", ascii + "0 1 2\n3,40 5\n6 77 8 9 100 11\n")));
  // A text's numbers keep the type of the header if possible.
  CHECK(opened(folder.write("t.nrrd", ascii + "0 1 2\n3,40 5\n6 77 8 9 100 11\n")).layout.type == qnv::VoxelType::i16);
  for (const auto& [type, last, kept] :
       {std::tuple("uchar", "255", qnv::VoxelType::u8), std::tuple("uchar", "256", qnv::VoxelType::f64),
        std::tuple("uchar", "1.5", qnv::VoxelType::f64), std::tuple("signed char", "-128", qnv::VoxelType::i8),
        std::tuple("unsigned char", "-1", qnv::VoxelType::f64), std::tuple("uint", "4294967295", qnv::VoxelType::u32),
        std::tuple("int", "nan", qnv::VoxelType::f64), std::tuple("float", "0.1", qnv::VoxelType::f32),
        std::tuple("float", "1e300", qnv::VoxelType::f64), std::tuple("double", "1e300", qnv::VoxelType::f64)}) {
    INFO(type << " " << last);
    const qnv::VolumeSource one =
        opened(folder.write("t.nrrd", "NRRD0004\ntype: " + std::string(type) +
                                          "\ndimension: 3\nsizes: 2 1 1\nencoding: ascii\n\n3 " + last));
    CHECK(one.layout.type == kept);
    std::vector<std::byte> scratch;
    std::vector<float> values(2);
    REQUIRE(qnv::read_slice(one, 0, scratch, values));
    CHECK(values[0] == 3);
    if (std::string_view(last) == "nan" || std::string_view(last) == "1e300")
      CHECK(std::isnan(values[1]));  // no value of a voxel
    else
      CHECK(values[1] == static_cast<float>(std::stod(last)));
  }
  CHECK(problem_of(folder.write("t.nrrd", ascii + "0 1 2\n3 40 5\n6 77 8 9 100")).find("numbers") != std::string::npos);
}

TEST_CASE("interprets NRRD axes and components") {
  ScratchFolder folder;
  const std::string start = "NRRD0005\ntype: uchar\nencoding: raw\n";
  Bytes pairs;
  for (const int value : kValues) {
    pairs.push_back(static_cast<std::byte>(value));
    pairs.push_back(std::byte{99});
  }
  const qnv::VolumeSource vectors = opened(folder.write(
      "v.nrrd", start +
                    "dimension: 4\nsizes: 2 3 2 2\nspace: left-posterior-superior\nspace directions: none (1,0,0) "
                    "(0, 0.5, 0.5) (0,-1,1)\nspace origin: (7,8,9)\nkinds: vector domain domain domain\n\n" +
                    string_of(pairs)));
  check_values(vectors);
  CHECK(vectors.layout.axes[1] == glm::vec3(0, 0.5f, 0.5f));
  CHECK(vectors.layout.origin == glm::dvec3(7, 8, 9));
  const Bytes data = voxels<std::uint8_t>(false);
  check_values(opened(folder.write("v.nrrd", start + "dimension: 4\nsizes: 3 2 2 1\n\n" + string_of(data))));
  const qnv::VolumeSource flat =
      opened(folder.write("f.nrrd", start + "dimension: 2\nsizes: 4 3\n\n" + string_of(data)));
  CHECK(flat.layout.dimensions == std::array<std::uint32_t, 3>{4, 3, 1});

  const auto problem = [&](const std::string& header) {
    return problem_of(folder.write("p.nrrd", "NRRD0004\n" + header + "\n" + string_of(data)));
  };
  CHECK(problem("type: uchar\ndimension: 3\nsizes: 3 2 2\ndata file: LIST\n").find("list of files") !=
        std::string::npos);
  CHECK(problem("type: uchar\ndimension: 3\nsizes: 3 2 2\ndata file: a%03d.raw 1 9 1\n").find("list") !=
        std::string::npos);
  CHECK(problem("type: block\ndimension: 3\nsizes: 3 2 2\n").find("block") != std::string::npos);
  CHECK(problem("type: uchar\ndimension: 3\nsizes: 3 2\n").find("sizes") != std::string::npos);
  CHECK(problem("type: uchar\ndimension: 3\nsizes: 3 2 -2\n").find("whole") != std::string::npos);
  CHECK(problem("type: uchar\ndimension: 3\nsizes: 3 2 2.5\n").find("whole") != std::string::npos);
  CHECK(problem("type: uchar\ndimension: 3\nsizes: 3 2 2\nencoding: bzip2\n").find("bzip2") != std::string::npos);
  CHECK(problem("type: uchar\ndimension: 3\nsizes: 4000000000 4000000000 4000000000\n").find("2^48") !=
        std::string::npos);
  CHECK(problem("type: uchar\ndimension: 3\nsizes: 60000 60000 1\nencoding: gzip\n").find("cannot contain") !=
        std::string::npos);
  CHECK(problem("type: uchar\ndimension: 3\nsizes: 3 2 2\ndata file: nowhere.raw\n").find("nowhere") !=
        std::string::npos);
}

TEST_CASE("opens MetaImage files of every type and byte order") {
  ScratchFolder folder;
  for_all_types([&](auto kind, const auto& names) {
    for (const bool big_endian : {false, true}) {
      const Bytes data = voxels<decltype(kind)>(big_endian);
      const std::string header = std::string("ObjectType = Image\nNDims = 3\nDimSize = 3 2 2\nElementType = ") +
                                 names.meta + "\nElementByteOrderMSB = " + (big_endian ? "True" : "False") +
                                 "\nElementSpacing = 1 2 3\nOffset = 4 5 6\nTransformMatrix = 0 1 0 -1 0 0 0 0 1\n";
      INFO(header);
      const qnv::VolumeSource local =
          opened(folder.write("a.mha", header + "ElementDataFile = LOCAL\n" + string_of(data)));
      check_values(local);
      CHECK(local.layout.axes[0] == glm::vec3(0, 1, 0));
      CHECK(local.layout.axes[1] == glm::vec3(-2, 0, 0));
      CHECK(local.layout.axes[2] == glm::vec3(0, 0, 3));
      CHECK(local.layout.origin == glm::dvec3(4, 5, 6));
      folder.write("a data.raw", string_of(data));
      check_values(opened(folder.write("a.mhd", header + "ElementDataFile = a data.raw\n")));
      folder.write("a.zraw", string_of(zlib_packed(data)));
      check_values(opened(folder.write("a.mhd", header + "CompressedData = True\nElementDataFile = a.zraw\n")));
      check_values(opened(folder.write(
          "a.mha", header + "CompressedData = True\nElementDataFile = LOCAL\n" + string_of(zlib_packed(data)))));
      folder.write("h.raw", "some header" + string_of(data));
      check_values(opened(folder.write("a.mhd", header + "HeaderSize = 11\nElementDataFile = h.raw\n")));
      check_values(opened(folder.write("a.mhd", header + "HeaderSize = -1\nElementDataFile = h.raw\n")));
    }
  });
  const std::string header = "NDims = 3\nDimSize = 3 2 2\nElementType = MET_SHORT\n";
  check_values(opened(
      folder.write("t.mha", header + "BinaryData = False\nElementDataFile = LOCAL\n0 1 2 3 40 5 6 77 8 9 100 11")));
  CHECK(problem_of(folder.write("p.mhd", header + "ElementDataFile = LIST\n")).find("list") != std::string::npos);
  CHECK(problem_of(folder.write("p.mhd", header)).find("ElementDataFile") != std::string::npos);
  CHECK(problem_of(folder.write("p.mhd", header + "ElementDataFile = LOCAL\nabc")).find("need") != std::string::npos);
}

TEST_CASE("opens AVS fields") {
  ScratchFolder folder;
  const auto field = [&](const std::string& type, const Bytes& data) {
    return opened(folder.write("a.fld", kAvs + type + "\n\f\f" + string_of(data)));
  };
  check_values(field("byte", voxels<std::uint8_t>(false)));
  check_values(field("short", voxels<std::int16_t>(false)));
  check_values(field("integer", voxels<std::int32_t>(false)));
  check_values(field("float", voxels<float>(false)));
  check_values(field("double", voxels<double>(false)));
  check_values(field("xdr_short", voxels<std::int16_t>(true)));
  check_values(field("xdr_integer", voxels<std::int32_t>(true)));
  check_values(field("xdr_float", voxels<float>(true)));
  check_values(field("xdr_double", voxels<double>(true)));
  CHECK(field("byte", voxels<std::uint8_t>(false)).layout.metadata ==
        std::vector<std::pair<std::string, std::string>>{{"label", "density"}});

  SECTION("with the extent of their axes behind the voxels, in either byte order") {
    for (const bool big_endian : {false, true}) {
      Bytes data = voxels<std::uint8_t>(false);
      for (const float end : {-1.0f, 3.0f, 0.0f, 5.0f, 10.0f, 7.0f})
        big_endian ? test::put_big(data, end) : test::put(data, end);
      const qnv::VolumeSource source = field("byte", data);
      CHECK(source.layout.origin == glm::dvec3(-1, 0, 10));
      CHECK(source.layout.axes[0] == glm::vec3(2, 0, 0));
      CHECK(source.layout.axes[1] == glm::vec3(0, 5, 0));
      CHECK(source.layout.axes[2] == glm::vec3(0, 0, -3));
    }
  }
  SECTION("rectilinear ones with their first and last coordinates") {
    std::string header = kAvs + "float\n\f\f";
    header.replace(header.find("uniform"), 7, "rectilinear");
    Bytes data = voxels<float>(false);
    for (const float c : {0.0f, 1.0f, 8.0f, 2.0f, 3.0f, 4.0f, 6.0f}) test::put(data, c);
    const qnv::VolumeSource source = opened(folder.write("a.fld", header + string_of(data)));
    CHECK(source.layout.origin == glm::dvec3(0, 2, 4));
    CHECK(source.layout.axes[0] == glm::vec3(4, 0, 0));
    CHECK(source.layout.axes[2] == glm::vec3(0, 0, 2));
  }
  SECTION("with the extent in the header") {
    const qnv::VolumeSource source = opened(folder.write(
        "a.fld", kAvs + "byte\nmin_ext=0 0 0\nmax_ext=1 2 3\n\f\f" + string_of(voxels<std::uint8_t>(false))));
    CHECK(source.layout.axes[0] == glm::vec3(0.5f, 0, 0));
    CHECK(source.layout.axes[2] == glm::vec3(0, 0, 3));
  }
  SECTION("with several components, of which the first counts") {
    std::string header = kAvs + "byte\n\f\f";
    header.replace(header.find("veclen=1"), 8, "veclen=3");
    std::string data;
    for (const int value : kValues) data += std::string{static_cast<char>(value), 'x', 'y'};
    check_values(opened(folder.write("a.fld", header + data)));
  }
  SECTION("with the voxels in another file") {
    folder.write("data.bin", "skipped" + string_of(voxels<std::int16_t>(true)));
    check_values(opened(folder.write("a.fld", kAvs + "xdr_short\nvariable 1 file=data.bin filetype=binary skip=7\n")));
    CHECK(problem_of(folder.write("a.fld", kAvs + "byte\nvariable 1 file=data.bin filetype=ascii\n")).find("ascii") !=
          std::string::npos);
  }
  SECTION("not of types that are not there") {
    CHECK(problem_of(folder.write("a.fld", kAvs + "bits\n\f\f")).find("bits") != std::string::npos);
    CHECK(problem_of(folder.write("a.fld", kAvs + "byte\n")).find("form feed") != std::string::npos);
    CHECK(problem_of(folder.write("a.fld", kAvs + "byte\n\f\fabc")).find("need") != std::string::npos);
  }
}
