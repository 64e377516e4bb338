#include "qnv/codecs/displaced/tessellation/patch_evaluator.h"

#include "qnv/codecs/displaced/encode/stage_encode.h"
#include "tests/qnv/codecs/displaced/tessellation/patch_shapes.h"

#include <glm/geometric.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <cstddef>
#include <random>
#include <vector>

namespace gs::qnv::patch_evaluator_test {
namespace {

using displaced::ClusterHeader;
using displaced::mesh_of;
using displaced::Surface;

struct Made {
  ClusterHeader header;
  std::vector<std::byte> payload;
};

/// Returns all numbers of a surface, in clusters of a few patches, in any order.
std::vector<Made> clusters_of(Surface& surface, bool colored) {
  std::vector<Made> made;
  ClusterHeader header;
  for (header.level = 1; header.level <= surface.header().depth; ++header.level)
    for (header.first = 0; header.first < surface.patches().size(); header.first += 7) {
      header.count = std::min<std::uint32_t>(7, surface.patches().size() - header.first);
      for (header.layer = 0; header.layer < 2; ++header.layer) made.push_back({header, {}});
      header.layer = 0;
      if (!colored) continue;
      made.push_back({header, {}});
      made.back().header.kind = ClusterHeader::Kind::color;
    }
  for (Made& one : made) one.payload = displaced::encode_cluster(surface, one.header);
  std::shuffle(made.begin(), made.end(), std::mt19937(3));
  return made;
}

/// Counts vertices of different positions (beyond rounding), normals or colours.
std::size_t differences(const PatchSurface& a, const PatchSurface& b) {
  REQUIRE(a.level() == b.level());
  REQUIRE(a.size() == b.size());
  REQUIRE(a.colored() == b.colored());
  std::size_t count = 0;
  for (std::size_t p = 0; p < a.size(); ++p) {
    for (int l = 0; l <= a.level(); ++l)
      for (std::size_t i = 0; i < new_patch_vertices(l); ++i) {
        const PatchVertex &x = a.vertices(p, l)[i], &y = b.vertices(p, l)[i];
        const bool near = glm::length(x.position - y.position) < 2e-5f &&
                          glm::length(unpack_direction(x.normal) - unpack_direction(y.normal)) < 0.01f;
        count += near && (!a.colored() || a.colors(p, l)[i] == b.colors(p, l)[i]) ? 0 : 1;
      }
    count += glm::length(a.bounds(p).center - b.bounds(p).center) < 1e-4f ? 0 : 1;
  }
  return count;
}

}  // namespace

TEST_CASE("evaluates a surface gradually to the result of evaluating it at once") {
  for (int which = 0; which < 3; ++which)
    for (const std::size_t creases : {0, 3}) {
      INFO(which << " " << creases);
      const bool colored = which == 1;
      Surface source = rough_surface(mesh_of(which == 0   ? displaced::ball(2)
                                             : which == 1 ? displaced::torus(6, 4)
                                                          : displaced::sheet(8)),
                                     3, creases, colored);
      std::mt19937 random(5);
      for (int level = 0; level <= 3; ++level) {
        displaced::NumberArray& finer = source.numbers(1, level).normal;
        for (std::size_t v = 0; v < finer.size(); ++v) finer[v] = static_cast<std::int16_t>(random() % 7) - 3;
      }
      Surface surface(source.header());
      const Box box{glm::vec3(-1), glm::vec3(1)};
      PatchEvaluator evaluator;
      CHECK(differences(*evaluator.state(surface, 1, box), *patch_surface(surface, 1, box)) == 0);
      std::size_t fewest = 1000, states = 0;
      int level = 1;
      for (const Made& made : clusters_of(source, colored)) {
        REQUIRE(surface.add(*displaced::decode_cluster_header(made.payload), made.payload));
        if (made.header.kind == ClusterHeader::Kind::color)
          evaluator.colors_changed();
        else
          evaluator.changed(made.header, surface.patches().size());
        if (++states % 3 != 0) continue;
        level = std::max(level, std::min(surface.finest() + 1, 3));
        const auto now = evaluator.state(surface, level, box);
        fewest = std::min(fewest, evaluator.worked_out());
        CHECK(differences(*now, *patch_surface(surface, level, box)) == 0);
        const auto again = evaluator.state(surface, level, box);
        CHECK(evaluator.worked_out() == 0);
        CHECK(again->shared_bytes(*now) >= again->size() * patch_vertices(level) * sizeof(PatchVertex));
      }
      CHECK(fewest < 3 * surface.patches().size());
    }
}

}  // namespace gs::qnv::patch_evaluator_test
