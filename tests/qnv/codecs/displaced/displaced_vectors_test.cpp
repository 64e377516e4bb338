#include "qnv/codecs/displaced/surface.h"
#include "qnv/container/piece_group.h"
#include "qnv/reader/stream_decoder.h"
#include "tests/geometries.h"
#include "tests/qnv/pinned_vectors.h"
#include "tests/watched.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace gs::qnv::displaced::vectors_test {
namespace {

/// Data of a stage, as tests/qnv/vectors/displaced.py prints them.
struct Told {
  int depth = 0, step_exponent = 0, colored = 0, clusters = 0, bits = 0;
  std::vector<glm::ivec3> vertices;
  std::vector<Corners> triangles;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> creases;
  std::map<std::string, std::map<std::size_t, int>> numbers;  // by kind, layer, level
};
struct ToldStream {
  std::map<int, Told> stages;
  std::map<std::size_t, glm::dvec3> places;
  std::map<std::size_t, glm::ivec3> colors;
};

ToldStream told(const std::string& name) {
  ToldStream all;
  Told* stage = nullptr;
  std::ifstream in(GHOSTSPACE_TESTS "/qnv/vectors/v1/" + name);
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string kind;
    words >> kind;
    if (kind == "stage") {
      int number = 0;
      words >> number;
      stage = &all.stages[number];
      words >> stage->depth >> stage->step_exponent >> stage->colored >> stage->clusters >> stage->bits;
    } else if (kind == "vertex") {
      glm::ivec3 v(0);
      words >> v.x >> v.y >> v.z;
      stage->vertices.push_back(v);
    } else if (kind == "triangle") {
      Corners t{};
      words >> t[0] >> t[1] >> t[2];
      stage->triangles.push_back(t);
    } else if (kind == "crease") {
      std::pair<std::uint32_t, std::uint32_t> ends;
      words >> ends.first >> ends.second;
      stage->creases.push_back(ends);
    } else if (kind == "numbers") {
      std::string of, layer, level;
      words >> of >> layer >> level;
      auto& numbers = stage->numbers[of + " " + layer + " " + level];
      std::size_t vertex = 0;
      for (int value = 0; words >> vertex >> value;) numbers[vertex] = value;
    } else if (kind == "place") {
      std::size_t vertex = 0;
      words >> vertex;
      glm::dvec3& p = all.places[vertex];
      words >> p.x >> p.y >> p.z;
    } else if (kind == "colour") {
      std::size_t vertex = 0;
      words >> vertex;
      glm::ivec3& c = all.colors[vertex];
      words >> c.x >> c.y >> c.z;
    }
  }
  return all;
}

std::map<std::size_t, int> not_zero(const NumberArray& numbers, std::size_t from = 0) {
  std::map<std::size_t, int> out;
  for (std::size_t i = 0; i < numbers.size(); ++i)
    if (numbers[i] != 0) out[i + from] = numbers[i];
  return out;
}

void check_stage(Surface& surface, Told wanted) {
  const StageHeader& header = surface.header();
  CHECK(header.depth == wanted.depth);
  CHECK(header.step_exponent == wanted.step_exponent);
  CHECK(header.colored == (wanted.colored != 0));
  CHECK(header.clusters == wanted.clusters);
  CHECK(header.base.bits == wanted.bits);
  CHECK(header.base.vertices == wanted.vertices);
  CHECK(header.base.triangles == wanted.triangles);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> creases;
  for (const Patches::Edge& edge : surface.patches().edges())
    if (edge.crease) creases.emplace_back(edge.from, edge.to);
  CHECK(creases == wanted.creases);
  for (int level = 0; level <= header.depth; ++level) {
    const std::string at = " " + std::to_string(level);
    for (int layer = 0; layer < kLayers; ++layer) {
      LevelNumbers& numbers = surface.numbers(layer, level);
      const std::string of = " " + std::to_string(layer) + at;
      CHECK(not_zero(numbers.normal) == wanted.numbers["n" + of]);
      CHECK(not_zero(numbers.sideways, surface.patches().base_vertices()) == wanted.numbers["s" + of]);
    }
    for (std::size_t c = 0; c < 3; ++c)
      CHECK(not_zero(surface.colors(level)[c]) == wanted.numbers[std::to_string(c) + " 0" + at]);
  }
}

}  // namespace

