
#include "app/formats/common/color_key.h"
#include "tests/app/formats_helpers.h"

namespace {

using namespace gs::test;
using gs::vrml::Color;
using gs::vrml::SFNode;

constexpr const char* kPlySquare =
    "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 4\nproperty float x\nproperty float y\n"
    "property float z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0\n1 0 0\n1 1 0.5\n0 1 0\n3 0 1 2\n4 0 1 2 3\n";

Imported ply(std::string_view text) { return imported("PLY", bytes_of(text)); }

TEST_CASE("reads an ASCII PLY as IndexedFaceSet") {
  const Imported result = ply(kPlySquare);
  CHECK(result.messages().empty());
  CHECK(result.points() == std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0.5f}, {0, 1, 0}});
  CHECK(result.corners() == std::vector<std::int32_t>{0, 1, 2, -1, 0, 1, 2, 3, -1});
  const auto faces = result.only("IndexedFaceSet");
  CHECK_FALSE(result.scene->get<bool>(faces, "solid"));
  CHECK_FALSE(result.scene->get<bool>(faces, "convex"));
  REQUIRE(result.scene->roots().size() == 1);
  CHECK(result.scene->get<SFNode>(result.scene->roots()[0], "geometry") == faces);
  CHECK(result.all("Material").size() == 1);
  CHECK(gs::vrml::tessellate(*result.scene, faces).indices.size() == 9);
}

TEST_CASE("converts vertex values of a PLY to colours, and stores their meaning") {
  const auto square = [](const std::string& properties, const std::string& rows, const std::string& before = "") {
    return ply("ply\nformat ascii 1.0\n" + before + "element vertex 3\nproperty float x\nproperty float y\n" +
               "property float z\n" + properties +
               "element face 1\nproperty list uchar int vertex_indices\nend_header\n" + rows + "3 0 1 2\n");
  };
  const auto viridis = gs::app::viridis_colors();
  const Imported result = square("property double scalar_Signed_distance\n", "0 0 0 -4\n1 0 0 4\n1 1 0 nan\n");
  CHECK(result.colors() == std::vector<Color>{viridis.front(), viridis.back(), {0.5f, 0.5f, 0.5f}});
  const auto key = gs::app::color_key_of(*result.scene);
  REQUIRE(key);
  CHECK(key->title == "Signed distance");
  CHECK(key->low == -4);
  CHECK(key->high == 4);
  for (const char* const name : {"quality", "value", "scalar"}) {
    const Imported one = square("property float " + std::string(name) + "\n", "0 0 0 1\n1 0 0 2\n1 1 0 3\n");
    REQUIRE(gs::app::color_key_of(*one.scene));
    CHECK(gs::app::color_key_of(*one.scene)->title == name);
    CHECK(one.colors()[1] == viridis[2]);
  }
  // Colours and textures of the file take precedence. Other scanner values do not become colours.
  const std::string colors = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  const Imported own =
      square("property float quality\n" + colors, "0 0 0 1 255 0 0\n1 0 0 2 255 0 0\n1 1 0 3 255 0 0\n");
  CHECK(own.colors()[0] == Color{1, 0, 0});
  CHECK_FALSE(gs::app::color_key_of(*own.scene));
  const Imported textured =
      square("property float quality\n", "0 0 0 1\n1 0 0 2\n1 1 0 3\n", "comment TextureFile a.png\n");
  CHECK(textured.all("Color").empty());
  const Imported scan =
      square("property float confidence\nproperty float intensity\n", "0 0 0 1 1\n1 0 0 2 1\n1 1 0 3 1\n");
  CHECK(scan.all("Color").empty());
  CHECK_FALSE(gs::app::color_key_of(*scan.scene));
}

TEST_CASE("accepts all kinds of line ends") {
  for (const std::string end : {"\r\n", "\r"}) {
    std::string text;
    for (const char c : std::string(kPlySquare)) text += c == '\n' ? end : std::string(1, c);
    const Imported result = ply(text);
    CHECK(result.messages().empty());
    CHECK(result.corners().size() == 9);
  }
}

template <bool big>
Bytes binary_square() {
  Bytes bytes = bytes_of(std::string("ply\nformat ") + (big ? "binary_big_endian" : "binary_little_endian") +
                         " 1.0\nelement vertex 3\nproperty double z\nproperty uchar red\nproperty uchar green\n"
                         "property uchar blue\nproperty short x\nproperty float y\nproperty list uchar ushort extra\n"
                         "element strange 2\nproperty list uint double values\nproperty char c\n"
                         "element face 1\nproperty uchar flags\nproperty list ushort uint vertex_index\nend_header\n");
  const auto number = [&bytes](auto value) {
    if (big)
      put_big(bytes, value);
    else
      put(bytes, value);
  };
  for (int i = 0; i < 3; ++i) {
    number(double{i + 0.5});
    for (const int c : {255, 0, 51 * i}) number(static_cast<std::uint8_t>(c));
    number(static_cast<std::int16_t>(-i));
    number(float{10.0f * static_cast<float>(i)});
    number(static_cast<std::uint8_t>(i));
    for (int k = 0; k < i; ++k) number(std::uint16_t{7});
  }
  for (int i = 0; i < 2; ++i) {
    number(std::uint32_t{1});
    number(double{3});
    number(std::int8_t{1});
  }
  number(std::uint8_t{10});
  number(std::uint16_t{3});
  for (const std::uint32_t i : {2u, 1u, 0u}) number(i);
  return bytes;
}

