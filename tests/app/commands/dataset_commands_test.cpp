#include "tests/app/formats_helpers.h"
#include "tests/app/run_program.h"
#include "tests/app/scratch_folder.h"

#include <string>

using namespace gs::app;

namespace {

const std::string kDatasetSeeds = GHOSTSPACE_TESTS "/fuzz/corpus/app/";

}  // namespace

TEST_CASE("info lists the datasets of a file as a tree and as JSON") {
  const std::string file = quoted(kDatasetSeeds + "netcdf/cdf1.nc");
  const Run text = run("info " + file);
  CHECK(text.status == 0);
  CHECK_THAT(text.output, Catch::Contains("datasets\n  /\n    lon "));
  CHECK_THAT(text.output, Catch::Contains("2 x 3 x 4 x 5  (time, lev, lat, lon)"));
  CHECK_THAT(text.output, Catch::Contains("dataset: /v"));
  const Run json = run("info --json " + file);
  CHECK(json.status == 0);
  CHECK_THAT(json.output, Catch::Contains("\"datasets\": ["));
  CHECK_THAT(json.output, Catch::Contains("\"path\": \"/v\""));
  CHECK_THAT(json.output, Catch::Contains("\"unit\": \"degrees_east\""));
}

TEST_CASE("--dataset, --time and --channel choose the values of a file") {
  const std::string file = quoted(kDatasetSeeds + "hdf5/steps.h5");
  const Run step = run("info --dataset t --time 2 " + file);
  CHECK(step.status == 0);
  CHECK_THAT(step.output, !Catch::Contains("\nsteps "));
  const Run late = run("info --time 9 " + file);
  CHECK_THAT(late.output, Catch::Contains("no step 9; expected 0 to 5"));
  const Run wrong = run("info --dataset q " + file);
  CHECK(wrong.status == 1);
  CHECK_THAT(wrong.output, Catch::Contains("no dataset 'q'; the nearest ones are /t"));
  const Run channel = run("info --channel 3 " + file);
  CHECK_THAT(channel.output, Catch::Contains("no channel 3; expected 0"));
  const Run bad = run("info --channel x " + file);
  CHECK(bad.status == 2);
}

TEST_CASE("a confined process reads datasets") {
  const std::string folder = kDatasetSeeds + "hdf5";
  const Run made = run("info --confine " + quoted(folder) + " " + quoted(folder + "/gzip.h5"));
  CHECK(made.status == 0);
  CHECK_THAT(made.output, Catch::Contains("values                 0 16"));
}

TEST_CASE("encodes and exports a dataset of a file") {
  const ScratchFolder folder;
  const std::string file = quoted(kDatasetSeeds + "hdf5/gzip.h5"), stream = quoted(folder.path("a.qnv"));
  CHECK(run("encode --lossless " + file + " " + stream).status == 0);
  const Run made = run("info " + stream);
  CHECK_THAT(made.output, Catch::Contains("dataset: /a"));
  CHECK_THAT(made.output, Catch::Contains("dimensions             6 5 4"));
}
