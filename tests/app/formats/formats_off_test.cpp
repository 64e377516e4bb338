#include "app/formats/content_types.h"

#include "tests/app/formats_helpers.h"

namespace gs::app::off_test {

using namespace gs::test;
using gs::vrml::Color;

constexpr const char* kOffSquare =
    "OFF # a comment\n4 2 0\n\n0 0 0\n1 0 0\n# between\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3 # behind\n";

TEST_CASE("OFF: reads points and faces with any line ends") {
  for (const char* text : {kOffSquare, "OFF 4 2 0 0 0 0 1 0 0 1 1 0 0 1 0 3 0 1 2\n3 0 2 3"}) {
    const Imported result = imported("OFF", bytes_of(text));
    CHECK(result.messages().empty());
    CHECK(result.points() == std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
    CHECK(result.corners() == std::vector<std::int32_t>{0, 1, 2, -1, 0, 2, 3, -1});
    CHECK(result.scene->get<bool>(result.only("IndexedFaceSet"), "convex"));
  }
}

TEST_CASE("OFF: reads polygons and face colours, and skips invalid faces") {
  const Imported result = imported(
      "OFF", bytes_of("OFF\n4 4 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3  255 0 51\n3 0 1 2  0.5 0.25 1.0 1.0\n"
                      "2 0 1\n3 0 1 3\n"));
  CHECK(result.corners() == std::vector<std::int32_t>{0, 1, 2, 3, -1, 0, 1, 2, -1, 0, 1, 3, -1});
  const auto faces = result.only("IndexedFaceSet");
  CHECK_FALSE(result.scene->get<bool>(faces, "convex"));
  CHECK_FALSE(result.scene->get<bool>(faces, "colorPerVertex"));
  const auto& colors = result.scene->get<gs::vrml::MFColor>(result.only("Color"), "color");
  REQUIRE(colors.size() == 3);
  CHECK(colors[0] == Color{1, 0, 0.2f});
  CHECK(colors[1] == Color{0.5f, 0.25f, 1});
  CHECK(colors[2] == Color{0.8f, 0.8f, 0.8f});
  CHECK(result.messages().find("1 faces of fewer than three corners are left out") != std::string::npos);
}

TEST_CASE("OFF: reads normals and colours of corners") {
  const Imported result = imported("OFF", bytes_of("CNOFF\n3 1 0\n0 0 0 0 0 1 255 0 0 255\n1 0 0 0 0 1 0 255 0 255\n"
                                                   "0 1 0 0 0 1 0 0 255 255\n3 0 1 2\n"));
  CHECK(result.messages().empty());
  const auto& colors = result.scene->get<gs::vrml::MFColor>(result.only("Color"), "color");
  REQUIRE(colors.size() == 3);
  CHECK(colors[1] == Color{0, 1, 0});
  CHECK(result.scene->get<gs::vrml::MFVec3f>(result.only("Normal"), "vector").size() == 3);
  CHECK(result.scene->get<bool>(result.only("IndexedFaceSet"), "colorPerVertex"));
}

TEST_CASE("OFF: reports errors, and shows the rest") {
  const std::string whole = kOffSquare;
  const Imported cut = imported("OFF", bytes_of(whole.substr(0, whole.find("3 0 2 3") + 4)));
  CHECK(cut.corners() == std::vector<std::int32_t>{0, 1, 2, -1});
  CHECK(cut.messages().find("expected a face (2 of 2)") != std::string::npos);
  for (const char* bad : {"4OFF\n1 1 0\n", "nOFF 5\n", "OFF BINARY\n\x01\x02", "OFF\nmany 1 1\n", "OFF\n-1 0 0\n",
                          "OFF\n1e30 1 1\n", "OFFICE\n", "OFF\n2000000000 2000000000 0\n0 0 0\n"}) {
    INFO(bad);
    CHECK_FALSE(imported("OFF", bytes_of(bad)).messages().empty());
  }
  // A missing corner.
  CHECK_FALSE(imported("OFF", bytes_of("OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 9\n3 0 1 2\n")).messages().empty());
  for (std::size_t length = 0; length < whole.size(); ++length)
    (void)imported("OFF", bytes_of(whole.substr(0, length)));
}

TEST_CASE("detects OFF by its first word") {
  CHECK(content_type_of("x", bytes_of(kOffSquare)).name == "OFF");
  CHECK(content_type_of("x", bytes_of("COFF\n1 1 1\n")).name == "OFF");
  CHECK(content_type_of("x", bytes_of("OFFICE")).name == "VRML97");
}

}  // namespace gs::app::off_test