TEST_CASE("reads binary PLY of both byte orders and any property order, and skips unknown elements") {
  for (const Bytes& bytes : {binary_square<false>(), binary_square<true>()}) {
    const Imported result = imported("PLY", bytes);
    CHECK(result.messages().empty());
    CHECK(result.points() == std::vector<glm::vec3>{{0, 0, 0.5f}, {-1, 10, 1.5f}, {-2, 20, 2.5f}});
    CHECK(result.corners() == std::vector<std::int32_t>{2, 1, 0, -1});
    const auto colors = result.colors();
    REQUIRE(colors.size() == 3);
    CHECK(colors[0] == Color{1, 0, 0});
    CHECK(colors[2].b == Approx(0.4f));
    CHECK(result.scene->get<bool>(result.only("IndexedFaceSet"), "colorPerVertex"));
  }
}

TEST_CASE("reads rows of one size as a table") {
  Bytes bytes = bytes_of(
      "ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
      "property float nx\nproperty float ny\nproperty float nz\nproperty ushort red\nproperty ushort green\n"
      "property ushort blue\nend_header\n");
  for (int i = 0; i < 2; ++i) {
    for (const float f : {1.0f, 2.0f, 3.0f, 0.0f, 0.0f, 1.0f}) put(bytes, f);
    for (const int c : {65535, 0, 13107}) put(bytes, static_cast<std::uint16_t>(c));
  }
  const Imported result = imported("PLY", bytes);
  CHECK(result.messages().empty());
  CHECK(result.scene->get<gs::vrml::MFVec3f>(result.only("Coordinate"), "point")[1] == glm::vec3(1, 2, 3));
  CHECK(result.colors()[1].b == Approx(0.2f));
  CHECK(result.only("PointSet"));
  // A PointSet has no normals (VRML97 6.36), and shows its emission without colours.
  CHECK(result.all("Normal").empty());
}

TEST_CASE("makes points without colours emissive") {
  const Imported result =
      ply("ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
          "1 2 3\n4 5 6\n");
  CHECK(result.only("PointSet"));
  CHECK(result.scene->get<Color>(result.only("Material"), "emissiveColor") == Color{0.8f, 0.8f, 0.8f});
}

TEST_CASE("leaves out points that are not finite") {
  const Imported result =
      ply("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
          "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n"
          "1 2 3 255 0 0\nnan nan nan 0 255 0\n4 5 6 0 0 255\n");
  CHECK(result.points() == std::vector<glm::vec3>{{1, 2, 3}, {4, 5, 6}});
  CHECK(result.colors() == std::vector<Color>{{1, 0, 0}, {0, 0, 1}});
  CHECK(result.messages() == "test: warning: 1 points left out, because their coordinates are not finite\n");
}

TEST_CASE("reads normals, texture coordinates and the texture") {
  const Imported result = ply(
      "ply\nformat ascii 1.0\ncomment TextureFile my wood.png\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nproperty float nx\nproperty float ny\nproperty float nz\nproperty float s\nproperty float t\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0 0 0 1 0 0\n1 0 0 0 0 1 1 0\n0 1 0 0 0 1 0 1\n3 0 1 2\n");
  CHECK(result.values<gs::vrml::MFVec3f>(result.only("Normal"), "vector") == std::vector<glm::vec3>(3, {0, 0, 1}));
  CHECK(result.values<gs::vrml::MFVec2f>(result.only("TextureCoordinate"), "point") ==
        std::vector<glm::vec2>{{0, 0}, {1, 0}, {0, 1}});
  CHECK(result.scene->get<gs::vrml::MFString>(result.only("ImageTexture"), "url")[0] == "my wood.png");
}

TEST_CASE("reads colours and texture coordinates of faces") {
  const Imported result =
      ply("ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
          "element face 3\nproperty list uchar float texcoord\nproperty list uchar int vertex_indices\n"
          "property float red\nproperty float green\nproperty float blue\nend_header\n"
          "0 0 0\n1 0 0\n1 1 0\n0 1 0\n"
          "6 0 0 1 0 1 1 3 0 1 2 1 0 0\n6 0 0 1 0 1 1 3 0 1 9 0 1 0\n6 0 0 1 1 0 1 3 0 2 3 0 0 1\n");
  // The second face has an invalid vertex, so it is dropped with its colour.
  CHECK(result.corners() == std::vector<std::int32_t>{0, 1, 2, -1, 0, 2, 3, -1});
  CHECK(result.colors() == std::vector<Color>{{1, 0, 0}, {0, 0, 1}});
  const auto faces = result.only("IndexedFaceSet");
  CHECK_FALSE(result.scene->get<bool>(faces, "colorPerVertex"));
  CHECK(result.values<gs::vrml::MFInt32>(faces, "texCoordIndex") ==
        std::vector<std::int32_t>{0, 1, 2, -1, 6, 7, 8, -1});
  CHECK(result.messages() ==
        "test: error: 1 faces left out, because they use missing vertices; expected indices below 4\n");
}

