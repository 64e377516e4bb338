#include "app/encode/mesh_stream.h"

#include "app/encode/surface_triangles.h"
#include "app/formats/mesh/ply.h"
#include "app/formats/mesh/stl.h"
#include "render/scene/render_list.h"
#include "tests/watched.h"
#include "vrml/scene/scene_graph.h"

#include <catch2/catch.hpp>

#include <bit>
#include <cstring>
#include <random>
#include <span>
#include <string>
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

/// Encodes the file as a world.
template <class Import>
MeshTriangles triangles_of_world(const std::string& text, Import import) {
  vrml::SceneGraph scene("test");
  Diagnostics diagnostics;
  import(mesh_bytes(text), scene, diagnostics);
  render::MeshCache meshes;
  const render::RenderList list = render::collect(scene, {}, meshes);
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
    check_same_triangles(triangles_of_stream(text), triangles_of_world(text, import_stl));
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
    const MeshTriangles world = triangles_of_world(
        text, [](auto bytes, auto& scene, auto& diagnostics) { import_ply(bytes, scene, diagnostics); });
    check_same_triangles(triangles, world);
    // Relative to a nearby origin if the file has more digits than float32.
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

TEST_CASE("rejects files that are no mesh of ordered triangles") {
  CHECK_FALSE(open_mesh_stream({}));
  CHECK_FALSE(open_mesh_stream(mesh_bytes("solid a\nfacet normal 0 0 1\nendsolid")));
  CHECK_FALSE(open_mesh_stream(mesh_bytes("ply\nformat ascii 1.0\nelement vertex 0\nend_header\n")));
  CHECK_FALSE(open_mesh_stream(
      mesh_bytes("ply\nformat binary_little_endian 1.0\nelement vertex 0\nproperty float x\nend_header\n")));
}
