#include "qnv/codecs/octree/decode/cluster_forest.h"
#include "qnv/codecs/octree/packed.h"
#include "qnv/codecs/octree/packed_layout.h"
#include "qnv/container/container.h"
#include "tests/qnv/pinned_vectors.h"

#include <catch2/catch.hpp>

#include <cstdint>
#include <span>
#include <sstream>
#include <string>
#include <vector>

namespace gs::qnv {
namespace packed_pinned_test {

TEST_CASE("decodes FORMAT.md's octree stream with neighbours to the numbers in the document") {
  const std::vector<std::byte> stream = read_bytes("packed_around.qnv");
  const std::string expected = read_text("packed_around.txt");
  REQUIRE(expected.size() > 10'000);
  ClusterForest<Cluster> forest({read_cluster_header, [](const Cluster& cluster, std::size_t first, std::size_t count) {
                                   return discs_of(cluster.voxels, first, count);
                                 }});
  StreamReader reader;
  std::size_t normals = 0, offsets = 0, colored = 0, doubles = 0;
  REQUIRE(reader.push(stream, [&](ChunkType type, std::span<const std::byte> payload, std::uint64_t) {
    if (type != ChunkType::packed) return;
    const ClusterParameters p = read_parameters(payload);
    normals += p.normals_around;
    offsets += p.offsets_around;
    colored += p.colored;
    doubles += p.doubles;
    forest.add(payload, 1 << 20,
               [&](std::span<const std::byte> bytes, const Cluster* parent) { return decode_cluster(bytes, parent); });
  }));
  CHECK(forest.count().refused == 0);
  CHECK(normals > 0);
  CHECK(offsets > 0);
  CHECK(colored > 0);
  CHECK(doubles > 0);
  std::ostringstream shown;
  forest.visit_shown([&](const Cluster& cluster, std::size_t first, std::size_t count) {
    const PackedVoxels& v = cluster.voxels;
    for (std::size_t i = first; i < first + count; ++i)
      shown << cluster.level() << ' ' << v.x[i] << ' ' << v.y[i] << ' ' << v.z[i] << ' ' << v.u[i] << ' ' << v.v[i]
            << ' ' << int{v.offset[i]} << ' ' << ((v.state[i] & kDouble) != 0 ? 1 : 0) << ' ' << v.luma[i] << ' '
            << v.co[i] << ' ' << v.cg[i] << '\n';
  });
  CHECK(shown.str() == expected);
}

TEST_CASE("matches an octree decoder that was written from FORMAT.md alone") {
  check_independent_decoder("packed_decode.py", "packed_around", read_text("packed_around.txt"));
}

}  // namespace packed_pinned_test
}  // namespace gs::qnv
