#include "qnv/codecs/octree/decode/cluster_forest.h"
#include "qnv/codecs/voxels/voxels.h"
#include "qnv/container/container.h"
#include "tests/qnv/pinned_vectors.h"

#include <catch2/catch.hpp>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <sstream>
#include <string>
#include <vector>

namespace gs::qnv {
namespace voxels_pinned_test {

TEST_CASE("decodes FORMAT.md's volume stream to the numbers in the document") {
  const std::vector<std::byte> stream = read_bytes("voxels_ball.qnv");
  const std::string expected = read_text("voxels_ball.txt");
  REQUIRE(expected.size() > 10'000);
  using Forest = ClusterForest<VolumeCluster>;
  Forest forest({read_volume_cluster_header, [](const VolumeCluster&, std::size_t, std::size_t count) {
                   return static_cast<std::uint32_t>(count);
                 }});
  StreamReader reader;
  REQUIRE(reader.push(stream, [&](ChunkType type, std::span<const std::byte> payload, std::uint64_t) {
    if (type != ChunkType::voxels) return;
    forest.add(payload, 1 << 20, [&](std::span<const std::byte> bytes, const VolumeCluster* parent) {
      return decode_volume_cluster(bytes, parent, reader.header()->lattice);
    });
  }));
  CHECK(forest.count().refused == 0);
  std::ostringstream shown;
  forest.visit_shown([&](const VolumeCluster& cluster, std::size_t first, std::size_t count) {
    const VolumeVoxels& v = cluster.voxels;
    for (std::size_t i = first; i < first + count; ++i)
      shown << cluster.level() << ' ' << v.x[i] << ' ' << v.y[i] << ' ' << v.z[i] << ' ' << v.u[i] << ' ' << v.v[i]
            << ' ' << int{v.value[i]} << ' ' << int{v.magnitude[i]} << '\n';
  });
  CHECK(shown.str() == expected);
}

TEST_CASE("matches a volume decoder that was written from FORMAT.md alone") {
  if (std::system("python3 -c pass >/dev/null 2>&1") != 0) {
    WARN("python3 is not here");
    return;
  }
  const std::string folder = GHOSTSPACE_TESTS "/qnv/vectors/";
  std::FILE* pipe = popen(("python3 '" + folder + "voxels_decode.py' '" + folder + "v1/voxels_ball.qnv'").c_str(), "r");
  REQUIRE(pipe);
  std::string output;
  char buffer[4096];
  for (std::size_t size = 0; (size = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;) output.append(buffer, size);
  CHECK(pclose(pipe) == 0);
  CHECK(output == read_text("voxels_ball.txt"));
}

}  // namespace voxels_pinned_test
}  // namespace gs::qnv