// encode_displaced once wrote tests/qnv/vectors/v1/displaced_*.qnv. tests/qnv/vectors/displaced.py, written from
// FORMAT.md alone, made the .txt files. Never regenerate either.
TEST_CASE("decodes displaced streams of version 1 to their pinned numbers") {
  for (const std::string name : {"displaced_fold", "displaced_stages", "displaced_pieces"}) {
    INFO(name);
    const std::vector<std::byte> bytes = read_bytes(name + ".qnv");
    const ToldStream wanted = told(name + ".txt");
    REQUIRE(bytes.size() > 1000);
    REQUIRE(wanted.stages.size() == (name == "displaced_fold" ? 1 : 2));
    std::map<int, Surface> stages;
    StreamReader reader;
    std::vector<std::vector<std::byte>> chunks;
    std::map<int, PieceGroup> groups;
    REQUIRE(reader.push(bytes, [&](ChunkType type, std::span<const std::byte> payload, std::uint64_t) {
      if (type == ChunkType::displaced) chunks.emplace_back(payload.begin(), payload.end());
      if (type != ChunkType::piece) return;
      const auto piece = read_piece_header(payload);
      REQUIRE(piece);
      CHECK(groups[piece->group].add(*piece, payload));
      for (std::vector<std::byte>& each : groups[piece->group].take()) chunks.push_back(std::move(each));
    }));
    CHECK(groups.empty() == (name != "displaced_pieces"));
    const bool colored = name != "displaced_pieces";
    auto first = decode_stage(reader.header()->base);
    REQUIRE(first);
    stages.emplace(0, Surface(std::move(*first)));
    for (const auto& payload : chunks) {
      const auto head = decode_cluster_header(payload);
      REQUIRE(head);
      if (head->kind == ClusterHeader::Kind::base) {
        auto stage = decode_stage(std::span(payload).subspan(head->bytes));
        REQUIRE(stage);
        stages.emplace(head->stage, Surface(std::move(*stage)));
      } else {
        REQUIRE(stages.at(head->stage).add(*head, payload));
      }
    }
    REQUIRE(stages.size() == wanted.stages.size());
    const Box& box = reader.header()->description.box;
    const Frame frame(box);
    const Surface& shown = stages.rbegin()->second;
    const int depth = shown.header().depth;
    const std::vector<glm::vec3> places = shown.positions(depth);
    const std::vector<Rgb8> colors = shown.vertex_colors(depth);
    CHECK(wanted.places.size() > 400);
    for (const auto& [vertex, p] : wanted.places) {
      REQUIRE(vertex < places.size());
      const glm::vec3 at = frame.outside(places[vertex]);
      for (int axis = 0; axis < 3; ++axis)
        REQUIRE_EACH(static_cast<double>(at[axis]) == Approx(p[axis]).margin(1e-5 * static_cast<double>(frame.size)));
    }
    CHECK(wanted.colors.size() == (colored ? wanted.places.size() : 0));
    for (const auto& [vertex, c] : wanted.colors)
      REQUIRE_EACH(colors.at(vertex) == Rgb8{static_cast<std::uint8_t>(c.x), static_cast<std::uint8_t>(c.y),
                                             static_cast<std::uint8_t>(c.z)});
    // The decoder of whole streams gives an equal result.
    StreamDecoder decoder;
    REQUIRE(decoder.push(bytes));
    decoder.finish();
    CHECK(decoder.problems().empty());
    CHECK(decoder.refused_chunks() == 0);
    const IndexedMesh geometry = content_of<IndexedMesh>(decoder.geometry());
    const std::vector<std::uint32_t> vertex_of = shown.vertices_of_slots(depth);
    REQUIRE(geometry.size() == vertex_of.size());
    CHECK(geometry.size() >= places.size());
    CHECK((geometry.size() > places.size() || !colored));  // creases
    for (std::size_t i = 0; i < geometry.size(); ++i) {
      REQUIRE_EACH(geometry.positions[i] == frame.outside(places[vertex_of[i]]));
      if (colored) REQUIRE_EACH(geometry.colors[i] == colors[vertex_of[i]]);
    }
    for (auto& [number, surface] : stages) check_stage(surface, wanted.stages.at(number));
  }
}

}  // namespace gs::qnv::displaced::vectors_test
