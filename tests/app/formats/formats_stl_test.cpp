
#include "tests/app/formats_helpers.h"

#include <limits>

namespace {

using namespace gs::test;
using gs::vrml::Color;

constexpr const char* kText =
    "solid my part\n"
    "  facet normal 0 0 1\n    outer loop\n      vertex 0 0 0\n      vertex 1 0 0\n      vertex 1 1e0 0\n"
    "    endloop\n  endfacet\n"
    "  FACET NORMAL 0 0 1\n    OUTER LOOP\n      VERTEX 0 0 0\n      VERTEX 1.0 1.0 -0\n      VERTEX 0 1 0\n"
    "    ENDLOOP\n  ENDFACET\n"
    "endsolid my part\n";

Bytes stl_binary(std::string_view header, std::uint16_t attribute = 0) {
  Bytes bytes = bytes_of(header);
  bytes.resize(80);
  put(bytes, std::uint32_t{2});
  const float corners[2][9] = {{0, 0, 0, 1, 0, 0, 1, 1, 0}, {0, 0, 0, 1, 1, -0.0f, 0, 1, 0}};
  for (const auto& facet : corners) {
    for (int i = 0; i < 3; ++i) put(bytes, 0.0f);
    for (const float f : facet) put(bytes, f);
    put(bytes, attribute);
  }
  return bytes;
}

void check_square(const Imported& result) {
  CHECK(result.messages().empty());
  CHECK(result.points() == std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
  CHECK(result.corners() == std::vector<std::int32_t>{0, 1, 2, -1, 0, 2, 3, -1});
  const auto faces = result.only("IndexedFaceSet");
  CHECK(result.scene->get<float>(faces, "creaseAngle") == 0);
  CHECK(result.scene->get<bool>(faces, "convex"));
  CHECK(result.all("Normal").empty());
}

TEST_CASE("reads text and binary STL as the same mesh, with equal corners welded") {
  const Imported text = imported("STL", bytes_of(kText));
  check_square(text);
  CHECK(text.scene->node(text.only("Shape")).name == "my_part");
  check_square(imported("STL", stl_binary("made by hand")));
}

TEST_CASE("accepts a binary STL that begins with solid") {
  check_square(imported("STL", stl_binary("solid something")));
  Bytes longer = stl_binary("solid something");
  longer.resize(longer.size() + 7);
  check_square(imported("STL", longer));
}

TEST_CASE("keeps the facets of a truncated STL") {
  Bytes bytes = stl_binary("solid x");
  bytes.resize(bytes.size() - 20);
  const Imported part = imported("STL", bytes);
  CHECK(part.corners() == std::vector<std::int32_t>{0, 1, 2, -1});
  CHECK(part.messages() == "test: error: the file ends too early: expected 2 facets, found 1\n");

  const Imported text =
      imported("STL", bytes_of(std::string_view(kText).substr(0, std::string_view(kText).find("VERTEX 0 1"))));
  CHECK(text.corners() == std::vector<std::int32_t>{0, 1, 2, -1});
  CHECK(text.diagnostics.errors() == 1);
  CHECK(imported("STL", bytes_of("abc")).diagnostics.errors() == 1);
}

TEST_CASE("allocates nothing for a count that the file cannot hold") {
  Bytes bytes = stl_binary("x");
  for (std::size_t i = 80; i < 84; ++i) bytes[i] = std::byte{0xff};
  CHECK(imported("STL", bytes).corners().size() == 8);
}

TEST_CASE("reads colours of facets") {
  // Bit 15, red 31, green 0, blue 31.
  const Imported visual = imported("STL", stl_binary("x", 0x8000 | 31 << 10 | 31));
  CHECK(visual.colors() == std::vector<Color>(2, Color{1, 0, 1}));
  CHECK_FALSE(visual.scene->get<bool>(visual.only("IndexedFaceSet"), "colorPerVertex"));
  CHECK(imported("STL", stl_binary("x", 0x001f)).all("Color").empty());
  // Magics: the header has the object's colour. Bit 15 of a facet selects that colour. Red has the low bits.
  const std::string header("COLOR=\xff\x00\x00\xff", 10);
  const Imported magics = imported("STL", stl_binary(header, 31));
  CHECK(magics.colors() == std::vector<Color>(2, Color{1, 0, 0}));
  CHECK(magics.scene->get<Color>(magics.only("Material"), "diffuseColor") == Color{1, 0, 0});
}

TEST_CASE("reports broken lines of a text STL with their position") {
  const Imported result =
      imported("STL", bytes_of("solid\nfacet normal 0 0 1\nouter loop\nvertex 1 x 3\nvertex 0 0 0\nvertex 1 0 0\n"
                               "vertex 0 1 0\nendloop\nendfacet\nfacet normal nan nan nan\nouter loop\nvertex 0 0 0\n"
                               "vertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n"));
  CHECK(result.corners() == std::vector<std::int32_t>{0, 1, 2, -1});
  CHECK(result.messages() == "test:4:1: error: broken vertex; expected three numbers\n");
  CHECK(imported("STL", bytes_of("solid\nfacet\nouter loop\nendloop\nendfacet\nendsolid\n")).messages() ==
        "test:4:1: error: a facet of 0 corners; expected three\ntest: warning: no facets in the file\n");
}

TEST_CASE("leaves out corners that are not finite") {
  Bytes bytes = stl_binary("x");
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::memcpy(bytes.data() + 84 + 12, &nan, 4);
  const Imported result = imported("STL", bytes);
  CHECK(result.corners().size() == 4);
  CHECK(result.diagnostics.warnings() == 1);
  check_sound(result);
}

TEST_CASE("welds many corners by their bits") {
  Bytes bytes(80);
  constexpr std::uint32_t kCount = 3000;
  put(bytes, kCount);
  for (std::uint32_t i = 0; i < kCount; ++i) {
    for (int k = 0; k < 3; ++k) put(bytes, 0.0f);
    for (const std::uint32_t x : {i, i + 1, i + 2})
      for (const float f : {static_cast<float>(x), static_cast<float>(x % 7), 1.0f}) put(bytes, f);
    put(bytes, std::uint16_t{0});
  }
  const Imported result = imported("STL", bytes);
  CHECK(result.points().size() == kCount + 2);
  CHECK(result.corners()[4 * 2999] == 2999);
}

TEST_CASE("survives every truncation and every changed byte of an STL") {
  check_prefixes_and_flips("STL", bytes_of(kText));
  check_prefixes_and_flips("STL", stl_binary("solid", 0xffff));
}

}  // namespace
