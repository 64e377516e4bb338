#include "app/encode/mesh_stream.h"

#include "app/encode/mesh_surface.h"
#include "app/encode/surface_triangles.h"
#include "render/scene/render_list.h"
#include "tests/app/formats_helpers.h"
#include "tests/app/surface_triangles.h"
#include "tests/watched.h"

#include <catch2/catch.hpp>

#include <array>
#include <bit>
#include <cstring>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

using namespace gs;
using namespace gs::app;

namespace {

using MeshTriangles = std::vector<qnv::Triangle>;

template <class T>
void put_number(std::string& to, T value, bool big = false) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  if (big) std::reverse(bytes, bytes + sizeof(T));
  to.append(bytes, sizeof(T));
}

std::span<const std::byte> mesh_bytes(const std::string& text) { return std::as_bytes(std::span(text)); }

MeshTriangles triangles_of_stream(const std::string& text) {
  const auto stream = open_mesh_stream(mesh_bytes(text));
  REQUIRE(stream);
  MeshTriangles all;
  REQUIRE(stream->source([&](std::span<const qnv::Triangle> some) {
    all.insert(all.end(), some.begin(), some.end());
    return true;
  }));
  return all;
}

/// Encodes the file as a mesh without nodes.
MeshTriangles triangles_of_mesh(const std::string& text, const char* type) {
  const std::string path = "test";
  const WorldBudget budget = own_budget();
  Diagnostics diagnostics;
  Asset asset = test::type_named(type).read({mesh_bytes(text), path, {}, budget, diagnostics});
  const MeshSurface surface = mesh_surface(std::move(std::get<MeshAsset>(asset)), path, budget, diagnostics);
  MeshTriangles all = test::triangles_of(surface);
  CHECK(surface.summary.triangles == all.size());
  return all;
}

/// Encodes the file as a world.
MeshTriangles triangles_of_world(const std::string& text, const char* type) {
  const test::Imported world = test::imported(type, mesh_bytes(text));
  render::MeshCache meshes;
  const render::RenderList list = render::collect(*world.scene, {}, meshes);
  MeshTriangles all;
  (void)for_each_triangle(list, [&](std::span<const qnv::Triangle> some) {
    all.insert(all.end(), some.begin(), some.end());
    return true;
  });
  return all;
}

void check_same_triangles(const MeshTriangles& one, const MeshTriangles& other) {
  REQUIRE(one.size() == other.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    REQUIRE_EACH(one[i].positions == other[i].positions);
    REQUIRE_EACH(one[i].colors == other[i].colors);
  }
}

/// Returns a binary STL. `colors`: 0 none, 1 per facet, 2 as Magics writes them.
std::string binary_stl(std::size_t facets, int colors) {
  std::string text(80, ' ');
  if (colors == 2) text.replace(10, 10, std::string("COLOR=\x80\x40\xff\xff", 10));
  std::mt19937 random(7);
  put_number(text, static_cast<std::uint32_t>(facets));
  for (std::size_t i = 0; i < facets; ++i) {
    for (int k = 0; k < 12; ++k) put_number(text, static_cast<float>(random() % 1000) / 8);
    put_number(text, static_cast<std::uint16_t>(colors == 0 ? 0 : colors == 1 ? 0x8000 | random() : random()));
  }
  return text;
}

std::string binary_ply(bool big, bool wide, const std::string& more = {}) {
  const std::string number = wide ? "double" : "float";
  std::string text =
      std::string("ply\nformat binary_") + (big ? "big" : "little") + "_endian 1.0\nelement vertex 5\n" + "property " +
      number + " x\nproperty uchar red\nproperty " + number + " y\nproperty uchar green\n" + "property " + number +
      " z\nproperty uchar blue\nelement face 4\nproperty uchar flags\n" +
      "property list uchar int vertex_indices\nproperty list uchar float other\n" + more + "end_header\n";
  const double places[5][3] = {{6e6, 0, 0}, {6e6 + 1, 0, 0}, {6e6 + 1, 1, 0}, {6e6, 1, 0}, {6e6 + 0.5, 0.5, 1}};
  std::uint8_t shade = 10;
  for (const auto& place : places)
    for (const double axis : place) {
      if (wide)
        put_number(text, axis, big);
      else
        put_number(text, static_cast<float>(axis), big);
      put_number(text, shade += 13);
    }
  const auto face = [&](const std::vector<std::int32_t>& corners) {
    put_number(text, std::uint8_t{1});
    put_number(text, static_cast<std::uint8_t>(corners.size()));
    for (const std::int32_t corner : corners) put_number(text, corner, big);
    put_number(text, std::uint8_t{2});
    put_number(text, 1.5f, big);
    put_number(text, 2.5f, big);
  };
  face({0, 1, 2, 3});
  face({0, 4, 1});
  face({1, 4, 9});  // no such vertex
  face({2, 4, 3});
  return text;
}

}  // namespace

