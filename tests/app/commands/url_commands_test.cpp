#include "app/serve/archive.h"
#include "tests/app/formats_helpers.h"
#include "tests/app/run_program.h"
#include "tests/app/scratch_folder.h"

#include <filesystem>
#include <memory>
#include <string>
#include <variant>

using namespace gs::app;

namespace {

const std::string kSeeds = GHOSTSPACE_TESTS "/fuzz/corpus/app/";

/// Server of a folder on this machine.
class Site {
 public:
  explicit Site(const std::string& folder) {
    ArchiveOptions options;
    options.folder = folder;
    options.http_port = 0;
    options.log = "";
    auto started = Archive::start(options);
    if (const auto* const problem = std::get_if<std::string>(&started)) FAIL(*problem);
    archive_ = std::move(std::get<std::unique_ptr<Archive>>(started));
  }
  [[nodiscard]] std::string url(const std::string& path) const {
    return "http://127.0.0.1:" + std::to_string(*archive_->http_port()) + "/" + path;
  }

 private:
  std::unique_ptr<Archive> archive_;
};

/// Writes the two files of a seed.
void write_pair(const ScratchFolder& folder, const std::string& seed, const std::string& name) {
  const std::string text = gs::test::string_of(gs::test::file_bytes(kSeeds + seed));
  const std::string mark = "\n==== the other file\n";
  const std::size_t at = text.find(mark);
  REQUIRE(at != std::string::npos);
  (void)folder.write(name, text.substr(0, at));
  (void)folder.write("volume.img", text.substr(at + mark.size()));
}

}  // namespace

TEST_CASE("info, encode and export read volumes of a server") {
  const ScratchFolder made;
  const Site site(kSeeds);
  const Run facts = run("info " + site.url("hdf5/gzip.h5"));
  CHECK(facts.status == 0);
  CHECK_THAT(facts.output, Catch::Contains("HDF5"));
  CHECK_THAT(facts.output, Catch::Contains("dimensions             6 5 4"));
  CHECK_THAT(facts.output, Catch::Contains("values                 0 16"));
  const std::string stream = quoted(made.path("a.qnv"));
  CHECK(run("encode --lossless " + site.url("hdf5/gzip.h5") + " " + stream).status == 0);
  CHECK_THAT(run("info " + stream).output, Catch::Contains("dimensions             6 5 4"));
  CHECK(run("export " + site.url("hdf5/gzip.h5") + " " + quoted(made.path("a.nrrd"))).status == 0);
  CHECK_THAT(run("info " + quoted(made.path("a.nrrd"))).output, Catch::Contains("values                 0 16"));
}

TEST_CASE("info, encode and export read meshes of a server, and the files that they name") {
  const ScratchFolder made, folder;
  write_pair(folder, "vtk_polydata/pieces.pvtp", "run.pvtp");
  const Site site(folder.path(""));
  const Run facts = run("info --json " + site.url("run.pvtp"));
  CHECK(facts.status == 0);
  CHECK_THAT(facts.output, Catch::Contains("\"type\": \"VTK PolyData\""));
  CHECK_THAT(facts.output, Catch::Contains("\"triangles\": 2"));
  CHECK(run("export " + site.url("run.pvtp") + " " + quoted(made.path("a.stl"))).status == 0);
  const Run missing = run("info " + site.url("none.stl"));
  CHECK(missing.status == 1);
  CHECK_THAT(missing.output, Catch::Contains("404"));
  CHECK(run("export " + site.url("none.stl") + " " + quoted(made.path("b.stl"))).status == 1);
  CHECK(run("encode http://127.0.0.1:1/none.nrrd " + quoted(made.path("c.qnv"))).status == 1);
}

TEST_CASE("a picture of a large file of a server counts its bytes, and leaves no temporary file") {
  const ScratchFolder made, folder, temporary;
  std::string text = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 256 256 48\nencoding: raw\n\n";
  for (std::size_t i = 0; i < std::size_t{256} * 256 * 48; ++i)
    text += static_cast<char>(i % 256 > 90 && i / 256 % 256 > 90 ? 100 : 1);
  (void)folder.write("large.nrrd", text);
  const Site site(folder.path(""));
  const std::string stats = made.path("stats.json");
  const Run drawn =
      run_shell("TMPDIR=" + quoted(temporary.path("")) + " " + program() + " --snapshot " + quoted(made.path("a.png")) +
                " --size 32x32 --stats " + quoted(stats) + " " + site.url("large.nrrd"));
  CHECK(drawn.status == 0);
  const std::string written = gs::test::string_of(gs::test::file_bytes(stats));
  const std::size_t at = written.find("\"bytes\": ");
  REQUIRE(at != std::string::npos);
  CHECK(std::stoull(written.substr(at + 9)) > 1'000'000);
  CHECK(std::filesystem::is_empty(temporary.path("")));
}

TEST_CASE("info lists the arrays of VTK files, and of files that name others") {
  const ScratchFolder folder;
  write_pair(folder, "vtk_multiblock/blocks.vtm", "run.vtm");
  const Run made = run("info " + quoted(folder.path("run.vtm")));
  CHECK(made.status == 0);
  CHECK_THAT(made.output, Catch::Contains("datasets\n  /PointData\n    GlobalNodeId"));
  CHECK_THAT(made.output, Catch::Contains("the mesh without data, 2 blocks"));
  const Run wrong = run("info --dataset q " + quoted(folder.path("run.vtm")));
  CHECK_THAT(wrong.output, Catch::Contains("no dataset 'q'; the nearest ones are /PointData/t"));
}
