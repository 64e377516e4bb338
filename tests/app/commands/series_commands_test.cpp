// Tests of encode, export, info and pictures of time series of volumes, as a user runs them.
#include "tests/app/commands/vector_commands.h"
#include "tests/qnv/value_streams.h"

#include <cmath>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

using namespace gs;
using namespace gs::app;
using namespace gs::test;

namespace {

constexpr int kStepEdge = 20;

// Ball that moves along x.
std::string moving_ball(int step) {
  std::string voxels;
  for (int z = 0; z < kStepEdge; ++z)
    for (int y = 0; y < kStepEdge; ++y)
      for (int x = 0; x < kStepEdge; ++x) {
        const double u = x - 4 - 1.2 * step, v = y - 10, w = z - 10;
        const auto value = static_cast<std::int16_t>(900 / (1 + std::exp(std::sqrt(u * u + v * v + w * w) - 4)));
        voxels.append(reinterpret_cast<const char*>(&value), sizeof value);
      }
  return voxels;
}
const std::string kStepHead = "NRRD0004\ntype: int16\nendian: little\nencoding: raw\n";

std::vector<std::vector<float>> steps_in_file(const std::string& path) {
  const qnv::VolumeSource source = opened_volume(path);
  std::vector<std::vector<float>> all;
  if (source.steps.empty()) all.push_back(test::values_in(source));
  for (const qnv::VolumeSource& one : source.steps) all.push_back(test::values_in(one));
  return all;
}

}  // namespace

TEST_CASE("encode: joins volumes to a time series, and export writes all steps or one") {
  const ScratchFolder folder;
  constexpr int kSteps = 9;
  std::string all;
  std::string names;
  for (int s = 0; s < kSteps; ++s) {
    const std::string voxels = moving_ball(s);
    names += " " + quoted(folder.write("run" + std::to_string(s) + ".nrrd",
                                       kStepHead + "dimension: 3\nsizes: 20 20 20\n\n" + voxels));
    all += voxels;
  }
  const std::string whole =
      folder.write("all.nrrd", kStepHead + "dimension: 4\nsizes: 20 20 20 9\nkinds: domain domain domain time\n" +
                                   "spacings: 1 1 1 0.5\naxis mins: 0 0 0 2\n\n" + all);
  const std::string stream = folder.path("a.qnv");
  const auto truth = steps_in_file(whole);
  REQUIRE(truth.size() == kSteps);
  struct Input {
    std::string files;
    double first, apart;
  };
  for (const Input& input :
       {Input{names.substr(1), 0, 1}, Input{quoted(folder.path("run%d.nrrd")), 0, 1}, Input{quoted(whole), 2, 0.5}}) {
    const Run encoded = run("encode --lossless " + input.files + " " + quoted(stream));
    INFO(encoded.output);
    REQUIRE(encoded.status == kDone);
    CHECK(encoded.output.find("9 steps of values of") != std::string::npos);
    const bool several = input.files != quoted(whole);
    CHECK((encoded.output.find(folder.path("run0.nrrd") + " to " + folder.path("run8.nrrd")) != std::string::npos) ==
          several);
    const auto facts = info(stream);
    CHECK(facts.at("steps") == kSteps);
    REQUIRE(facts.at("times").size() == kSteps);
    CHECK(facts.at("times")[0] == input.first);
    CHECK(facts.at("times")[2] == input.first + 2 * input.apart);
    for (const char* extension : {"nrrd", "nii", "nii.gz"})
      for (const std::string& from : {stream, whole}) {
        const std::string out = folder.path(std::string("out.") + extension);
        const Run exported = run("export " + quoted(from) + " " + quoted(out));
        INFO(exported.output);
        REQUIRE(exported.status == kDone);
        CHECK(exported.output.find("9 steps of 20 x 20 x 20 voxels, exact") != std::string::npos);
        CHECK(steps_in_file(out) == truth);
      }
  }
  CHECK(info(whole).at("steps") == kSteps);
  // The stream has the times 2, 2.5, 3, ...
  for (const auto& [option, step] : {std::pair("4", 4), std::pair("3.6", 3), std::pair("0.0", 0), std::pair("99.5", 8)})
    for (const std::string& from : {stream, whole})
      for (const char* extension : {"nrrd", "vti", "fits"}) {
        const std::string one = folder.path(std::string("one.") + extension);
        const Run exported = run("export --time " + std::string(option) + " " + quoted(from) + " " + quoted(one));
        INFO(option << " " << exported.output);
        REQUIRE(exported.status == kDone);
        CHECK(steps_in_file(one) == std::vector<std::vector<float>>{truth[static_cast<std::size_t>(step)]});
      }
  CHECK(run("export " + quoted(stream) + " " + quoted(folder.path("a.vti"))).output.find("--time") !=
        std::string::npos);
  CHECK(run("export --time 9 " + quoted(stream) + " " + quoted(folder.path("a.vti"))).output.find("expected 0 to 8") !=
        std::string::npos);
  // One step of the file alone.
  REQUIRE(run("encode --lossless --time 4 " + quoted(whole) + " " + quoted(stream)).status == kDone);
  CHECK_FALSE(info(stream).contains("steps"));
}

TEST_CASE("encode: refuses inputs that are no steps of one grid") {
  const ScratchFolder folder;
  const std::string one = folder.write("a.nrrd", kStepHead + "dimension: 3\nsizes: 20 20 20\n\n" + moving_ball(0));
  const std::string other = folder.write("b.nrrd", kStepHead + "dimension: 3\nsizes: 20 20 10\n\n" + moving_ball(0));
  const std::string world = folder.write("c.wrl", kBall);
  const std::string stream = quoted(folder.path("a.qnv"));
  CHECK(run("encode " + quoted(one) + " " + quoted(other) + " " + stream).output.find("step 1 differs") !=
        std::string::npos);
  CHECK(run("encode " + quoted(one) + " " + quoted(world) + " " + stream).output.find("is no volume") !=
        std::string::npos);
  CHECK(run("encode --method outlines " + quoted(one) + " " + quoted(one) + " " + stream)
            .output.find("steps of a time series") != std::string::npos);
}

TEST_CASE("snapshot: --time shows a step of a time series") {
  const ScratchFolder folder;
  std::string all;
  for (int s = 0; s < 9; ++s) all += moving_ball(s);
  const std::string whole = folder.write(
      "all.nrrd", kStepHead + "dimension: 4\nsizes: 20 20 20 9\n" + "kinds: domain domain domain time\n\n" + all);
  const std::string stream = folder.path("a.qnv"), picture = folder.path("a.png");
  REQUIRE(run("encode --lossless " + quoted(whole) + " " + quoted(stream)).status == kDone);
  for (const char* look : {"", " --slice z=10 --slices-alone --window 0,900"}) {
    std::vector<std::string> pictures;
    for (const char* time : {"0", "8", "4"})
      for (const std::string& shown : {stream, whole}) {
        const Run drawn =
            run("--snapshot " + quoted(picture) + " --time " + time + " " + quoted(shown) + " --size 120x120" + look);
        INFO(drawn.output);
        REQUIRE(drawn.status == kDone);
        pictures.push_back(folder.read("a.png"));
      }
    CHECK(pictures[0] != pictures[2]);
    CHECK(pictures[2] != pictures[4]);
    if (*look != '\0')
      for (const std::size_t i : {0u, 2u, 4u}) CHECK(pictures[i] == pictures[i + 1]);
  }
}
