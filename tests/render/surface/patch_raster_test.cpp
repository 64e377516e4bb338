#include "render/surface/patch_raster.h"

#include "render/rays/surface_pick.h"
#include "render/splat/splat_pieces.h"
#include "render/surface/patch_kernel.h"
#include "tests/qnv/codecs/displaced/tessellation/patch_shapes.h"
#include "tests/render/geometry_shapes.h"

#include <catch2/catch.hpp>
#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <tuple>

namespace gs::render::patch_raster_test {
namespace {

using qnv::displaced::ball;
using qnv::displaced::mesh_of;
using qnv::displaced::sheet;
using qnv::displaced::torus;

SplatView view_from(const glm::vec3& eye, int size, int supersample, const glm::mat4& world_from_node = glm::mat4(1)) {
  SplatView view;
  view.camera_from_node = glm::lookAt(eye, glm::vec3(0), glm::vec3(0, 0, 1)) * world_from_node;
  view.tangents = glm::vec2(0.5f);
  view.width = size;
  view.height = size;
  view.near_plane = 0.01f;
  view.supersample = supersample;
  return view;
}

qnv::SurfaceCut cut_for(const qnv::SurfacePatches& surface, const SplatView& view, float error,
                        bool leave_backs = true) {
  auto looked = lod_view(view);
  REQUIRE(looked);
  looked->error_pixels = error;
  looked->leave_backs = leave_backs;
  return qnv::cut_surface(surface, *looked);
}

/// Agreement of normals and coverage, both 0 to 1.
double likeness(const SplatLayer& a, const SplatLayer& b) {
  REQUIRE(a.normals.size() == b.normals.size());
  test::Psnr psnr;
  for (std::size_t i = 0; i < a.normals.size(); ++i) psnr.add(a.normals[i] / 65535.0, b.normals[i] / 65535.0);
  return psnr.decibels();
}

std::size_t covered(const SplatLayer& layer) {
  std::size_t count = 0;
  for (std::size_t i = 3; i < layer.normals.size(); i += 4) count += layer.normals[i] > 0 ? 1 : 0;
  return count;
}

}  // namespace

TEST_CASE("shows at each sample the nearest triangle with its normal and depth") {
  for (const int which : {0, 1}) {
    const qnv::displaced::SurfaceMesh shape = which == 0 ? mesh_of(torus(6, 4)) : mesh_of(sheet(8));
    const qnv::SurfacePatches surface = qnv::patches_of(qnv::rough_surface(shape, 3, 3), 3);
    // The item is scaled non-uniformly, mirrored, and cut by the near plane.
    glm::mat4 uneven = glm::scale(glm::mat4(1), glm::vec3(1, 0.6f, 1.3f));
    for (const SplatView& view : {view_from({2.5f, 0.7f, 1.2f}, 48, 1), view_from({2.5f, 0.7f, 1.2f}, 48, 1, uneven),
                                  view_from({2, 1.5f, 1}, 48, 1, glm::scale(glm::mat4(1), glm::vec3(-1, 1, 1))),
                                  view_from({0.5f, 0.3f, 0.25f}, 48, 1)}) {
      const SplatLayer layer =
          rasterize_patches(surface, cut_for(surface, view, 4, false), view, {true, {}, ColorBy::own});
      REQUIRE(layer.width == 48);
      const glm::dmat4 node_from_camera = glm::inverse(glm::dmat4(view.camera_from_node));
      std::size_t wrong = 0, both = 0;
      for (int y = 0; y < view.height; ++y)
        for (int x = 0; x < view.width; ++x) {
          const glm::dvec3 ray((2.0 * x + 1) / 48 - 1, (2.0 * y + 1) / 48 - 1, -2);
          // The ray starts at the eye, and its lengths are depths. Geometry before the near plane is not drawn.
          const SightLine line{glm::dvec3(node_from_camera[3]),
                               glm::dvec3(node_from_camera * glm::dvec4(ray * 0.5, 0))};
          const auto hit = pick_patches(surface, line, 4 / 48.0f);
          if (hit && hit->distance <= 0.012) continue;
          const auto at = static_cast<std::size_t>(y * 48 + x);
          const bool drawn = layer.normals[4 * at + 3] > 0;
          if (hit.has_value() != drawn) {
            ++wrong;
            continue;
          }
          if (!hit) continue;
          ++both;
          const glm::vec3 shown =
              glm::vec3(layer.normals[4 * at], layer.normals[4 * at + 1], layer.normals[4 * at + 2]) / 32767.5f - 1.0f;
          const glm::vec3 normal =
              glm::normalize(glm::transpose(glm::inverse(glm::mat3(view.camera_from_node))) * hit->normal);
          const bool near = std::abs(static_cast<double>(layer.depth[at]) - hit->distance) < 0.01 * hit->distance;
          if (!near || std::abs(glm::dot(shown, normal)) < 0.99f) ++wrong;
        }
      INFO(which);
      CHECK(both > 200);
      CHECK(wrong <= both / 50);  // differences are at edges, which the rasteriser rounds
    }
  }
}

TEST_CASE("draws a closed surface of mixed levels without pinholes, equally on any number of threads") {
  const qnv::SurfacePatches surface = qnv::patches_of(qnv::rough_surface(mesh_of(ball(3)), 4), 4);
  SplatView view = view_from({1.6f, 0.4f, 0.5f}, 96, 2);
  for (const float error : {24.0f, 3.0f}) {
    const qnv::SurfaceCut cut = cut_for(surface, view, error);
    view.threads = 1;
    const SplatLayer layer = rasterize_patches(surface, cut, view, {});
    view.threads = 3;
    const SplatLayer other = rasterize_patches(surface, cut, view, {});
    CHECK(layer.normals == other.normals);
    CHECK(layer.depth == other.depth);
    std::size_t inside = 0, holes = 0;
    const auto full = [&](std::size_t i) { return layer.normals[4 * i + 3] == 65535; };
    for (std::size_t y = 1; y + 1 < 96; ++y)
      for (std::size_t x = 1; x + 1 < 96; ++x) {
        const std::size_t i = y * 96 + x;
        if (!full(i - 1) || !full(i + 1) || !full(i - 96) || !full(i + 96)) continue;
        ++inside;
        holes += full(i) ? 0 : 1;
      }
    CHECK(inside > 1000);
    CHECK(holes == 0);
  }
}

TEST_CASE("rasterises patches to the same bits in all kernels", "[optimised]") {
  const std::span<const PatchKernel> kernels = patch_kernels();
  REQUIRE(!kernels.empty());
  // Triangles from parts of a sample to whole tiles, with and without colours, mirrored, cut by the near plane.
  const glm::mat4 mirrored = glm::scale(glm::mat4(1), glm::vec3(-1, 1, 1));
  for (const bool colored : {false, true}) {
    const qnv::SurfacePatches surface = qnv::patches_of(qnv::rough_surface(mesh_of(torus(6, 4)), 3, 0, colored), 3);
    for (const SplatView& view :
         {view_from({2.5f, 0.7f, 1.2f}, 99, 2), view_from({2.5f, 0.7f, 1.2f}, 60, 1, mirrored),
          view_from({12, 7, 9}, 70, 4), view_from({0.5f, 0.3f, 0.25f}, 150, 1), view_from({3, 1, 1}, 24, 8)})
      for (const float error : {2.0f, 50.0f}) {
        const qnv::SurfaceCut cut = cut_for(surface, view, error, false);
        for (const bool two_sided : {false, true}) {
          const PatchRasterOptions options{two_sided, {}, ColorBy::own};
          const SplatLayer first = rasterize_patches(surface, cut, view, options, kernels.front());
          CHECK(first.colors.empty() == !colored);
          CHECK(covered(first) > 20);
          for (const PatchKernel& kernel : kernels.subspan(1)) {
            INFO(kernels.front().name << " and " << kernel.name << ", " << view.width << ", " << error);
            const SplatLayer other = rasterize_patches(surface, cut, view, options, kernel);
            CHECK(std::tie(first.x, first.y, first.width, first.drawn) ==
                  std::tie(other.x, other.y, other.width, other.drawn));
            CHECK(first.normals == other.normals);
            CHECK(first.depth == other.depth);
            CHECK(first.colors == other.colors);
          }
        }
      }
  }
}

TEST_CASE("draws every triangle of a surface that fills the picture, small or large") {
  const qnv::SurfacePatches surface = qnv::patches_of(qnv::rough_surface(mesh_of(ball(2)), 4), 4);
  for (const int size : {20, 90, 300}) {
    const SplatView inside = view_from({0.1f, 0.2f, 0.3f}, size, 1);
    for (const float error : {0.1f, 3.0f, 40.0f}) {
      const qnv::SurfaceCut cut = cut_for(surface, inside, error, false);
      INFO(size << ", " << error);
      CHECK(covered(rasterize_patches(surface, cut, inside, {true, {}, ColorBy::own})) ==
            static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
    }
  }
}

TEST_CASE("limits the layer to the tiles that contain geometry") {
  const qnv::SurfacePatches surface = qnv::patches_of(qnv::rough_surface(mesh_of(ball(2)), 2), 2);
  SplatView view = view_from({40, 0, 0}, 512, 1);
  const SplatLayer layer = rasterize_patches(surface, cut_for(surface, view, 1), view, {});
  CHECK(layer.x == 192);
  CHECK(layer.y == 192);
  CHECK(layer.width == 128);
  CHECK(layer.height == 128);
  CHECK(covered(layer) > 300);
  view.center = glm::vec2(5);  // beside the surface
  CHECK(rasterize_patches(surface, cut_for(surface, view, 1), view, {}).empty());
}

TEST_CASE("keeps the colours of a surface for small and large triangles") {
  const qnv::SurfacePatches surface = qnv::patches_of(qnv::rough_surface(mesh_of(ball(2)), 3), 3);
  const SplatView view = view_from({3, 0, 0}, 64, 2);
  for (const float error : {1.0f, 30.0f}) {
    const qnv::SurfaceCut cut = cut_for(surface, view, error);
    const SplatLayer layer = rasterize_patches(surface, cut, view, {false, {}, ColorBy::normal});
    REQUIRE(layer.colors.size() == layer.normals.size());
    // The surface faces along x in the middle.
    const std::size_t middle = static_cast<std::size_t>((32 - layer.y) * layer.width + 32 - layer.x);
    CHECK(layer.colors[4 * middle] > 200);
    CHECK(std::abs(layer.colors[4 * middle + 1] - 128) < 60);
    CHECK(std::abs(layer.colors[4 * middle + 2] - 128) < 60);
  }
}

TEST_CASE("draws a cut with edges of a pixel like the whole surface", "[optimised]") {
  const qnv::SurfacePatches surface = qnv::patches_of(qnv::rough_surface(mesh_of(torus(12, 8)), 5, 0, true), 5);
  const SplatView view = view_from({4, 1, 2}, 128, 2);
  const SplatLayer whole = rasterize_patches(surface, cut_for(surface, view, 0.001f), view, {});
  const SplatLayer fine = rasterize_patches(surface, cut_for(surface, view, 1), view, {});
  const SplatLayer coarse = rasterize_patches(surface, cut_for(surface, view, 30), view, {});
  CHECK(fine.discs < whole.discs);
  CHECK(likeness(whole, fine) > 29);  // on pixels with geometry
  CHECK(likeness(whole, coarse) < likeness(whole, fine) - 6);
  CHECK(!whole.colors.empty());
}

TEST_CASE("draws a tile with the samples of the whole picture") {
  const qnv::SurfacePatches surface = qnv::patches_of(qnv::rough_surface(mesh_of(torus(12, 8)), 4, 0, true), 4);
  const SplatView view = view_from({4, 1, 2}, 64, 1);
  const qnv::SurfaceCut cut = cut_for(surface, view, 4);
  const SplatLayer whole = rasterize_patches(surface, cut, view, {});
  std::size_t together = 0;
  for (int quarter = 0; quarter < 4; ++quarter) {
    SplatView part = view;
    part.width = part.height = 32;
    part.tangents = 0.5f * view.tangents;
    const glm::ivec2 first(32 * (quarter % 2), 32 * (quarter / 2));
    part.center = (glm::vec2(first) / 32.0f - 0.5f) * view.tangents;
    const SplatLayer layer = rasterize_patches(surface, cut, part, {});
    const auto normal = [](const SplatLayer& of, int x, int y, int k) {
      x -= of.x, y -= of.y;
      if (x < 0 || y < 0 || x >= of.width || y >= of.height) return 0;
      return static_cast<int>(of.normals[static_cast<std::size_t>(4 * (y * of.width + x) + k)]);
    };
    int differing = 0;
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 32; ++x)
        for (int k = 0; k < 4; ++k)
          differing += std::abs(normal(layer, x, y, k) - normal(whole, first.x + x, first.y + y, k)) > 2 ? 1 : 0;
    together += covered(layer);
    CHECK(differing < 16);  // of 4,096: positions on edges are rounded again
  }
  CHECK(together > 300);
  CHECK(std::abs(static_cast<double>(together) - static_cast<double>(covered(whole))) < 16);
}

TEST_CASE("draws back faces only if the surface is two-sided") {
  const qnv::SurfacePatches surface = qnv::patches_of(qnv::rough_surface(mesh_of(ball(2)), 2), 2);
  const SplatView inside = view_from({0.01f, 0.02f, 0.03f}, 32, 1);
  const qnv::SurfaceCut cut = cut_for(surface, inside, 8, false);
  CHECK(covered(rasterize_patches(surface, cut, inside, {})) == 0);
  CHECK(covered(rasterize_patches(surface, cut, inside, {true, {}, ColorBy::own})) == 32 * 32);
}

TEST_CASE("picks a point on a triangle, and returns its nearest corner") {
  const qnv::SurfacePatches surface = qnv::patches_of(qnv::rough_surface(mesh_of(ball(2)), 3), 3);
  const SightLine line{{0.2, 0.1, 5}, {0, 0, -1}};
  const auto hit = pick_patches(surface, line, 0.001f);
  REQUIRE(hit);
  const glm::dvec3 point = line.origin + line.direction * hit->distance;
  glm::dvec3 blended(0);
  double nearest = 10;
  for (int k = 0; k < 3; ++k) {
    const glm::dvec3 corner(hit->corners[static_cast<std::size_t>(k)]);
    blended += corner * hit->weights[k];
    nearest = std::min(nearest, glm::length(corner - point));
  }
  CHECK(glm::length(blended - point) < 1e-5);
  CHECK(hit->normal.z > 0.3f);
  CHECK(glm::length(glm::dvec3(hit->vertex) - point) < 2 * nearest + 1e-9);
  CHECK(!pick_patches(surface, {{3, 3, 5}, {0, 0, -1}}, 0.001f));
  CHECK(!hit->color);
}

TEST_CASE("interpolates the colour of a picked point between the corners") {
  const auto color = [](const glm::vec3& p) { return p.z > 0 ? qnv::Rgb8{200, 100, 50} : qnv::Rgb8{0, 0, 255}; };
  const qnv::displaced::SurfaceMesh mesh = mesh_of(ball(4, color), true);
  const qnv::SurfacePatches surface = qnv::patches_of(qnv::rough_surface(mesh, 1, 0, true), 1);
  REQUIRE(surface.parts[0]->colored());
  const auto hit = pick_patches(surface, {{0.02, 0.01, 5}, {0, 0, -1}}, 0.001f);
  REQUIRE(hit);
  REQUIRE(hit->color);
  float least = 1, most = 0;
  for (std::size_t patch = 0; patch < surface.parts[0]->size(); ++patch)
    for (const int level : {0, 1})
      for (std::size_t k = 0; k < qnv::new_patch_vertices(level); ++k)
        if (const auto& vertex = surface.parts[0]->vertices(patch, level)[k];
            std::count(hit->corners.begin(), hit->corners.end(), vertex.position) > 0) {
          const float red = static_cast<float>(surface.parts[0]->colors(patch, level)[k].r) / 255;
          least = std::min(least, red);
          most = std::max(most, red);
        }
  CHECK(least <= most);
  CHECK(hit->color->r >= least - 1e-5f);
  CHECK(hit->color->r <= most + 1e-5f);
}

}  // namespace gs::render::patch_raster_test
