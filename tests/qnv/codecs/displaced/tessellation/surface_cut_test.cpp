#include "qnv/codecs/displaced/tessellation/surface_cut.h"

#include "qnv/codecs/displaced/encode/encode_displaced.h"
#include "qnv/codecs/displaced/tessellation/patch_mesh.h"
#include "qnv/codecs/shared/encode_options.h"
#include "qnv/reader/stream_decoder.h"
#include "tests/geometries.h"
#include "tests/qnv/codecs/displaced/tessellation/patch_shapes.h"

#include <glm/geometric.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <set>
#include <span>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

namespace gs::qnv::surface_cut_test {
namespace {

using displaced::ball;
using displaced::mesh_of;
using displaced::sheet;
using displaced::torus;

using Place = std::tuple<float, float, float>;

/// Triangles of a cut, with vertices merged by position.
struct Drawn {
  std::vector<glm::vec3> places;
  std::map<Place, std::uint32_t> numbers;
  std::vector<std::array<std::uint32_t, 3>> triangles;

  Drawn(const SurfacePatches& surface, const SurfaceCut& cut) {
    PatchMesh mesh;
    for (const PatchCut& one : cut.patches) {
      mesh.build(*surface.parts[one.part], one);
      for (const auto& some : {mesh.inner(), mesh.border()})
        for (const PatchMesh::Triangle& t : some) {
          auto& made = triangles.emplace_back();
          for (std::size_t k = 0; k < 3; ++k) {
            const glm::vec3& p = mesh.vertices()[t[k]].position;
            const auto [found, fresh] =
                numbers.try_emplace(Place(p.x, p.y, p.z), static_cast<std::uint32_t>(places.size()));
            if (fresh) places.push_back(p);
            made[k] = found->second;
          }
        }
    }
  }
  [[nodiscard]] double area() const {
    double sum = 0;
    for (const auto& t : triangles)
      sum += 0.5 *
             glm::length(glm::cross(glm::dvec3(places[t[1]] - places[t[0]]), glm::dvec3(places[t[2]] - places[t[0]])));
    return sum;
  }
  [[nodiscard]] double volume() const {
    double sum = 0;
    for (const auto& t : triangles)
      sum += glm::dot(glm::dvec3(places[t[0]]), glm::cross(glm::dvec3(places[t[1]]), glm::dvec3(places[t[2]]))) / 6;
    return sum;
  }
};

LodView view_from(const glm::vec3& eye, float error_pixels) {
  LodView view;
  view.eye = eye;
  view.pixels = 500;
  view.error_pixels = error_pixels;
  return view;
}

}  // namespace

TEST_CASE("leaves no cracks between patches of mixed levels") {
  const std::array shapes{mesh_of(ball(2)), mesh_of(torus(6, 4)), mesh_of(sheet(8))};
  std::size_t mixed = 0;
  for (std::size_t which = 0; which < shapes.size(); ++which)
    for (const std::size_t creases : {0, 3}) {
      const SurfacePatches surface = patches_of(rough_surface(shapes[which], 4, creases), 4);
      for (const float error : {200.0f, 80.0f, 40.0f}) {
        INFO(which << " " << creases << " " << error);
        const SurfaceCut cut = cut_surface(surface, view_from({1.3f, 0.2f, 0.4f}, error));
        REQUIRE(cut.patches.size() == surface.parts[0]->size());
        std::set<int> levels;
        std::size_t rims = 0;
        for (const PatchCut& one : cut.patches) {
          levels.insert(one.level);
          for (std::size_t k = 0; k < 3; ++k)
            if (surface.parts[0]->edges()[surface.parts[0]->edge(one.patch, k)].other == displaced::kNone)
              rims += std::size_t{1} << one.edge_levels[k];
        }
        mixed += levels.size() > 1 ? 1 : 0;
        const Drawn drawn(surface, cut);
        std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides;
        for (const auto& t : drawn.triangles)
          for (std::size_t k = 0; k < 3; ++k) ++sides[{t[k], t[(k + 1) % 3]}];
        std::size_t alone = 0, twice = 0;
        for (const auto& [side, times] : sides) {
          twice += times > 1 ? 1 : 0;
          alone += sides.contains({side.second, side.first}) ? 0 : 1;
        }
        CHECK(twice == 0);
        CHECK(alone == rims);
      }
    }
  CHECK(mixed >= 12);
}

TEST_CASE("returns the surface itself for a cut that is fine everywhere") {
  const displaced::Surface surface = rough_surface(mesh_of(torus(6, 4)), 3);
  const SurfacePatches patches = patches_of(surface, 3);
  const SurfaceCut cut = cut_surface(patches, view_from({2, 0, 0}, 0.001f));
  const Drawn drawn(patches, cut);
  CHECK(drawn.triangles.size() == surface.triangles(3).size() / 3);
  const displaced::Frame frame(Box{glm::vec3(-1), glm::vec3(1)});
  std::size_t found = 0;
  for (const glm::vec3& place : surface.positions(3)) {
    const glm::vec3 p = frame.outside(place);
    found += drawn.numbers.contains(Place(p.x, p.y, p.z)) ? 1 : 0;
  }
  CHECK(found == surface.positions(3).size());
}

TEST_CASE("changes a surface without jumps through every level as patches come nearer", "[optimised]") {
  const SurfacePatches surface = patches_of(rough_surface(mesh_of(ball(2)), 4), 4);
  const auto drawn_at = [&](double error) {
    return Drawn(surface, cut_surface(surface, view_from({1.3f, 0.2f, 0.4f}, static_cast<float>(error))));
  };
  double greatest = 0, triangles = 0;
  Drawn before = drawn_at(600);
  const std::size_t first = before.triangles.size();
  for (double error = 600; error > 10; error *= 0.995) {
    Drawn now = drawn_at(error);
    greatest = std::max({greatest, std::abs(now.area() - before.area()) / before.area(),
                         std::abs(now.volume() - before.volume()) / before.volume()});
    triangles =
        std::max(triangles, static_cast<double>(now.triangles.size()) / static_cast<double>(before.triangles.size()));
    before = std::move(now);
  }
  CHECK(before.triangles.size() > 20 * first);
  CHECK(triangles > 1.05);  // levels would change in one step without the transition
  const double whole = std::abs(before.area() - drawn_at(600).area()) / before.area();
  CHECK(whole > 0.02);
  CHECK(greatest < whole / 50);
}

TEST_CASE("keeps the budget of a cut, and omits patches outside the view or facing away") {
  const SurfacePatches surface = patches_of(rough_surface(mesh_of(ball(4)), 4), 4);
  LodView view = view_from({3, 0, 0}, 0.5f);
  const SurfaceCut all = cut_surface(surface, view);
  const Drawn whole(surface, all);
  for (const std::size_t budget : {8000u, 4000u, 1500u}) {
    view.budget = budget;
    const SurfaceCut cut = cut_surface(surface, view);
    CHECK(cut.vertices <= budget);
    CHECK(cut.vertices > budget / 8);
    const Drawn drawn(surface, cut);
    CHECK(drawn.places.size() < budget + budget / 4);
    CHECK(drawn.triangles.size() < whole.triangles.size());
  }
  view.budget = 0;
  view.leave_backs = true;
  const SurfaceCut fronts = cut_surface(surface, view);
  CHECK(fronts.patches.size() < all.patches.size());
  // The cut omits no triangle that faces the viewer.
  std::set<std::uint32_t> taken;
  for (const PatchCut& one : fronts.patches) taken.insert(one.patch);
  PatchMesh mesh;
  std::size_t seen = 0;
  for (const PatchCut& one : all.patches) {
    if (taken.contains(one.patch)) continue;
    mesh.build(*surface.parts[0], one);
    for (const auto& some : {mesh.inner(), mesh.border()})
      for (const PatchMesh::Triangle& t : some) {
        const glm::vec3 a = mesh.vertices()[t[0]].position, b = mesh.vertices()[t[1]].position,
                        c = mesh.vertices()[t[2]].position;
        seen += glm::dot(glm::cross(b - a, c - a), view.eye - a) > 0 ? 1 : 0;
      }
  }
  CHECK(seen == 0);
  view.leave_backs = false;
  view.planes[0] = {0, 1, 0, 0};  // y >= 0
  for (const PatchCut& one : cut_surface(surface, view).patches) {
    const PatchSurface::Bounds& bounds = surface.parts[0]->bounds(one.patch);
    CHECK(bounds.center.y + bounds.radius > -0.001f);
  }
  CHECK(cut_surface(surface, view).patches.size() < all.patches.size());
}

TEST_CASE("draws every prefix of a stream as it is decoded") {
  const Triangles shape = displaced::sheet(48);
  const auto made = encode_displaced([&](const TriangleSink& sink) { return sink(shape); }, {});
  REQUIRE(std::holds_alternative<EncodedStream>(made));
  const std::vector<std::byte>& bytes = std::get<EncodedStream>(made).bytes;
  StreamDecoder decoder;
  SurfacePatches former;
  bool shares = false;
  std::size_t states = 0;
  for (std::size_t at = 0; at < bytes.size(); at += 300) {
    REQUIRE(decoder.push(std::span(bytes).subspan(at, std::min<std::size_t>(300, bytes.size() - at))));
    if (!decoder.header()) continue;
    const auto now = content_of<SurfacePatches>(decoder.geometry_to_draw());
    const auto whole = content_of<IndexedMesh>(decoder.geometry());
    CHECK(now.parts[0]->vertex_count() == whole.size());
    const Drawn drawn(now, even_cut(now, 1u << 30));
    CHECK(drawn.triangles.size() == whole.triangles.size() / 3);
    std::size_t found = 0;
    for (const glm::vec3& p : whole.positions) found += drawn.numbers.contains(Place(p.x, p.y, p.z)) ? 1 : 0;
    // Normals are added in another order, so their rounding differs.
    CHECK(found > 0);
    for (std::size_t i = 0; i < whole.size(); ++i) {
      const auto near = drawn.numbers.lower_bound(Place(whole.positions[i].x - 1e-5f, -9.0f, -9.0f));
      bool close = false;
      for (auto it = near; it != drawn.numbers.end() && std::get<0>(it->first) < whole.positions[i].x + 1e-5f; ++it)
        close = close || glm::length(drawn.places[it->second] - whole.positions[i]) < 1e-5f;
      REQUIRE(close);
    }
    if (!former.parts.empty() && former.parts[0]->level() == now.parts[0]->level())
      shares = shares || now.parts[0]->shared_bytes(*former.parts[0]) > 0;
    former = now;
    ++states;
  }
  CHECK(states > 3);
  CHECK(shares);
}

TEST_CASE("packs directions within a tenth of a degree") {
  for (const glm::vec3& v : {glm::vec3(1, 0, 0), glm::vec3(0, 0, -1), glm::normalize(glm::vec3(0.3f, -0.8f, 0.4f)),
                             glm::normalize(glm::vec3(-1, -1, -1))}) {
    const glm::vec3 back = unpack_direction(pack_direction(v));
    CHECK(glm::length(glm::normalize(back) - v) < 0.0018f);
    CHECK(glm::length(back) == Approx(1).margin(0.002));
  }
}

}  // namespace gs::qnv::surface_cut_test
