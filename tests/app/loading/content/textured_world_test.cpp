// Tests of textured streams as worlds: the bytes that show the mesh and its texture.
#include "app/formats/qnv/surface_pictures.h"
#include "app/loading/world_loader.h"
#include "app/view/picking.h"
#include "qnv/codecs/displaced/encode/encode_displaced.h"
#include "qnv/codecs/shared/encode_options.h"
#include "render/collection/collector.h"
#include "render/collection/render_scene.h"
#include "render/image/image.h"
#include "tests/app/geometry_shapes.h"
#include "tests/app/scratch_folder.h"
#include "tests/app/worlds.h"
#include "tests/qnv/codecs/displaced/displaced_shapes.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <string>

namespace gs::app::textured_world_test {
namespace {

render::Image colored_picture(std::uint32_t size) {
  render::Image image;
  image.width = image.height = size;
  image.components = 3;
  for (std::uint32_t i = 0; i < size * size; ++i)
    image.pixels.insert(image.pixels.end(), {static_cast<std::uint8_t>(255 * (i % size) / size), 30,
                                             static_cast<std::uint8_t>(255 * (i / size) / size)});
  return image;
}

/// Returns a torus with a texture of 128 pixels per axis, after a coarse texture of 32 pixels.
const std::string& torus_stream() {
  static const std::string bytes = [] {
    const qnv::Triangles torus = qnv::displaced::torus(70, 40);
    qnv::TexturedSurface surface;
    surface.triangles = torus;
    for (const qnv::Triangle& t : torus) {
      auto& at = surface.coordinates.emplace_back();
      for (std::size_t k = 0; k < 3; ++k) at[k] = glm::vec2(t.positions[k]) * 0.3f + 0.5f;
    }
    surface.width = surface.height = 128;
    for (const std::uint32_t size : {32u, 128u}) {
      qnv::PictureFile& file = surface.picture.emplace_back();
      file.bytes = render::encode_jpeg(colored_picture(size), {95, false});
      file.enough = file.bytes.size();
    }
    qnv::EncodeOptions options;
    options.exact_bits = qnv::kExactWherePays;
    options.textured = &surface;
    auto made = qnv::encode_displaced([&](const qnv::TriangleSink& sink) { return sink(torus); }, options);
    REQUIRE(std::holds_alternative<qnv::EncodedStream>(made));
    return test::string_of(std::get<qnv::EncodedStream>(made).bytes);
  }();
  return bytes;
}

}  // namespace

TEST_CASE("shows a textured surface with the received part of mesh and texture") {
  const ScratchFolder folder;
  const std::string path = folder.write("torus.qnv", torus_stream());
  std::size_t plain = 0, both = 0, whole = 0;
  std::uint32_t width = 0;
  for (std::size_t bytes = 1400; bytes < torus_stream().size() + 400; bytes += 400) {
    LoadOptions cut;
    cut.max_bytes = bytes;
    LoadedWorld world = load_world(path, cut);
    INFO(bytes << " bytes: " << said(world));
    REQUIRE(world.geometries.size() == 1);
    const auto& [node, geometry] = *world.geometries.begin();
    render::MeshCache meshes;
    const render::RenderList list = render::collect(*world.scene, world.images, meshes, {0, 0, 10}, world.geometries);
    const auto pictured =
        std::ranges::count_if(list.items, [](const auto& item) { return item.texture.image != nullptr; });
    if (pictured == 0) {
      ++plain;
      REQUIRE(both + whole == 0);
      REQUIRE(list.items.size() == 1);
      continue;
    }
    REQUIRE(pictured == 1);
    const render::DrawItem& item = list.items.back();
    REQUIRE(item.texture.image == world.images.at(node));
    REQUIRE(item.texture.image->width >= width);
    width = item.texture.image->width;
    REQUIRE(item.mesh->texture_coordinates.size() == item.mesh->positions.size());
    REQUIRE(item.mesh->colors.empty());
    for (const std::uint32_t i : item.mesh->indices) REQUIRE_EACH(i < item.mesh->positions.size());
    if (list.items.size() == 2) {
      ++both;
      REQUIRE(whole == 0);
      REQUIRE(list.items[0].mesh->texture_coordinates.empty());
      REQUIRE(!list.items[0].texture.image);
      for (const std::uint32_t i : list.items[0].mesh->indices) REQUIRE_EACH(i < list.items[0].mesh->positions.size());
      REQUIRE(list.items[0].mesh->indices.size() + item.mesh->indices.size() ==
              geometry->as<qnv::IndexedMesh>()->triangles.size());
    } else {
      ++whole;
      REQUIRE(item.mesh->indices.size() == 3u * 2 * 70 * 40);
    }
  }
  CHECK(plain > 3);
  CHECK(both > 2);
  CHECK(whole > 3);
  CHECK(width == 128);
}

TEST_CASE("keeps the texture of a surface when its material changes, and under the pointer") {
  const ScratchFolder folder;
  (void)folder.write("torus.qnv", torus_stream());
  const std::string path =
      folder.write("world.wrl",
                   "#VRML V2.0 utf8\nShape { appearance Appearance { material DEF M Material { transparency 0 } }\n"
                   "geometry QNV { url \"torus.qnv\" } }");
  LoadedWorld world = load_world(path);
  INFO(said(world));
  REQUIRE(world.geometries.size() == 1);
  render::MeshCache meshes;
  render::RenderScene scene(*world.scene, world.images, world.geometries, meshes);
  scene.gather({}, {0, 0, 10});
  REQUIRE(scene.list().items.size() == 1);
  const auto image = scene.list().items[0].texture.image;
  REQUIRE(image);
  vrml::NodeId material;
  for (std::uint32_t i = 1; i <= world.scene->nodes().count(); ++i)
    if (world.scene->nodes().at(i).type->name == "Material") material = world.scene->nodes().id_at(i);
  REQUIRE(material);
  const vrml::NodeChange change{world.scene.get(), material, ~std::uint64_t{0}};
  (void)scene.update(std::span(&change, 1), {}, {0, 0, 10});
  CHECK(scene.gathered() == 1);
  CHECK(scene.list().items[0].texture.image == image);
  render::SightLine line;
  line.origin = {1, 0.1, 6};
  line.direction = {0, 0, -1};
  const auto hit = Picker().pick(scene.list(), line);
  REQUIRE(hit);
  CHECK(hit->item == 0);
  CHECK(glm::length(glm::dvec2(hit->point) - glm::dvec2(1, 0.1)) < 1e-6);
}

TEST_CASE("decodes an image once, and ignores one that fails") {
  SurfacePictures pictures;
  auto picture = std::make_shared<qnv::SurfacePicture>();
  picture->bytes = render::encode_jpeg(colored_picture(64));
  const std::shared_ptr<const qnv::SurfacePicture> shared = picture;
  const auto image = pictures.image_of(shared, own_budget());
  REQUIRE(image);
  CHECK(image->width == 64);
  CHECK(pictures.image_of(shared, own_budget()) == image);
  auto broken = std::make_shared<qnv::SurfacePicture>();
  broken->bytes.assign(100, std::byte{3});
  CHECK(!pictures.image_of(broken, own_budget()));
}

}  // namespace gs::app::textured_world_test
