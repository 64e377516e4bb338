#include "qnv/codecs/displaced/encode/base_mesh_prefetcher.h"

#include "qnv/mesh/simplify/simplify.h"
#include "tests/qnv/codecs/displaced/displaced_shapes.h"

#include <catch2/catch.hpp>

namespace gs::qnv::displaced::bases_ahead_test {

TEST_CASE("returns the same base mesh whether it was prepared in advance or not") {
  const SurfaceMesh mesh = mesh_of(ball(12));
  BaseMeshPrefetcher bases(mesh, GENERATE(0u, 1u, 2u));
  const auto same = [&](std::size_t triangles) {
    const SurfaceMesh made = bases.base(triangles), plain = simplify(mesh, triangles);
    return made.triangles == plain.triangles && made.positions == plain.positions;
  };
  CHECK(same(100));
  bases.expect(200);
  bases.expect(400);  // a second call is ignored while the first mesh is made
  CHECK(same(200));
  CHECK(same(400));
  bases.expect(300);
  CHECK(same(60));  // a number of triangles that was not expected
  CHECK(same(300));
  bases.expect(80);  // never requested
}

}  // namespace gs::qnv::displaced::bases_ahead_test
