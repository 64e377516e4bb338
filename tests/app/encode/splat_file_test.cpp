#include "app/encode/splat_file.h"

#include "app/formats/export/export.h"
#include "app/formats/splats/splats.h"
#include "qnv/codecs/gaussians/encode/gaussians_stream.h"
#include "tests/app/geometry_shapes.h"
#include "tests/qnv/thread_ranks.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <random>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <variant>
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

using Bytes = std::vector<std::byte>;

constexpr std::size_t kMany = 70'001;  // more than two pieces of a file; the last chunk of 256 is not full

template <class Value>
void append(Bytes& bytes, const Value& value) {
  const auto* const from = reinterpret_cast<const std::byte*>(&value);
  bytes.insert(bytes.end(), from, from + sizeof value);
}

/// Returns a .splat file. Some splats are too faint or broken.
Bytes splat_records(std::size_t count) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> even(-1, 1);
  Bytes bytes;
  for (std::size_t i = 0; i < count; ++i) {
    for (int k = 0; k < 3; ++k) append(bytes, even(random) * 20);
    for (int k = 0; k < 3; ++k)
      append(bytes, i % 1000 == 7 ? std::numeric_limits<float>::quiet_NaN() : 0.3f + 0.2f * even(random));
    for (int k = 0; k < 8; ++k) append(bytes, static_cast<std::uint8_t>(random()));
  }
  return bytes;
}

/// Returns a compressed PLY file with random numbers, with harmonics of degree 0 or 1.
Bytes compressed_ply(std::size_t count, bool harmonics) {
  std::mt19937 random(2);
  const std::size_t chunks = (count + 255) / 256;
  std::string header = "ply\nformat binary_little_endian 1.0\nelement chunk " + std::to_string(chunks) + "\n";
  for (const char* name : {"min_x", "min_y", "min_z", "max_x", "max_y", "max_z", "min_scale_x", "min_scale_y",
                           "min_scale_z", "max_scale_x", "max_scale_y", "max_scale_z"})
    header += std::string("property float ") + name + "\n";
  header += "element vertex " + std::to_string(count) + "\n";
  for (const char* name : {"packed_position", "packed_rotation", "packed_scale", "packed_color"})
    header += std::string("property uint ") + name + "\n";
  if (harmonics) {
    // Has fewer rows than splats, so the last splats have no harmonics.
    header += "element sh " + std::to_string(count - 100) + "\n";
    for (int k = 0; k < 9; ++k) header += "property uchar f_rest_" + std::to_string(k) + "\n";
  }
  header += "end_header\n";
  Bytes bytes(header.size());
  std::memcpy(bytes.data(), header.data(), header.size());
  for (std::size_t i = 0; i < chunks; ++i) {
    const auto place = static_cast<float>(i) * 0.1f;
    for (const float number : {place, -1.0f, -1.0f, place + 1, 1.0f, 1.0f, -6.0f, -6.0f, -6.0f, -2.0f, -2.0f, -2.0f})
      append(bytes, number);
  }
  for (std::size_t i = 0; i < 4 * count; ++i) append(bytes, static_cast<std::uint32_t>(random()));
  if (harmonics)
    for (std::size_t i = 0; i < 9 * (count - 100); ++i) append(bytes, static_cast<std::uint8_t>(random()));
  return bytes;
}

/// Returns all splats of a source.
qnv::Gaussians joined(const qnv::GaussianSource& source) {
  qnv::Gaussians all;
  all.degree = source.degree;
  const auto add = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  CHECK(source.read([&](const qnv::Gaussians& piece) {
    add(all.positions, piece.positions);
    add(all.scales, piece.scales);
    add(all.rotations, piece.rotations);
    add(all.opacities, piece.opacities);
    add(all.bases, piece.bases);
    add(all.harmonics, piece.harmonics);
    return true;
  }));
  return all;
}

/// Compares a file that is read in pieces with its import.
void check_pieces(const std::string& name, const Bytes& bytes, const ImportedVectors& imported) {
  INFO(name);
  REQUIRE(std::holds_alternative<qnv::Gaussians>(imported));
  const auto& whole = std::get<qnv::Gaussians>(imported);
  std::vector<std::size_t> released;
  const auto file = open_splat_file(name, bytes, 1000, [&](std::size_t end) { released.push_back(end); });
  REQUIRE(file);
  CHECK(released.size() == 3);
  CHECK(std::ranges::is_sorted(released));
  CHECK(released.back() <= bytes.size());
  CHECK(released.back() > bytes.size() - 100);
  const qnv::GaussianSource& source = file->source;
  CHECK(source.count == whole.size());
  CHECK(source.base.description.metadata == whole.description.metadata);
  CHECK(source.base.description.total == whole.description.total);
  CHECK(source.base.description.origin == whole.description.origin);
  CHECK(source.base.description.box.lower == whole.description.box.lower);
  CHECK(source.base.description.box.upper == whole.description.box.upper);
  const qnv::Gaussians all = joined(source);
  CHECK(all.degree == whole.degree);
  CHECK(all.positions == whole.positions);
  CHECK(all.scales == whole.scales);
  CHECK(all.rotations == whole.rotations);
  CHECK(all.opacities == whole.opacities);
  CHECK(all.bases == whole.bases);
  CHECK(all.harmonics == whole.harmonics);
}

}  // namespace

