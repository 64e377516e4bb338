#include "qnv/exact/tail_pieces.h"
#include "tests/qnv/exact/exact_shapes.h"
#include "tests/qnv/pinned_vectors.h"
#include "tests/watched.h"

#include <catch2/catch.hpp>

#include <fstream>
#include <sstream>

namespace gs::qnv::exact::vectors_test {

// tests/qnv/vectors/v1/displaced_exact.qnv is a stream as encode_displaced wrote it once; the .txt beside it is what
// tests/qnv/vectors/displaced.py, written from FORMAT.md alone, made of it. Neither may ever be made again.
TEST_CASE("the exact tail of the first version decodes to its pinned mesh") {
  ExactMesh wanted;
  std::ifstream in(GHOSTSPACE_TESTS "/qnv/vectors/v1/displaced_exact.txt");
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string kind;
    words >> kind;
    if (kind == "exact") {
      words >> wanted.bits >> wanted.crease_angle;
    } else if (kind == "at") {
      glm::ivec3 p(0), c(0);
      words >> p.x >> p.y >> p.z >> c.x >> c.y >> c.z;
      wanted.vertices.push_back(p);
      wanted.colors.push_back({static_cast<std::uint8_t>(c.x), static_cast<std::uint8_t>(c.y),
                               static_cast<std::uint8_t>(c.z)});
    } else if (kind == "face") {
      displaced::Corners t{};
      words >> t[0] >> t[1] >> t[2];
      wanted.triangles.push_back(t);
    }
  }
  REQUIRE(wanted.triangles.size() > 500);
  const std::vector<std::byte> stream = read_bytes("displaced_exact.qnv");
  TailPieces pieces;
  StreamReader reader;
  REQUIRE(reader.push(stream, [&](ChunkType type, std::span<const std::byte> payload, std::uint64_t) {
    if (type == ChunkType::exact) CHECK(pieces.add(payload));
  }));
  const auto tail = pieces.take();
  REQUIRE(tail);
  const auto mesh = decode_tail(*tail, 1 << 16);
  REQUIRE(mesh);
  CHECK(mesh->bits == wanted.bits);
  CHECK(mesh->crease_angle == wanted.crease_angle);
  CHECK(mesh->vertices == wanted.vertices);
  CHECK(mesh->triangles == wanted.triangles);
  REQUIRE(mesh->colors.size() == wanted.colors.size());
  for (std::size_t v = 0; v < mesh->colors.size(); ++v) REQUIRE_EACH(mesh->colors[v] == wanted.colors[v]);
}

}  // namespace gs::qnv::exact::vectors_test