TEST_CASE("returns the triangles of a binary STL as in its world") {
  for (const int colors : {0, 1, 2}) {
    INFO(colors);
    const std::string text = binary_stl(9000, colors);
    check_same_triangles(triangles_of_stream(text), triangles_of_world(text, "STL"));
  }
  const std::string text = binary_stl(200, 0);
  CHECK(open_mesh_stream(mesh_bytes(text))->faces == 200);
  // Of a truncated file, the complete triangles are read.
  const std::string cut = text.substr(0, 84 + 50 * 70 + 49);
  CHECK(open_mesh_stream(mesh_bytes(cut))->faces == 70);
  CHECK(triangles_of_stream(cut).size() == 70);
  std::size_t given = 0;
  CHECK_FALSE(open_mesh_stream(mesh_bytes(text))->source([&](std::span<const qnv::Triangle> some) {
    given += some.size();
    return false;
  }));
  CHECK(given == 200);
}

TEST_CASE("returns the triangles of a binary PLY as in its world") {
  for (const bool big : {false, true}) {
    const std::string text = binary_ply(big, false);
    const MeshTriangles triangles = triangles_of_stream(text);
    REQUIRE(triangles.size() == 4);
    check_same_triangles(triangles, triangles_of_world(text, "PLY"));
    // If the file has more digits than float32, positions are relative to a nearby origin.
    const std::string wide = binary_ply(big, true);
    const auto stream = open_mesh_stream(mesh_bytes(wide));
    REQUIRE(stream);
    CHECK(stream->origin == glm::dvec3(6e6 + 0.5, 0, 0));
    CHECK(stream->size == glm::vec3(1, 1, 1));
    CHECK(triangles_of_stream(wide)[2].positions[1] == glm::vec3(0, 0.5, 1));
    CHECK(triangles_of_stream(wide)[2].colors[1].r == 10 + 13 * 13);
    for (std::size_t length = 0; length <= text.size(); ++length) {
      const std::string prefix = text.substr(0, length);
      if (open_mesh_stream(mesh_bytes(prefix))) CHECK(triangles_of_stream(prefix).size() <= 4);
    }
  }
}

TEST_CASE("reads the runs of a large mesh in any order") {
  const std::size_t run = MeshStream::kRunFaces, faces = run + 1000;
  // A PLY of triangles only, and one with a face of four corners. There, finding the second run reads the first.
  const auto ply = [&](bool equal) {
    std::string text =
        "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
        "property float z\nelement face " +
        std::to_string(faces) + "\nproperty list uchar uchar vertex_indices\nend_header\n";
    for (const float number : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f}) put_number(text, number);
    for (std::size_t i = 0; i < faces; ++i) {
      const auto least = static_cast<char>(i % 2);
      const bool four = !equal && i == 5;
      text += {static_cast<char>(four ? 4 : 3), least, static_cast<char>(least + 1), static_cast<char>(least + 2)};
      if (four) text += static_cast<char>(3 - least);
    }
    return text;
  };
  for (const std::string& text : {binary_stl(faces, 0), ply(true), ply(false)}) {
    const MeshTriangles all = triangles_of_stream(text);
    const auto stream = open_mesh_stream(mesh_bytes(text));
    REQUIRE(stream->source.runs() == 2);
    std::array<MeshTriangles, 2> runs;
    for (const std::size_t k : {1u, 0u})
      REQUIRE(stream->source.read(k, [&](std::span<const qnv::Triangle> some) {
        runs[k].insert(runs[k].end(), some.begin(), some.end());
        return true;
      }));
    CHECK(runs[1].size() == 1000);
    runs[0].insert(runs[0].end(), runs[1].begin(), runs[1].end());
    check_same_triangles(runs[0], all);
  }
  // The size of this file suggests only triangles, but it has other faces.
  std::string text = ply(true);
  text[text.size() - 4] = 2;
  CHECK_FALSE(open_mesh_stream(mesh_bytes(text))->source([](std::span<const qnv::Triangle>) { return true; }));
}