TEST_CASE("ranks that share a file of splats get the survey of one process") {
  const std::string text = splats_ply(100'000);
  qnv::Ranks alone;
  const auto whole = survey_splats("scene.ply", splat_bytes(text), 1000, {}, alone);
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
          surveys[rank] = survey_splats("scene.ply", splat_bytes(text), 1000, {}, ranks);
        });
    }
    for (const auto& survey : surveys) {
      REQUIRE(survey);
      CHECK(equal(*survey, *whole));
    }
  }
  const auto opened = open_splat_file("scene.ply", splat_bytes(text), 1000),
             known = open_splat_file("scene.ply", splat_bytes(text), 1000, {}, &*whole);
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
        surveys[rank] =
            survey_splats("scene.ply", rank == 0 ? splat_bytes(text) : std::span<const std::byte>(), 1000, {}, ranks);
      });
  }
  CHECK_FALSE(surveys[0]);
  CHECK_FALSE(surveys[1]);
}

TEST_CASE("ends the survey on all ranks if one rank runs out of memory") {
  const std::string text = splats_ply(100'000);
  for (const std::uint32_t failing : {0u, 2u}) {
    qnv::SharedMemory state(3);
    std::vector<std::optional<SplatSurvey>> surveys(3);
    {
      std::vector<std::jthread> threads;
      for (std::uint32_t rank = 0; rank < 3; ++rank)
        threads.emplace_back([&, rank] {
          qnv::ThreadRanks ranks(state, rank);
          const PutAside put_aside = [&](std::size_t) {
            if (rank == failing) throw std::bad_alloc();
          };
          surveys[rank] = survey_splats("scene.ply", splat_bytes(text), 1000, put_aside, ranks);
        });
    }
    for (const auto& survey : surveys) CHECK_FALSE(survey);
  }
}

TEST_CASE("the runs of a file of splats have the splats of the whole file") {
  const std::string text = splats_ply(70'000);
  const auto file = open_splat_file("scene.ply", splat_bytes(text), 1000);
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

TEST_CASE("reads the same splats in pieces as at once, from .splat and from PLY with and without compression") {
  const Bytes records = splat_records(kMany);
  check_pieces("scene.splat", records, import_splats_antimatter(records));
  for (const bool harmonics : {false, true}) {
    const Bytes compressed = compressed_ply(kMany, harmonics);
    check_pieces("scene.ply", compressed, import_splats_compressed_ply(compressed));
  }
  const auto made = export_splats_ply(test::random_gaussians(kMany, 1));
  const Bytes& ply = std::get<Bytes>(made);
  check_pieces("scene.ply", ply, import_splats_ply(ply));
}

TEST_CASE("encodes splats in pieces to the same stream as at once") {
  const Bytes records = splat_records(3000), compressed = compressed_ply(3000, true);
  qnv::EncodeOptions options;
  options.part_splats = 1000;
  const auto check = [&](const std::string& name, const Bytes& bytes, const ImportedVectors& imported) {
    INFO(name);
    const auto file = open_splat_file(name, bytes, 2000);
    REQUIRE(file);
    const auto in_pieces = qnv::encode_gaussians(file->source, options);
    const auto at_once = qnv::encode_gaussians(std::get<qnv::Gaussians>(imported), options);
    REQUIRE(std::holds_alternative<qnv::EncodedStream>(in_pieces));
    CHECK(std::get<qnv::EncodedStream>(in_pieces).bytes == std::get<qnv::EncodedStream>(at_once).bytes);
  };
  check("scene.splat", records, import_splats_antimatter(records));
  check("scene.ply", compressed, import_splats_compressed_ply(compressed));
}

TEST_CASE("opens only complete large files of splats in pieces") {
  const Bytes records = splat_records(100);
  CHECK_FALSE(open_splat_file("scene.splat", records, 100));
  CHECK(open_splat_file("scene.splat", records, 99));
  CHECK_FALSE(open_splat_file("scene.bin", records, 0));
  CHECK_FALSE(open_splat_file("scene.splat", std::span(records).first(31), 0));
  const Bytes compressed = compressed_ply(1000, true);
  for (std::size_t cut = 0; cut < compressed.size(); cut += 61) {
    const auto part = std::span(compressed).first(cut);
    const auto file = open_splat_file("scene.ply", part, 0);
    const ImportedVectors imported = import_splats_compressed_ply(part);
    REQUIRE(file.has_value() == std::holds_alternative<qnv::Gaussians>(imported));
    if (!file) continue;
    const auto& whole = std::get<qnv::Gaussians>(imported);
    REQUIRE(file->source.count == whole.size());
    REQUIRE(file->source.base.description.metadata == whole.description.metadata);
    REQUIRE(joined(file->source).harmonics == whole.harmonics);
  }
}

}  // namespace gs::app::splat_file_test
