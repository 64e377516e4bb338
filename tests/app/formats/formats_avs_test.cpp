#include "app/formats/common/color_key.h"

#include "tests/app/formats_helpers.h"

#include <algorithm>
#include <cstring>

namespace {

using namespace gs::test;
using gs::vrml::Color;

// Colours of the minimum, middle and maximum: viridis (matplotlib).
const Color kLow = gs::app::viridis_colors().front(), kMiddle = gs::app::viridis_colors()[2],
            kHigh = gs::app::viridis_colors().back();

Imported ucd(std::string_view text) { return imported("AVS UCD", bytes_of(text)); }
Imported avs(std::string_view text) { return imported("AVS geometry", bytes_of(text)); }

constexpr const char* kCube = "1 0 0 1\n2 1 0 1\n3 1 1 1\n4 0 1 1\n5 0 0 0\n6 1 0 0\n7 1 1 0\n8 0 1 0\n";

/// Returns the enclosed volume, positive if the faces look outwards.
double signed_volume(const Imported& result) {
  const auto points = result.points();
  std::vector<std::int32_t> face;
  double total = 0;
  for (const std::int32_t i : result.corners()) {
    if (i >= 0) {
      face.push_back(i);
      continue;
    }
    for (std::size_t k = 2; k < face.size(); ++k) {
      const glm::dvec3 a = points[static_cast<std::size_t>(face[0])], b = points[static_cast<std::size_t>(face[k - 1])],
                       c = points[static_cast<std::size_t>(face[k])];
      total += (a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x)) / 6;
    }
    face.clear();
  }
  return total;
}

TEST_CASE("shows the outer faces of UCD cells, facing outwards") {
  const std::string nodes = kCube;
  const Imported hexahedron = ucd("# comment\n8 1 0 0 0\n" + nodes + "1 1 hex 1 2 3 4 5 6 7 8\n");
  CHECK(hexahedron.messages().empty());
  CHECK(hexahedron.corners().size() == 6 * 5);
  CHECK(signed_volume(hexahedron) == Approx(1));
  // Two prisms make the cube; the common face is dropped.
  const Imported prisms = ucd("8 2 0 0 0\n" + nodes + "1 1 prism 1 2 3 5 6 7\n2 1 prism 1 3 4 5 7 8\n");
  CHECK(prisms.corners().size() == 4 * 4 + 4 * 5);
  CHECK(signed_volume(prisms) == Approx(1));
  // Three pyramids with a common apex.
  const Imported pyramid = ucd("8 1 0 0 0\n" + nodes + "1 1 pyr 4 5 6 7 8\n");
  CHECK(pyramid.corners().size() == 4 * 4 + 5);
  CHECK(signed_volume(pyramid) == Approx(1.0 / 3));
  const Imported tetrahedra = ucd("8 2 0 0 0\n" + nodes + "1 1 tet 4 5 6 8\n2 1 tet 7 6 8 4\n");
  CHECK(tetrahedra.corners().size() == 6 * 4);
  CHECK(ucd("8 1 0 0 0\n" + nodes + "1 1 tet 4 5 6 8\n").corners().size() == 16);
  CHECK(signed_volume(ucd("8 1 0 0 0\n" + nodes + "1 1 tet 4 5 6 8\n")) == Approx(1.0 / 6));
  // A shell keeps both sides.
  CHECK(ucd("8 2 0 0 0\n" + nodes + "1 1 tri 1 2 3\n2 1 tri 3 2 1\n").corners().size() == 8);
}

