#include "app/insitu/arrays/particle_parts.h"
#include "tests/app/insitu/insitu_helpers.h"
#include "tests/app/insitu/thread_ranks.h"

#include <glm/geometric.hpp>

#include <cmath>

namespace gs::app::insitu {
namespace particle_parts_test {

using namespace test;

TEST_CASE("in situ particles: all ranks' particles are in the stream, within a quarter of their radius") {
  const ScratchFolder scratch;
  const std::string folder = scratch.path("out");
  constexpr int kEach = 300;
  std::vector<glm::dvec3> all;
  for (int i = 0; i < 2 * kEach; ++i) {
    const double k = i + 0.5;
    all.emplace_back(std::fmod(k * 0.819, 1), std::fmod(k * 0.671, 1), std::fmod(k * 0.5497, 1));
  }
  constexpr double kRadius = 0.02;
  ThreadRanks::run(2, [&](int rank, const gs_insitu_communicator& table) {
    gs_insitu_options options = plain_options();
    options.folder = folder.c_str();
    Session session(gs_insitu_open(&options, &table, nullptr, 0));
    std::vector<double> positions;
    std::vector<std::int32_t> ids;
    for (int i = rank * kEach; i < (rank + 1) * kEach; ++i) {
      const glm::dvec3& at = all[static_cast<std::size_t>(i)];
      positions.insert(positions.end(), {at.x, at.y, at.z});
      ids.push_back(i);
    }
    gs_insitu_field field{};
    field.name = "id";
    field.data = ids.data();
    field.type = GS_INSITU_INT32;
    gs_insitu_particles particles{};
    particles.size = sizeof particles;
    particles.positions = positions.data();
    particles.position_type = GS_INSITU_FLOAT64;
    particles.count = kEach;
    particles.radius = kRadius;
    particles.fields = &field;
    particles.field_count = 1;
    if (gs_insitu_begin_step(session.get(), 4, 0) != GS_INSITU_OK) return;
    (void)gs_insitu_pass_particles(session.get(), &particles);
    (void)gs_insitu_end_step(session.get());
  });
  const std::vector<std::byte> bytes = bytes_of_text(scratch.read("out/id-particles.000004.qnv"));
  const qnv::DecodedStream decoded = qnv::decode_stream(bytes, 1 << 20);
  const auto* geometry = std::get_if<qnv::Geometry>(&decoded.content);
  REQUIRE(geometry);
  const auto* splats = geometry->as<qnv::Gaussians>();
  REQUIRE(splats);
  CHECK(splats->size() == all.size());
  double farthest = 0;
  for (const glm::dvec3& at : all) {
    double nearest = INFINITY;
    for (const glm::vec3& found : splats->positions) {
      const glm::dvec3 apart = glm::abs(geometry->description().origin + glm::dvec3(found) - at);
      nearest = std::min(nearest, std::max({apart.x, apart.y, apart.z}));
    }
    farthest = std::max(farthest, nearest);
  }
  CHECK(farthest <= kParticleError * kRadius);
}

TEST_CASE("in situ particles: particles without finite positions are left out") {
  const ScratchFolder scratch;
  const std::string folder = scratch.path("out");
  gs_insitu_options options = plain_options();
  options.folder = folder.c_str();
  const Session session = opened(options);
  const float positions[] = {0, 0, 0, NAN, 1, 1, 2, 2, 2};
  gs_insitu_particles particles{};
  particles.size = sizeof particles;
  particles.positions = positions;
  particles.position_type = GS_INSITU_FLOAT32;
  particles.count = 3;
  REQUIRE(gs_insitu_begin_step(session.get(), 0, 0) == GS_INSITU_OK);
  REQUIRE(gs_insitu_pass_particles(session.get(), &particles) == GS_INSITU_OK);
  particles.radius = -1;
  CHECK(gs_insitu_pass_particles(session.get(), &particles) == GS_INSITU_INVALID);
  REQUIRE(gs_insitu_end_step(session.get()) == GS_INSITU_OK);
  const std::vector<std::byte> bytes = bytes_of_text(scratch.read("out/particles.000000.qnv"));
  const qnv::DecodedStream decoded = qnv::decode_stream(bytes, 1 << 20);
  const auto* geometry = std::get_if<qnv::Geometry>(&decoded.content);
  REQUIRE(geometry);
  CHECK(geometry->size() == 2);
}

}  // namespace particle_parts_test
}  // namespace gs::app::insitu
