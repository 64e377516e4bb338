#include "render/rays/mesh_trees.h"

#include "render/rays/item_bvh.h"

#include <catch2/catch.hpp>

#include <chrono>
#include <cmath>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

namespace gs::render::mesh_trees_test {
namespace {

/// Returns a horizontal square of side 1 at height `y`, with enough triangles for a large mesh.
std::shared_ptr<const vrml::Mesh> floor_at(float y) {
  constexpr std::uint32_t kSide = 230;
  auto mesh = std::make_shared<vrml::Mesh>();
  for (std::uint32_t i = 0; i <= kSide; ++i)
    for (std::uint32_t k = 0; k <= kSide; ++k) {
      const glm::vec3 point(static_cast<float>(i) / kSide, y, static_cast<float>(k) / kSide);
      mesh->positions.push_back(point);
      mesh->bounds.add(point);
    }
  for (std::uint32_t i = 0; i < kSide; ++i)
    for (std::uint32_t k = 0; k < kSide; ++k) {
      const std::uint32_t at = i * (kSide + 1) + k;
      for (const std::uint32_t corner : {at, at + 1, at + kSide + 1, at + 1, at + kSide + 2, at + kSide + 1})
        mesh->indices.push_back(corner);
    }
  REQUIRE(mesh->indices.size() / 3 >= MeshTrees::kLargeMesh);
  return mesh;
}

RenderList list_of(std::shared_ptr<const vrml::Mesh> mesh) {
  RenderList list;
  DrawItem item;
  item.mesh = std::move(mesh);
  list.items.push_back(std::move(item));
  return list;
}

}  // namespace

TEST_CASE("makes trees of large meshes only for callers that request them", "[optimised]") {
  MeshTrees trees;
  const auto first = floor_at(1), second = floor_at(2);
  trees.prepare(first);
  CHECK_FALSE(trees.find(first) == nullptr);  // the tree is not ready yet, because this is the first request
  trees.prepare(second);
  const auto tree = trees.find(second);
  CHECK(tree->ready);
  const auto hit = tree->tree->nearest(*second, {{0.4, 9, 0.6}, {0, -1, 0}});
  REQUIRE(hit);
  CHECK(hit->distance == Approx(7));
  CHECK(trees.find(second) != tree);  // only the caller that found the tree held it
  // Trees without recent requests are no longer made.
  MeshTrees idle;
  idle.ask();
  int made = 0;
  constexpr int kMeshes = 12;
  std::vector<std::shared_ptr<const vrml::Mesh>> meshes;
  for (int i = 0; i < kMeshes; ++i) {
    meshes.push_back(floor_at(static_cast<float>(i)));
    idle.prepare(meshes.back());
  }
  for (const auto& mesh : meshes) made += idle.find(mesh)->ready ? 1 : 0;
  CHECK(made > 0);
  CHECK(made < kMeshes);
}

TEST_CASE("finds the same nearest point before and after the tree of a large mesh is ready") {
  ItemBvh bvh;
  const RenderList list = list_of(floor_at(0));
  const glm::dvec3 lower(0.3, -0.1, 0.3), upper(0.32, 0.1, 0.32);
  const auto before = bvh.near(list, lower, upper, 10'000);
  CHECK(before.size() > 20);
  CHECK(before.size() < 100);
  ItemBvh prepared;
  prepared.trees()->ask();
  prepared.trees()->prepare(list.items[0].mesh);
  const auto after = prepared.near(list, lower, upper, 10'000);
  CHECK(prepared.bytes() > 0);  // the tree is ready
  REQUIRE(after.size() == before.size());
  const auto sum = [](const auto& triangles) {
    glm::dvec3 all(0);
    for (const WorldTriangle& one : triangles)
      for (const glm::dvec3& corner : one.corners) all += corner;
    return all;
  };
  const glm::dvec3 difference = sum(after) - sum(before);
  CHECK(std::abs(difference.x) + std::abs(difference.y) + std::abs(difference.z) < 1e-9);
}

TEST_CASE("meets the former mesh of an item until the tree of the new one is ready") {
  ItemBvh bvh;
  RenderList list = list_of(floor_at(0));
  const SightLine line{{0.4, 9, 0.6}, {0, -1, 0}};
  bvh.trees()->ask();
  bvh.trees()->prepare(list.items[0].mesh);
  REQUIRE(bvh.nearest(list, line));
  CHECK(bvh.nearest(list, line)->point.y == Approx(0));
  const auto next = floor_at(1);
  list.items[0].mesh = next;
  // While the new tree is made, rays hit one of the two floors at a correct point. Finally they hit the new floor.
  double y = 0;
  for (int i = 0; i < 100'000 && y != 1; ++i) {
    const auto hit = bvh.nearest(list, line);
    REQUIRE(hit);
    CHECK(std::abs(hit->normal.y) == Approx(1));
    y = hit->point.y;
    CHECK((y == 0 || y == 1));
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  CHECK(y == 1);
  CHECK(bvh.near(list, {0.3, 0.9, 0.3}, {0.32, 1.1, 0.32}, 1000).size() > 20);
}

TEST_CASE("returns trees at once that were made for an earlier caller") {
  ItemBvh bvh;
  const RenderList list = list_of(floor_at(2));
  bvh.prepare(list);
  for (int i = 0; i < 100'000 && bvh.bytes() == 0; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  CHECK(bvh.bytes() > 0);
  const auto hit = bvh.nearest(list, {{0.5, 9, 0.5}, {0, -1, 0}});
  REQUIRE(hit);
  CHECK(hit->point.y == Approx(2));
}

}  // namespace gs::render::mesh_trees_test