TEST_CASE("maps UCD data to colours from blue to red") {
  const std::string nodes = "10 0 0 0\n7 1 0 0\n-3 1 1 0\n";
  // The file has a vector, then scalars. The first scalar is shown. Rows begin with the number of their node.
  const Imported result = ucd("3 1 4 0 0\n" + nodes + "1 1 tri 10 7 -3\n2 3 1\nflow, m/s\nheat, K\n" +
                              "-3 9 9 9 30\n10 9 9 9 10\n7 9 9 9 20\n");
  CHECK(result.messages().empty());
  CHECK(result.corners() == std::vector<std::int32_t>{0, 1, 2, -1});
  CHECK(result.colors() == std::vector<Color>{kLow, kMiddle, kHigh});
  CHECK(result.scene->get<bool>(result.only("IndexedFaceSet"), "colorPerVertex"));
  const Imported cells = ucd("4 2 0 1 0\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n1 1 tri 1 2 3\n2 1 tri 1 3 4\n" +
                             std::string("1 1\nstress, Pa\n2 5\n1 4\n"));
  CHECK(cells.messages().empty());
  CHECK(cells.colors() == std::vector<Color>{kLow, kHigh});
  CHECK_FALSE(cells.scene->get<bool>(cells.only("IndexedFaceSet"), "colorPerVertex"));
  // The scene describes the meaning of the colours.
  const auto key = gs::app::color_key_of(*result.scene), of_cells = gs::app::color_key_of(*cells.scene);
  REQUIRE(key);
  REQUIRE(of_cells);
  CHECK(key->title == "heat (K)");
  CHECK(key->low == 10);
  CHECK(key->high == 30);
  CHECK(of_cells->title == "stress (Pa)");
  CHECK_FALSE(gs::app::color_key_of(*ucd("3 1 0 0 0\n" + nodes + "1 1 tri 10 7 -3\n").scene));
  // Equal values at all nodes, then a missing value.
  CHECK(ucd("3 1 1 0 0\n" + nodes + "1 1 tri 10 7 -3\n1 1\nt, K\n10 5\n7 5\n-3 nan\n").colors() ==
        std::vector<Color>{kMiddle, kMiddle, {0.5f, 0.5f, 0.5f}});
}

TEST_CASE("reads UCD with steps and mid-edge nodes, and reports mistakes") {
  const std::string nodes = "1 0 0 0\n2 1 0 0\n3 1 1 0\n4 9 9 9\n5 9 9 9\n6 9 9 9\n";
  const Imported steps = ucd("2\ndata_geom\nstep1 first\n6 1\n" + nodes +
                             "1 1 tri2 1 2 3 4 5 6\n1 0\n1 1\nt, K\n1 0\n2 1\n3 2\n4 0\n5 0\n6 0\nstep2\n");
  CHECK(steps.messages().empty());
  CHECK(steps.corners() == std::vector<std::int32_t>{0, 1, 2, -1});
  CHECK(steps.colors()[2] == kHigh);
  CHECK(ucd("6 2 0 0 0\n" + nodes + "1 1 line 1 2\n2 1 tri 1 2 3\n")
            .messages()
            .find("1 cells that are points or lines") != std::string::npos);
  CHECK(ucd("6 1 0 0 0\n" + nodes + "1 1 tri 1 2 77\n").all("IndexedFaceSet").empty());
  CHECK(ucd("6 1 0 0 0\n" + nodes + "1 1 blob 1 2 3\n").messages().find(":8:1: error: unknown type of cell 'blob'") !=
        std::string::npos);
  CHECK(ucd("3 1 0 0 0\n1 0 0\n").messages().find("broken node") != std::string::npos);
  CHECK(ucd("").diagnostics.errors() == 1);
  CHECK(ucd("4000000000000 1 0 0 0\n1 0 0 0\n").messages().find("too early") != std::string::npos);
}

/// Returns two triangles and a pyramid, with the header in the byte order of `put_word`.
template <class Put>
Bytes avs_binary(Put&& put_word) {
  Bytes bytes{std::byte{7}};
  const auto words = [&](std::initializer_list<std::uint32_t> list) {
    for (const std::uint32_t word : list) put_word(bytes, word);
  };
  const auto floats = [&](std::initializer_list<float> list) {
    for (const float f : list) put_word(bytes, std::bit_cast<std::uint32_t>(f));
  };
  words({5, 3, 4, 0, 0, 11});
  words({1, 1, 3, 2, 2, 1, 3, 2, 3, 1, 5, 5});
  words({1, 2, 3, 1, 3, 4, 5, 1, 2, 3, 4});
  floats({0, 1, 1, 0, 0.5f});
  floats({0, 0, 1, 1, 0.5f});
  floats({0, 0, 0, 0, 1});
  const std::string names = "flow.heat", units = "m/s.K";
  const std::size_t labels = bytes.size();
  bytes.resize(labels + 2048);
  std::memcpy(bytes.data() + labels, names.data(), names.size());
  std::memcpy(bytes.data() + labels + 1024, units.data(), units.size());
  words({2, 3, 1, 0, 0});
  floats({0, 0, 0, 0, 9, 9, 9, 4});
  for (int i = 0; i < 15; ++i) floats({7});
  floats({0, 1, 2, 3, 4});
  words({0, 0, 0, 0});
  return bytes;
}

