
#include "tests/app/formats_helpers.h"

#include <map>

namespace {

using namespace gs::test;
using gs::app::ReadFile;
using gs::vrml::Color;
using gs::vrml::MFInt32;
using gs::vrml::SFNode;

Imported obj(std::string_view text, const ReadFile& read_file = {}) {
  return imported({"OBJ", read_file}, bytes_of(text));
}

ReadFile files(std::map<std::string, std::string> contents) {
  return [contents](const std::string& name) -> gs::app::BytesResult {
    const auto found = contents.find(name);
    if (found == contents.end()) return "there is no " + name;
    return gs::app::shared_bytes(bytes_of(found->second));
  };
}

constexpr const char* kObjSquare =
    "# a square\n"
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
    "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
    "vn 0 0 1\n"
    "f 1/1/1 2/2/1 3/3/1\n"
    "f -4/-4/-1 -2/-2/-1 \\\n  -1/-1/-1  # the other half\n";

TEST_CASE("reads faces with texture coordinates and normals") {
  const Imported result = obj(kObjSquare);
  CHECK(result.messages().empty());
  CHECK(result.points() == std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
  const std::vector<std::int32_t> corners = {0, 1, 2, -1, 0, 2, 3, -1};
  CHECK(result.corners() == corners);
  const auto faces = result.only("IndexedFaceSet");
  CHECK(result.values<MFInt32>(faces, "texCoordIndex") == corners);
  CHECK(result.values<MFInt32>(faces, "normalIndex") == std::vector<std::int32_t>{0, 0, 0, -1, 0, 0, 0, -1});
  CHECK(result.values<gs::vrml::MFVec2f>(result.only("TextureCoordinate"), "point")[2] == glm::vec2(1, 1));
  CHECK(result.scene->get<bool>(faces, "convex"));
  CHECK(gs::vrml::tessellate(*result.scene, faces).indices.size() == 6);
}

TEST_CASE("reads all forms of corners, each into its own Shape") {
  const Imported result =
      obj("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\n"
          "f 1 2 3 4\nf 1//1 2//1 3//1\nf 1/1 2/1 3/1\n");
  CHECK(result.messages().empty());
  const auto faces = result.all("IndexedFaceSet");
  REQUIRE(faces.size() == 3);
  CHECK(result.values<MFInt32>(faces[0], "coordIndex") == std::vector<std::int32_t>{0, 1, 2, 3, -1});
  CHECK_FALSE(result.scene->get<bool>(faces[0], "convex"));
  CHECK_FALSE(result.scene->get<SFNode>(faces[0], "normal"));
  CHECK(result.scene->get<SFNode>(faces[1], "normal"));
  CHECK_FALSE(result.scene->get<SFNode>(faces[1], "texCoord"));
  CHECK(result.scene->get<SFNode>(faces[2], "texCoord"));
}

TEST_CASE("makes Shapes with their own points of groups and materials") {
  const Imported result = obj(
      "mtllib lib/a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 5 5 5\nv 6 5 5\nv 6 6 5\n"
      "o left part\nusemtl red\nf 1 2 3\no right\nusemtl glass\nf 4 5 6\no left part\nusemtl red\nf 3 2 1\n",
      files(
          {{"lib/a.mtl",
            "# materials\nnewmtl red\nKd 1 0 0\nKs 0.5 0.5 0.5\nNs 64\nillum 2\nmap_Kd -s 2 2 2 -clamp on my wood.png\n"
            "newmtl glass\nKd 0.1 0.2 0.3\nKe 0 0 1\nd 0.25\nillum 1\nKs 1 1 1\nnewmtl red\nKd 0 1 0\n"}}));
  CHECK(result.messages().empty());
  const auto shapes = result.all("Shape");
  REQUIRE(shapes.size() == 2);
  CHECK(result.scene->node(shapes[0]).name == "left_part");
  CHECK(result.scene->node(shapes[1]).name == "right");
  const auto faces = result.all("IndexedFaceSet");
  CHECK(result.values<MFInt32>(faces[0], "coordIndex") == std::vector<std::int32_t>{0, 1, 2, -1, 2, 1, 0, -1});
  CHECK(result.values<MFInt32>(faces[1], "coordIndex") == std::vector<std::int32_t>{0, 1, 2, -1});
  const auto second = result.scene->get<SFNode>(faces[1], "coord");
  CHECK(result.values<gs::vrml::MFVec3f>(second, "point") == std::vector<glm::vec3>{{5, 5, 5}, {6, 5, 5}, {6, 6, 5}});
  const auto materials = result.all("Material");
  REQUIRE(materials.size() == 2);
  CHECK(result.scene->get<Color>(materials[0], "diffuseColor") == Color{1, 0, 0});
  CHECK(result.scene->get<Color>(materials[0], "specularColor") == Color{0.5f, 0.5f, 0.5f});
  CHECK(result.scene->get<float>(materials[0], "shininess") == 0.5f);
  CHECK(result.scene->get<float>(materials[1], "transparency") == 0.75f);
  CHECK(result.scene->get<Color>(materials[1], "emissiveColor") == Color{0, 0, 1});
  CHECK(result.scene->get<Color>(materials[1], "specularColor") == Color{0, 0, 0});
  CHECK(result.scene->get<gs::vrml::MFString>(result.only("ImageTexture"), "url")[0] == "lib/my wood.png");
}

TEST_CASE("reports material libraries that cannot be read") {
  const char* text = "mtllib a b.mtl\nmtllib c.mtl\nmtllib a b.mtl\nusemtl x\nv 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n";
  const Imported silent = obj(text);
  CHECK(silent.diagnostics.errors() + silent.diagnostics.warnings() == 0);
  CHECK(silent.messages().find("test:1:1: note: material library a b.mtl is not read\n") == 0);
  const Imported missing = obj(text, files({{"c.mtl", "newmtl y\nKd broken\n"}}));
  CHECK(missing.messages() ==
        "test:1:1: warning: material library a b.mtl cannot be read: there is no a b.mtl\ntest: warning: material "
        "library c.mtl, line 2: broken Kd; it is skipped\ntest: warning: material x is in no library; the default "
        "material is used\n");
  CHECK(missing.corners().size() == 4);
}

TEST_CASE("reads colours after the coordinates") {
  const Imported result = obj("v 0 0 0 1 0 0\nv 1 0 0\nv 1 1 0 1 0 0 1\nv 2 2 2 0.5\nf 1 2 3\n");
  CHECK(result.colors() == std::vector<Color>{{1, 0, 0}, {1, 1, 1}, {0, 0, 1}, {1, 1, 1}});
  CHECK(result.scene->get<bool>(result.only("IndexedFaceSet"), "colorPerVertex"));
}

TEST_CASE("reads lines, points and bare vertices") {
  const Imported result = obj("v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nl 1/1 2/1 3/1\np 3 1\n");
  CHECK(result.messages().empty());
  CHECK(result.values<MFInt32>(result.only("IndexedLineSet"), "coordIndex") == std::vector<std::int32_t>{0, 1, 2, -1});
  const auto points = result.scene->get<SFNode>(result.only("PointSet"), "coord");
  CHECK(result.values<gs::vrml::MFVec3f>(points, "point") == std::vector<glm::vec3>{{1, 1, 0}, {0, 0, 0}});
  const Imported geometry = obj("v 0 0 0\nv 1 0 0\n");
  CHECK(geometry.only("PointSet"));
  CHECK(geometry.scene->get<Color>(geometry.only("Material"), "emissiveColor") == Color{0.8f, 0.8f, 0.8f});
  CHECK(obj("# nothing\n").messages() == "test: warning: no vertices in the file\n");
}

TEST_CASE("converts smoothing to a crease angle") {
  const std::string triangle = "v 0 0 0\nv 1 0 0\nv 1 1 0\n";
  const auto crease = [](const Imported& result) {
    return result.scene->get<float>(result.only("IndexedFaceSet"), "creaseAngle");
  };
  CHECK(crease(obj(triangle + "s off\nf 1 2 3\n")) == 0);
  CHECK(crease(obj(triangle + "s 1\nf 1 2 3\n")) == Approx(3.14159265));
  CHECK(crease(obj(triangle + "f 1 2 3\n")) == Approx(3.14159265 / 3));
}

TEST_CASE("drops only the face of a broken line, and reports its position") {
  const Imported result =
      obj("v 0 0 0\nv 1 x 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\n  f 1 2\nf 1 2 b\nf 0 1 2\nf 1 2 9\nf 1/2/3/4 2 3\nblah 1 2\n"
          "blah\nf 1 3 4 # end\n");
  CHECK(result.corners() == std::vector<std::int32_t>{0, 1, 2, -1, 0, 2, 3, -1});
  CHECK(result.messages() ==
        "test:2:1: error: broken vertex; expected: v X Y Z\ntest:6:3: error: broken element; expected at least 3 of V, "
        "V/T, V//N or V/T/N\ntest:7:1: error: broken element; expected at least 3 of V, V/T, V//N or V/T/N\ntest:10:1: "
        "error: broken element; expected at least 3 of V, V/T, V//N or V/T/N\ntest:11:1: warning: unknown statement "
        "'blah' is skipped; reported once\ntest: error: 2 faces left out, because they use missing vertices; expected "
        "indices below 4\n");
}

TEST_CASE("survives numbers that cannot be indices") {
  const Imported result =
      obj("v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 99999999999999999999999\nf -9999999999999999999 1 2\nf 2147483647 "
          "2147483648 1\n"
          "f 1/2147483647 2/1 3/1\np 77\nl 1 77\n");
  check_sound(result);
  CHECK(result.diagnostics.errors() > 0);
}

TEST_CASE("joins very many groups into fewer Shapes", "[optimised]") {
  std::string text = "v 0 0 0\nv 1 0 0\nv 1 1 0\n";
  for (int i = 0; i < 100'010; ++i) text += "g g" + std::to_string(i) + "\nf 1 2 3\n";
  const Imported result = obj(text);
  CHECK(result.all("Shape").size() == 100'001);
  CHECK(result.diagnostics.warnings() == 1);
}

TEST_CASE("survives every truncation and every changed byte of an OBJ") {
  const ReadFile library = files({{"a.mtl", "newmtl m\nKd 1 0 0\nmap_Kd -o 1 2 x.png\nTr 0.5\nNs 10\n"}});
  const Import import("OBJ", library);
  check_prefixes_and_flips(import, bytes_of(kObjSquare));
  check_prefixes_and_flips(import, bytes_of("mtllib a.mtl\nv 1 2 3 1 0 0\nv 1e3 .5 -1\nv 0 0 1\no x\nusemtl m\ns 1\n"
                                            "f 1 2 3\nl 1 2\np -1\ng y\nf 3//  2 1 \\\n"));
  // The library is as hostile as the file.
  const std::string materials = "newmtl m\nKd 1 0 0\nKs .5\nmap_Kd -o 1 2 x.png\nTr 0.5\nd -halo .2\nNs 10\nillum 1\n";
  for (std::size_t n = 0; n <= materials.size(); ++n)
    check_sound(obj("mtllib a.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n",
                    files({{"a.mtl", materials.substr(0, n)}})));
}

}  // namespace
