#include "app/encode/splat_file.h"

#include "tests/qnv/thread_ranks.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <cstring>
#include <span>
#include <string>
#include <thread>
#include <vector>

namespace gs::app::splat_file_test {
namespace {

/// Returns a 3DGS PLY file. Every tenth splat is too faint to be visible.
std::string splats_ply(std::size_t count) {
  std::string text = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(count) + "\n";
  for (const char* name : {"x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0", "scale_1", "scale_2",
                           "rot_0", "rot_1", "rot_2", "rot_3"})
    text += std::string("property float ") + name + "\n";
  text += "end_header\n";
  const std::size_t head = text.size();
  text.resize(head + count * 14 * sizeof(float));
  for (std::size_t i = 0; i < count; ++i) {
    const auto t = static_cast<float>(i) * 0.001f;
    const float row[14] = {std::sin(t),
                           std::cos(3 * t),
                           t,
                           0.1f,
                           std::sin(7 * t),
                           0.4f,
                           i % 10 == 3 ? -20.0f : 1.0f,
                           -4,
                           -4.5f,
                           -6,
                           1,
                           0.1f,
                           0,
                           0};
    std::memcpy(text.data() + head + i * sizeof row, row, sizeof row);
  }
  return text;
}

std::span<const std::byte> splat_bytes(const std::string& text) { return std::as_bytes(std::span(text)); }

bool equal(const SplatSurvey& a, const SplatSurvey& b) {
  const auto same_run = [](const SplatSurvey::Run& p, const SplatSurvey::Run& q) {
    return p.splats == q.splats && p.area == q.area;
  };
  return std::ranges::equal(a.runs, b.runs, same_run) && a.degree == b.degree && a.antialiased == b.antialiased &&
         a.two_sided == b.two_sided && a.box == b.box && a.metadata == b.metadata;
}

}  // namespace

TEST_CASE("ranks that share a file of splats get the survey of one process") {
  const std::string text = splats_ply(100'000);
  qnv::Ranks alone;
  const auto whole = survey_splats(splat_bytes(text), 1000, {}, alone);
  REQUIRE(whole);
  CHECK(whole->runs.size() == 4);
  for (const std::uint32_t count : {2u, 3u, 6u}) {
    qnv::SharedMemory state(count);
    std::vector<std::optional<SplatSurvey>> surveys(count);
    {
      std::vector<std::jthread> threads;
      for (std::uint32_t rank = 0; rank < count; ++rank)
        threads.emplace_back([&, rank] {
          qnv::ThreadRanks ranks(state, rank);
          surveys[rank] = survey_splats(splat_bytes(text), 1000, {}, ranks);
        });
    }
    for (const auto& survey : surveys) {
      REQUIRE(survey);
      CHECK(equal(*survey, *whole));
    }
  }
  const auto opened = open_splat_file(splat_bytes(text), 1000),
             known = open_splat_file(splat_bytes(text), 1000, {}, &*whole);
  REQUIRE(opened);
  REQUIRE(known);
  CHECK(opened->source.count == 90'000);
  CHECK(known->source.count == 90'000);
  CHECK(known->source.base.description == opened->source.base.description);
}

TEST_CASE("no rank has a survey if one rank cannot open the file of splats") {
  const std::string text = splats_ply(40'000);
  qnv::SharedMemory state(2);
  std::vector<std::optional<SplatSurvey>> surveys(2);
  {
    std::vector<std::jthread> threads;
    for (std::uint32_t rank = 0; rank < 2; ++rank)
      threads.emplace_back([&, rank] {
        qnv::ThreadRanks ranks(state, rank);
        surveys[rank] = survey_splats(rank == 0 ? splat_bytes(text) : std::span<const std::byte>(), 1000, {}, ranks);
      });
  }
  CHECK_FALSE(surveys[0]);
  CHECK_FALSE(surveys[1]);
}

TEST_CASE("the runs of a file of splats have the splats of the whole file") {
  const std::string text = splats_ply(70'000);
  const auto file = open_splat_file(splat_bytes(text), 1000);
  REQUIRE(file);
  const qnv::GaussianSource& source = file->source;
  std::vector<glm::vec3> whole, runs;
  CHECK(source.read([&](const qnv::Gaussians& some) {
    whole.insert(whole.end(), some.positions.begin(), some.positions.end());
    return true;
  }));
  REQUIRE(source.runs.size() == 3);
  for (std::uint64_t run = 0; run < source.runs.size(); ++run) {
    const std::size_t before = runs.size();
    CHECK(source.read_run(run, [&](const qnv::Gaussians& some) {
      runs.insert(runs.end(), some.positions.begin(), some.positions.end());
      return true;
    }));
    CHECK(runs.size() - before == source.runs[run]);
  }
  CHECK(whole == runs);
  CHECK(whole.size() == source.count);
}

}  // namespace gs::app::splat_file_test