TEST_CASE("reads binary UCD of both byte orders") {
  const Bytes little = avs_binary([](Bytes& to, std::uint32_t word) { put(to, word); });
  const Bytes big = avs_binary([](Bytes& to, std::uint32_t word) { put_big(to, word); });
  for (const Bytes& bytes : {little, big}) {
    const Imported result = imported("AVS UCD", bytes);
    CHECK(result.messages().empty());
    CHECK(result.points().size() == 5);
    CHECK(result.points()[4] == glm::vec3(0.5f, 0.5f, 1));
    CHECK(result.corners().size() == 2 * 4 + 4 * 4 + 5);
    CHECK(result.colors()[0] == kLow);
    CHECK(result.colors()[2] == kMiddle);
    CHECK(result.colors()[4] == kHigh);
    REQUIRE(gs::app::color_key_of(*result.scene));
    CHECK(gs::app::color_key_of(*result.scene)->title == "heat (K)");
  }
  // Every prefix and every changed byte of the mesh.
  check_prefixes_and_flips("AVS UCD", Bytes(little.begin(), little.begin() + 25 + 48 + 44 + 60));
  Bytes longer = big;
  longer.push_back(std::byte{0});
  CHECK(imported("AVS UCD", longer).corners().size() == 2 * 4 + 4 * 4 + 5);
}

TEST_CASE("survives random changes of UCD text") {
  const std::string text =
      "5 2 1 1 0\n1 0 0 1\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 9 9 9\n1 1 pyr 1 2 3 4 5\n2 1 quad 2 3 4 5\n" +
      std::string("1 1\nt, K\n1 0\n2 1\n3 2\n4 3\n5 4\n1 1\np, Pa\n1 0\n2 1\n");
  CHECK(ucd(text).messages().empty());
  check_prefixes_and_flips("AVS UCD", bytes_of(text));
}

TEST_CASE("reads UCD files of other programs") {
  const auto folder = shared_folder() / "data/meshes/avs";
  if (!std::filesystem::exists(folder / "UCD_00000.inp")) {
    WARN("no " << folder);
    return;
  }
  const Imported text = imported("AVS UCD", file_bytes(folder / "cellsnd.ascii.inp"));
  const Imported packed = imported("AVS UCD", file_bytes(folder / "cellsnd.bin.inp"));
  for (const Imported* result : {&text, &packed}) {
    CHECK(result->messages().empty());
    CHECK(result->points().size() == 13);
    CHECK(result->corners().size() == 8 * 4 + 4 * 5);
    auto first = result->corners();
    first.resize(4);
    CHECK(first == std::vector<std::int32_t>{0, 4, 8, -1});
    // Temperatures from 1.5 at node 4 to 10.5 at node 12, with 6 at node 0.
    CHECK(result->colors()[4] == kLow);
    CHECK(result->colors()[12] == kHigh);
    CHECK(result->colors()[0] == kMiddle);
  }
  CHECK(text.points() == packed.points());
  CHECK(text.corners() == packed.corners());
  const Imported big = imported("AVS UCD", file_bytes(folder / "UCD_00000.inp"));
  CHECK(big.messages().empty());
  CHECK(big.points().size() == 5866);
  CHECK(big.corners().size() == 5384 * 5);
  CHECK(big.colors().size() == 5384);
  CHECK_FALSE(big.scene->get<bool>(big.only("IndexedFaceSet"), "colorPerVertex"));
}

