// Tests of meshes in GLB, with colours or a texture.
#include "app/formats/export/export_glb_mesh.h"
#include "app/formats/qnv/surface_pictures.h"
#include "app/loading/world_loader.h"
#include "render/image/image.h"
#include "tests/app/scratch_folder.h"
#include "tests/app/worlds.h"

#include <catch2/catch.hpp>

#include <string>

namespace gs::app::export_glb_mesh_test {
namespace {

/// A square seen from above; its second half may have a texture of four colours.
qnv::IndexedMesh square(bool pictured) {
  qnv::IndexedMesh geometry;
  geometry.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  geometry.normals.assign(6, glm::vec3(0, 0, 1));
  geometry.weights.assign(6, 1.0f);
  geometry.triangles = {0, 1, 2, 3, 4, 5};
  for (const glm::vec3& p : geometry.positions) geometry.description.box.add(p);
  geometry.colors.assign(6, {255, 0, 0});
  if (!pictured) return geometry;
  geometry.texture_coordinates = {{0.25f, 0.25f}, {0.75f, 0.75f}, {0.25f, 0.75f}};
  render::Image image;
  image.width = image.height = 2;
  image.components = 3;
  image.pixels = {10, 20, 30, 40, 50, 60, 70, 80, 90, 100, 110, 120};  // the upper row first
  auto picture = std::make_shared<qnv::SurfacePicture>();
  picture->bytes = render::encode_png(image);
  picture->whole = true;
  picture->repeat_t = false;
  geometry.picture = picture;
  return geometry;
}

render::RenderList collected(const qnv::Geometry& geometry) {
  const ScratchFolder folder;
  const Exported glb = export_glb(geometry, {"square", {}});
  REQUIRE(std::holds_alternative<std::vector<std::byte>>(glb));
  const auto& bytes = std::get<std::vector<std::byte>>(glb);
  const LoadedWorld world =
      load_world(folder.write("square.glb", std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size())));
  INFO(said(world));
  REQUIRE(world.scene);
  render::MeshCache meshes;
  return render::collect(*world.scene, world.images, meshes);
}

}  // namespace

TEST_CASE("exports triangles of a stream as a mesh in GLB, with their colours") {
  const render::RenderList list = collected(square(false));
  REQUIRE(list.items.size() == 1);
  const vrml::Mesh& mesh = *list.items[0].mesh;
  CHECK(mesh.indices.size() == 6);
  CHECK(mesh.normals.size() == mesh.positions.size());
  REQUIRE(!mesh.colors.empty());
  CHECK(mesh.colors[0].r == Approx(1).margin(0.01));
  CHECK(mesh.colors[0].g == Approx(0).margin(0.01));
  CHECK(!list.items[0].texture.image);
}

TEST_CASE("exports a texture to GLB pixel by pixel, beside coloured triangles") {
  const render::RenderList list = collected(square(true));
  REQUIRE(list.items.size() == 2);
  CHECK(!list.items[0].texture.image);
  const render::DrawItem& item = list.items[1];
  REQUIRE(item.texture.image);
  CHECK(item.texture.image->pixels[0] == 10);
  CHECK(item.texture.repeat_s);
  CHECK(!item.texture.repeat_t);
  REQUIRE(item.mesh->texture_coordinates.size() == 3);
  glm::vec2 least(9), most(-9);
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::vec3 at = item.texture.transform * glm::vec3(item.mesh->texture_coordinates[i], 1);
    least = glm::min(least, glm::vec2(at));
    most = glm::max(most, glm::vec2(at));
  }
  CHECK(least == glm::vec2(0.25f, 0.25f));
  CHECK(most == glm::vec2(0.75f, 0.75f));
}

TEST_CASE("exports vertex colours if textures are not shown") {
  qnv::IndexedMesh geometry = square(true);
  color_by_picture(geometry, own_budget());
  CHECK(geometry.colors[0] == qnv::Rgb8{255, 0, 0});
  CHECK(geometry.colors[3] == qnv::Rgb8{70, 80, 90});
  CHECK(geometry.colors[4] == qnv::Rgb8{40, 50, 60});
  CHECK(geometry.colors[5] == qnv::Rgb8{10, 20, 30});
  qnv::IndexedMesh plain = square(false);
  color_by_picture(plain, own_budget());
  CHECK(plain.colors[5] == qnv::Rgb8{255, 0, 0});
}

TEST_CASE("refuses to export an empty mesh, and exports splats of a mesh on request") {
  qnv::IndexedMesh geometry = square(false);
  const Exported splats = export_glb_splats(geometry);
  REQUIRE(std::holds_alternative<std::vector<std::byte>>(splats));
  const auto& bytes = std::get<std::vector<std::byte>>(splats);
  CHECK(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()).find("KHR_gaussian_splatting") !=
        std::string::npos);
  geometry.triangles.clear();
  CHECK(std::holds_alternative<std::string>(export_glb_mesh(geometry)));
}

}  // namespace gs::app::export_glb_mesh_test