TEST_CASE("rejects files that are no mesh of ordered triangles") {
  CHECK_FALSE(open_mesh_stream({}));
  CHECK_FALSE(open_mesh_stream(mesh_bytes("solid a\nfacet normal 0 0 1\nendsolid")));
  CHECK_FALSE(open_mesh_stream(mesh_bytes("ply\nformat ascii 1.0\nelement vertex 0\nend_header\n")));
  CHECK_FALSE(open_mesh_stream(
      mesh_bytes("ply\nformat binary_little_endian 1.0\nelement vertex 0\nproperty float x\nend_header\n")));
}

TEST_CASE("returns the triangles of a mesh without nodes as in its world") {
  const std::string points = "v 0 0 0 1 0 0\nv 2 0 0\nv 2 2 1 0 1 0\nv 0 2 0\nv 1 3 2\n";
  const std::pair<const char*, std::string> files[] = {
      {"STL", binary_stl(300, 1)},
      {"STL", "solid a\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n"},
      {"PLY", binary_ply(true, false)},
      {"OBJ", points + "vn 0 0 1\nvn 0 1 1\ng a\nf 1 2 3 4\ns 1\nf 1//1 2//2 5//1\nusemtl b\nf 3 4 5\nl 1 2\np 3\n"},
      {"OFF", "OFF\n5 3 0\n0 0 0\n2 0 0\n2 2 0\n1 0.5 0\n0 0 3\n4 0 1 2 3 255 0 0\n3 0 1 4\n3 1 2 9\n"},
      {"AVS geometry",
       "# Micro AVS Geom:2.00\npolyhedron\na\nfacet\ncolor\n3\n0 0 0 1 0 0\n1 0 0 0 1 0\n0 1 0 0 0 1\n"
       "1\n3\n1 2 3\n"},
      {"AVS UCD", "4 1 1 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n1 0 tet 1 2 3 4\n1 1\nt, K\n1 5\n2 6\n3 7\n4 9\n"},
      {"legacy VTK",
       "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n0 0 0 1 0 0 1 1 0 0 1 0\n"
       "POLYGONS 1 5\n4 0 1 2 3\nLINES 1 3\n2 0 1\nPOINT_DATA 4\nSCALARS s float\nLOOKUP_TABLE default\n"
       "1 2 3 4\n"},
  };
  for (const auto& [type, text] : files) {
    INFO(type);
    const MeshTriangles mesh = triangles_of_mesh(text, type), world = triangles_of_world(text, type);
    CHECK_FALSE(mesh.empty());
    check_same_triangles(mesh, world);
    for (std::size_t i = 0; i < mesh.size(); ++i) REQUIRE_EACH(mesh[i].normals == world[i].normals);
  }
}

TEST_CASE("leaves out parts of a mesh that exceed the budget, and names the limit") {
  const std::string path = "test", text = binary_stl(30'000, 0);
  const auto budget = std::make_shared<Budget>(Limits{.memory = std::size_t{4} << 20});
  Diagnostics diagnostics;
  Asset asset = test::type_named("STL").read({mesh_bytes(text), path, {}, own_budget(), diagnostics});
  const MeshSurface surface = mesh_surface(std::move(std::get<MeshAsset>(asset)), path, budget, diagnostics);
  CHECK(surface.parts.empty());
  REQUIRE(diagnostics.errors() == 1);
  CHECK(diagnostics.entries()[0].message.find("limit for meshes") != std::string::npos);
}