constexpr const char* kMgf =
    "# Micro AVS Geom:2.10\n# a comment\n"
    "disjoint polygon\nfloor\nsmooth\nvertex\n2\n3\n0 0 0\n1 0 0\n1 1 0\n3\n0 0 0\n1 1 0\n0 1 0\n"
    "polyhedron\nsolid part\nfacet\ncolor\n3\n0 0 0 1 0 0\n1 0 0 0 1 0\n1 1 0 0 0 1\n1\n3\n1 2 3\n"
    "polytri\nstrip\nnormal_and_color\n4\n0 0 0 0 0 1 1 1 1\n1 0 0 0 0 1 1 1 1\n0 1 0 0 0 1 1 1 1\n1 1 0 0 0 1 0 0 0\n"
    "sphere\nball\nvertex\n1\n0 0 0 1\n"
    "mesh\nhill\nscalar\n3 2\n0 0.5 0\n0 -0.5 0\n"
    "disjoint line\nedges\nvertex\n4\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n"
    "polyline\nway\ncolor\n3\n0 0 0 1 0 0\n1 0 0 0 1 0\n1 1 0 0 0 1\n";

TEST_CASE("reads AVS text geometry") {
  const Imported result = avs(kMgf);
  CHECK(result.diagnostics.errors() == 0);
  CHECK(result.messages().find("sphere are left out") != std::string::npos);
  const auto faces = result.all("IndexedFaceSet");
  REQUIRE(faces.size() == 4);
  const auto index = [&](std::size_t i) { return result.values<gs::vrml::MFInt32>(faces[i], "coordIndex"); };
  const auto points = [&](std::size_t i) {
    return result.values<gs::vrml::MFVec3f>(result.scene->get<gs::vrml::SFNode>(faces[i], "coord"), "point");
  };
  const auto crease = [&](std::size_t i) { return result.scene->get<float>(faces[i], "creaseAngle"); };
  CHECK(index(0) == std::vector<std::int32_t>{0, 1, 2, -1, 0, 2, 3, -1});
  CHECK(points(0).size() == 4);
  CHECK(crease(0) > 3);
  CHECK(index(1) == std::vector<std::int32_t>{0, 1, 2, -1});
  CHECK(crease(1) == 0);
  CHECK(index(2) == std::vector<std::int32_t>{0, 1, 2, -1, 2, 1, 3, -1});
  CHECK(result.scene->get<gs::vrml::SFNode>(faces[2], "normal"));
  CHECK(index(3) == std::vector<std::int32_t>{0, 1, 4, 3, -1, 1, 2, 5, 4, -1});
  CHECK(points(3)[4] == glm::vec3(1, 1, -0.5f));
  const auto lines = result.all("IndexedLineSet");
  REQUIRE(lines.size() == 2);
  CHECK(result.values<gs::vrml::MFInt32>(lines[0], "coordIndex") == std::vector<std::int32_t>{0, 1, -1, 2, 3, -1});
  CHECK(result.scene->node(result.all("Shape")[1]).name == "solid_part");
  check_prefixes_and_flips("AVS geometry", bytes_of(kMgf));
}

TEST_CASE("reads AVS text geometry with steps, and reports mistakes") {
  const Imported steps =
      avs("# Micro AVS Geom:2.00\n2\nstep1 start\npolytri\na\nvertex\n3\n0 0 0\n1 0 0\n0 1 0\nstep2\npolytri\n" +
          std::string("a\nvertex\n3\n5 0 0\n6 0 0\n5 1 0\n"));
  CHECK(steps.points().size() == 3);
  CHECK(steps.messages().find("only the first step") != std::string::npos);
  CHECK(avs("# Micro AVS Geom:2.00\npolyhedron\na\nflat\n").messages().find(":4:5: error: expected facet or smooth") !=
        std::string::npos);
  CHECK(avs("# Micro AVS Geom:2.00\nmesh\na\nscalar\n1000000 1000000\n1 2\n")
            .messages()
            .find("ends before this number") != std::string::npos);
  CHECK(avs("GEOM\x01\x02").messages().find("binary .geom files of AVS5 cannot be read") != std::string::npos);
  CHECK(avs("# Micro AVS Geom:2.00\npolyhedron\na\nfacet\nvertex\n1\n0 0 0\n1\n3\n1 2 99999999999\n")
            .all("Shape")
            .empty());
}

}  // namespace
