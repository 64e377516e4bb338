#include "app/formats/splats/sog_levels.h"

#include "app/formats/content_types.h"
#include "app/formats/splats/splat_join.h"
#include "app/formats/splats/splats_sog.h"
#include "tests/app/streamed_sog.h"
#include "tests/qnv/splat_clouds.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <string>
#include <variant>
#include <vector>

namespace gs::app::sog_levels_test {
namespace {

std::variant<SogLevels, SogLevelsProblem> parsed(const std::string& text) {
  return parse_sog_levels(std::as_bytes(std::span(text)), own_budget());
}

SogLevelsProblem problem_of(const std::string& text) {
  const auto result = parsed(text);
  return std::holds_alternative<SogLevelsProblem>(result) ? std::get<SogLevelsProblem>(result) : SogLevelsProblem{};
}

/// A view along -z from `eye`, with an angle of 90 degrees.
qnv::LodView view_from(const glm::vec3& eye, float pixels) {
  qnv::LodView view;
  view.eye = eye;
  view.pixels = pixels;
  view.planes = {{{1, 0, -1, eye.z - eye.x},
                  {-1, 0, -1, eye.z + eye.x},
                  {0, 1, -1, eye.z - eye.y},
                  {0, -1, -1, eye.z + eye.y},
                  {0, 0, -1, eye.z - 0.1f}}};
  return view;
}

/// Two parts of 1 x 1 x 1 at x = 0 and x = 100, with 10000, 2500 and 100 splats.
const std::string kTwoParts =
    "{\"lodLevels\":3,\"filenames\":[\"a/meta.json\",\"b/meta.json\",\"c/meta.json\"],\"tree\":{\"children\":["
    "{\"bound\":{\"min\":[0,-1,-1],\"max\":[1,0,0]},\"lods\":{\"0\":{\"file\":0,\"offset\":0,\"count\":10000},"
    "\"1\":{\"file\":1,\"offset\":0,\"count\":2500},\"2\":{\"file\":2,\"offset\":0,\"count\":100}}},"
    "{\"bound\":{\"min\":[100,-1,-1],\"max\":[101,0,0]},\"lods\":{\"0\":{\"file\":0,\"offset\":10000,\"count\":10000},"
    "\"1\":{\"file\":1,\"offset\":2500,\"count\":2500},\"2\":{\"file\":2,\"offset\":100,\"count\":100}}}]}}";

}  // namespace

TEST_CASE("reports the line and column of problems in the list of streamed SOG") {
  const SogLevelsProblem none =
      problem_of("{\"version\": 1,\n \"filenames\": [\"a/meta.json\"],\n \"tree\": {\"children\": []}}");
  CHECK(none.message == "its tree has no levels; expected \"lods\" with file, offset and count");
  CHECK(none.location == SourceLocation{3, 2});
  const SogLevelsProblem damaged = problem_of("{\"filenames\":\n  [\"a\",]}");
  CHECK(damaged.message.starts_with("it is damaged; expected JSON"));
  CHECK(damaged.location == SourceLocation{2, 8});
  CHECK(problem_of("[1]").location == SourceLocation{1, 1});
  CHECK(problem_of("{}").message.starts_with("it names no files; expected \"filenames\""));
  const std::string nested(500, '[');
  CHECK(problem_of("{\"filenames\":[],\"tree\":{\"children\":" + nested + std::string(500, ']') + "}}")
            .message.starts_with("its tree is damaged"));
}

TEST_CASE("recognises the list of streamed SOG with its keys in any order") {
  for (const std::string text :
       {"{\"lodLevels\":3}", "  {\n\"filenames\":[],\"tree\":{}}", "{\"tree\":{\"bound\":{},\"lods\":{}}}"}) {
    INFO(text);
    CHECK(content_type_of("x.json", std::as_bytes(std::span(text))).name == "streamed SOG");
  }
  const std::string other = "{\"nodes\":[],\"children\":[]}";
  CHECK(content_type_of("x.json", std::as_bytes(std::span(other))).name != "streamed SOG");
}

TEST_CASE("charges the memory of the list of streamed SOG before it is parsed") {
  Limits limits;
  limits.memory = 1 << 20;
  const auto budget = std::make_shared<Budget>(limits);
  const std::string text = "{\"filenames\":[" + std::string(200'000, ' ') + "]}";
  const auto result = parse_sog_levels(std::as_bytes(std::span(text)), budget);
  REQUIRE(std::holds_alternative<SogLevelsProblem>(result));
  CHECK(std::get<SogLevelsProblem>(result).message.find("--memory") != std::string::npos);
}

TEST_CASE("refines the parts of streamed SOG that are in view, nearest first, within a budget") {
  const auto result = parsed(kTwoParts);
  REQUIRE(std::holds_alternative<SogLevels>(result));
  const auto& levels = std::get<SogLevels>(result);
  REQUIRE(levels.leaves.size() == 2);
  CHECK(levels.leaves[0].box == Box({0, 0, 0}, {1, 1, 1}));
  const std::vector<bool> readable(4, false);
  CHECK(coarsest_sog_runs(levels, readable) == SogChoice{2, 2});
  CHECK(finest_sog_runs(levels, readable, 100'000) == SogChoice{0, 0});
  CHECK(finest_sog_runs(levels, readable, 5000) == SogChoice{1, 1});
  const auto chosen = [&](const std::vector<qnv::LodView>& views, std::uint64_t most = 100'000) {
    return sog_runs_in_view(levels, readable, views, glm::dvec3(0), most).choice;
  };
  const qnv::LodView near = view_from({0.5f, 0.5f, 4}, 1000), far = view_from({50, 0.5f, 200}, 1000);
  CHECK(chosen({}) == SogChoice{2, 2});
  CHECK(chosen({near}) == SogChoice{0, 2});        // 3.3 pixels between splats of the finest level
  CHECK(chosen({near}, 3000) == SogChoice{1, 2});  // the finest level exceeds the budget
  CHECK(chosen({far}) == SogChoice{2, 2});         // half a pixel between splats
  CHECK(chosen({view_from({50, 0.5f, 100}, 1000)}) == SogChoice{1, 1});
  CHECK(chosen({near, view_from({100.5f, 0.5f, 4}, 1000)}) == SogChoice{0, 0});
  // Positions of views are relative to an origin.
  CHECK(sog_runs_in_view(levels, readable, std::vector{near}, glm::dvec3(100, 0, 0), 100'000).choice ==
        SogChoice{2, 0});
  const SogRefinement steps = sog_runs_in_view(levels, readable, std::vector{near}, glm::dvec3(0), 100'000);
  REQUIRE(steps.steps.size() == 2);
  CHECK(steps.steps[0].run == 1);
  CHECK(steps.steps[1].run == 0);
  // A level without a readable file is skipped.
  std::vector<bool> broken = readable;
  broken[0] = true;
  CHECK(sog_runs_in_view(levels, broken, std::vector{near}, glm::dvec3(0), 100'000).choice == SogChoice{1, 2});
  broken.assign(4, true);
  CHECK(coarsest_sog_runs(levels, broken) == SogChoice{kNoSogRun, kNoSogRun});
}

TEST_CASE("reads ranges of a SOG for another process, with the number of splats of each") {
  const test::SogPart part{Box({-2, -1, -1}, {2, 1, 1}), {test::splat_cloud(500, 1)}};
  const test::SogFiles files = test::streamed_sog({&part, 1});
  const ReadFile read = [&](const std::string& path) -> BytesResult {
    const auto found = files.find(path);
    return found == files.end() ? BytesResult(path + " is missing") : BytesResult(shared_bytes(found->second));
  };
  const auto imported = [&](const SogParts& parts) {
    Diagnostics diagnostics;
    const std::string text = text_of_sog_parts(parts);
    Asset asset = read_splats_sog_levels({std::as_bytes(std::span(text)), "x", read, own_budget(), diagnostics});
    auto* const splats = std::get_if<qnv::Gaussians>(&asset);
    return splats ? *splats : qnv::Gaussians();
  };
  const qnv::Gaussians all = imported({"0_0/meta.json", {}});
  CHECK(all.size() == 500);
  const qnv::Gaussians two = imported({"0_0/meta.json", {{0, 0, 10, 5}, {0, 0, 100, 20}}});
  REQUIRE(two.size() == 25);
  CHECK(two.degree == 1);
  CHECK(two.description.metadata.back() == std::pair(std::string(kSogPartCounts), std::string("5,20")));
  CHECK(two.scales[5] == all.scales[100]);
  CHECK(imported({"0_0/meta.json", {{0, 0, 490, 20}}}).empty());
  CHECK(imported({"../meta.json", {}}).empty());
}

TEST_CASE("joins splats with different origins and degrees") {
  qnv::Gaussians flat = test::splat_cloud(10), round = test::splat_cloud(5, 2);
  round.description.origin = {1000, 0, 0};
  qnv::Gaussians joined;
  append_splats(joined, flat);
  append_splats(joined, round);
  append_splats(joined, flat);
  REQUIRE(joined.size() == 25);
  CHECK(joined.degree == 2);
  REQUIRE(joined.harmonics.size() == 25 * 8);
  CHECK(joined.harmonics[0] == glm::vec3(0));
  CHECK(joined.harmonics[80] == round.harmonics[0]);
  CHECK(joined.harmonics[120] == glm::vec3(0));
  CHECK(joined.positions[10].x == Approx(1000 + round.positions[0].x));
  CHECK(joined.description.box.upper.x > 990);
  const qnv::Gaussians part = range_of_splats(joined, 10, 5);
  CHECK(part.harmonics == round.harmonics);
  CHECK(part.description.total == Approx(round.description.total));
}

TEST_CASE("keeps the harmonics of streamed SOG if the first file has a lower degree") {
  const std::vector<test::SogPart> parts{{Box({-2, -1, -1}, {2, 1, 1}), {test::splat_cloud(50, 0)}},
                                         {Box({-2, -1, -1}, {2, 1, 1}), {test::splat_cloud(70, 2)}}};
  const test::SogFiles files = test::streamed_sog(parts);
  const ReadFile read = [&](const std::string& path) -> BytesResult {
    const auto found = files.find(path);
    return found == files.end() ? BytesResult(path + " is missing") : BytesResult(shared_bytes(found->second));
  };
  Diagnostics diagnostics;
  const auto& list = files.at("lod-meta.json");
  const Asset asset = read_splats_sog_levels({list, "lod-meta.json", read, own_budget(), diagnostics});
  const auto* const splats = std::get_if<qnv::Gaussians>(&asset);
  REQUIRE(splats);
  CHECK(splats->degree == 2);
  CHECK(splats->size() == 120);
  CHECK(diagnostics.entries().empty());
}

}  // namespace gs::app::sog_levels_test
