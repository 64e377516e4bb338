#include "qnv/codecs/displaced/encode/stage_encode.h"

#include "qnv/codecs/displaced/encode/error_cells.h"
#include "qnv/mesh/simplify/simplify.h"
#include "tests/qnv/codecs/displaced/displaced_shapes.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cstddef>

namespace gs::qnv::displaced::stage_encode_test {
namespace {

/// Returns a ball in the middle of the box.
SurfaceMesh ball_at(float radius, const glm::vec3& center, int n) {
  SurfaceMesh mesh = mesh_of(ball(n));
  for (glm::vec3& p : mesh.positions) p = center + radius * p;
  return mesh;
}

SurfaceMesh together(const SurfaceMesh& a, const SurfaceMesh& b) {
  SurfaceMesh both = a;
  const auto first = static_cast<std::uint32_t>(a.positions.size());
  both.positions.insert(both.positions.end(), b.positions.begin(), b.positions.end());
  both.normals.insert(both.normals.end(), b.normals.begin(), b.normals.end());
  for (const Corners& t : b.triangles) both.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  return both;
}

int finest_of(const EncodedStage& stage) {
  int finest = 0;
  for (const StageCluster& cluster : stage.clusters) finest = std::max(finest, cluster.header.level);
  return finest;
}

}  // namespace

TEST_CASE("omits the finest levels only of a stage that another one certainly follows") {
  const SurfaceMesh large = ball_at(0.3f, {0.4f, 0.5f, 0.5f}, 40), small = ball_at(0.08f, {0.85f, 0.5f, 0.5f}, 12);
  const SurfaceMesh both = together(large, small);
  const SurfaceMesh coarse = simplify(large, 400);
  StageOptions options;
  options.triangles = 20;
  options.layers = 1;
  options.threads = 2;
  // The small ball of the target is far from the surface of the stage.
  const Target target(both, neighbours_of(both.triangles), 2), alone(large, neighbours_of(large.triangles), 2);
  const float error = 0.045f * target.edge();
  const EncodedStage whole = encode_stage_of(target, coarse, options, nullptr);
  REQUIRE(whole.header.depth > 4);
  CHECK(finest_of(whole) == whole.header.depth);
  CHECK(whole.error > error);
  options.most_error = error;
  options.trusted_error = 1;
  const EncodedStage shorter = encode_stage_of(target, coarse, options, nullptr);
  CHECK(shorter.header.depth == whole.header.depth);
  CHECK(finest_of(shorter) == 4);
  CHECK(shorter.error > error);
  // The shorter stage has the same clusters as the whole stage.
  std::size_t same = 0;
  for (const StageCluster& cluster : shorter.clusters)
    same += std::any_of(whole.clusters.begin(), whole.clusters.end(), [&](const StageCluster& other) {
      return other.header.level == cluster.header.level && other.payload == cluster.payload;
    });
  CHECK(same == shorter.clusters.size());
  // The stage keeps all levels in three cases: its error is too large, it follows the whole target, or no further stage
  // is possible.
  options.trusted_error = error;
  CHECK(finest_of(encode_stage_of(target, coarse, options, nullptr)) == whole.header.depth);
  options.trusted_error = 1;
  CHECK(finest_of(encode_stage_of(alone, coarse, options, nullptr)) == whole.header.depth);
  const SurfaceMesh coarsest = simplify(large, 60);
  CHECK(finest_of(encode_stage_of(target, coarsest, options, nullptr)) == whole.header.depth);
}

TEST_CASE("finds error cells from up to one side length away") {
  const ErrorCells cells(0.1f, 7);
  std::size_t missed = 0, found = 0;
  for (int x = 0; x < 40; ++x)
    for (int y = 0; y < 40; ++y) {
      const glm::vec3 p(0.0251f * static_cast<float>(x), 0.0251f * static_cast<float>(y), 0.33f);
      if (!cells.has(p)) continue;
      ++found;
      for (const float reach : {0.04f, 0.1f})
        for (const glm::vec3& way : {glm::vec3(1, 0, 0), glm::vec3(-1, 1, 0), glm::vec3(0.3f, -0.7f, 1)})
          missed += cells.near(p + 0.99f * reach * way, reach) ? 0 : 1;
    }
  CHECK(found > 50);
  CHECK(missed == 0);
}

}  // namespace gs::qnv::displaced::stage_encode_test