TEST_CASE("converts strips to triangles, and edges to lines") {
  const std::string vertices = "property float x\nproperty float y\nproperty float z\n";
  const Imported strips = ply("ply\nformat ascii 1.0\nelement vertex 5\n" + vertices +
                              "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
                              "0 0 0\n1 0 0\n0 1 0\n1 1 0\n2 2 0\n8 0 1 2 3 -1 2 3 4\n");
  CHECK(strips.corners() == std::vector<std::int32_t>{0, 1, 2, -1, 2, 1, 3, -1, 2, 3, 4, -1});
  const Imported edges =
      ply("ply\nformat ascii 1.0\nelement vertex 2\n" + vertices +
          "element edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n0 0 0\n1 0 0\n0 1\n");
  CHECK(edges.values<gs::vrml::MFInt32>(edges.only("IndexedLineSet"), "coordIndex") ==
        std::vector<std::int32_t>{0, 1, -1});
}

TEST_CASE("reads 3D Gaussian splats as points of their base colour") {
  const Imported result =
      ply("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
          "property float f_dc_0\nproperty float f_dc_1\nproperty float f_dc_2\nproperty float opacity\nend_header\n"
          "1 2 3 0 1 -9 0.5\n");
  const auto colors = result.colors();
  REQUIRE(colors.size() == 1);
  CHECK(colors[0].r == Approx(0.5f));
  CHECK(colors[0].g == Approx(0.5f + 0.28209479f));
  CHECK(colors[0].b == 0);
  CHECK(result.diagnostics.errors() == 0);
}

TEST_CASE("reports broken headers with their position and the expected text") {
  CHECK(ply("").messages() == "test:1:1: error: not a PLY file: expected 'ply' as the first line\n");
  CHECK(ply("ply\n" + std::string(65536, '\0')).messages() ==
        "test:2:1: error: a header line of more than 64 KiB; expected end_header\n");
  CHECK(ply(std::string(65536, '\0')).messages() ==
        "test:1:1: error: not a PLY file: expected 'ply' as the first line\n");
  CHECK(ply("ply\nformat binary 1.0\n").messages() ==
        "test:2:1: error: unknown format 'binary'; expected ascii, binary_little_endian or binary_big_endian\n");
  CHECK(ply("ply\nformat ascii 1.0\nelement vertex -3\n").messages() ==
        "test:3:1: error: expected: element NAME COUNT\n");
  CHECK(ply("ply\nproperty float x\n").messages() == "test:2:1: error: property precedes the first element\n");
  CHECK(ply("ply\nformat ascii 1.0\nelement v 1\nproperty list float int x\n").diagnostics.errors() == 1);
  CHECK(ply("ply\nend_header\n").diagnostics.errors() == 1);
  CHECK(ply("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n").messages() ==
        "test: error: element vertex has no coordinates; expected the properties x, y and z\n"
        "test: warning: no vertices in the file\n");
}

TEST_CASE("allocates nothing for counts that the file cannot hold") {
  const std::string header =
      "element vertex 4000000000000\nproperty float x\nproperty float y\nproperty float z\nelement face 99999999999\n"
      "property list uint int vertex_indices\nend_header\n";
  CHECK(ply("ply\nformat ascii 1.0\n" + header + "1 2 3\n4 5").points().size() == 1);
  const Imported binary = ply("ply\nformat binary_little_endian 1.0\n" + header + std::string(24, '\0'));
  CHECK(binary.points().size() == 2);
  CHECK(binary.messages().find("element vertex: row 3 of 4000000000000 is missing or broken") != std::string::npos);
  const std::string list =
      "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 2\nproperty list uint int vertex_indices\nend_header\n" +
      std::string(12, '\0') + "\xff\xff\xff\xff";
  CHECK(ply(list).diagnostics.errors() == 1);
}

TEST_CASE("ends an ASCII PLY at a broken row, and reports its position") {
  const Imported result =
      ply("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
          "0 0 0\n1 abc 0\n0 1 0\n");
  CHECK(result.points().size() == 1);
  CHECK(result.messages() ==
        "test:9:3: error: element vertex: row 2 of 3 is missing or broken; the rest of the file is skipped\n");
}

TEST_CASE("survives every truncation and every changed byte of a PLY") {
  check_prefixes_and_flips("PLY", bytes_of(kPlySquare));
  check_prefixes_and_flips("PLY", binary_square<false>());
  check_prefixes_and_flips("PLY", binary_square<true>());
}

}  // namespace
