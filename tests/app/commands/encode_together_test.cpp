#include "app/commands/encode.h"
#include "app/encode/encode_team.h"
#include "app/formats/volume/file_states.h"
#include "base/text.h"
#include "tests/app/commands/vector_commands.h"

#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace gs::app {
namespace encode_together_test {

/// Output in a file of this process.
class PlainFile final : public TeamFile {
 public:
  explicit PlainFile(const std::string& path) : file_(path, std::ios::binary | std::ios::trunc) {}
  bool write(std::span<const std::byte> bytes) override {
    file_.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    return file_.good();
  }
  bool rewrite_front(std::span<const std::byte> bytes) override {
    const auto end = file_.tellp();
    file_.seekp(0);
    const bool good = write(bytes);
    file_.seekp(end);
    return good;
  }
  std::optional<std::string> finish() override {
    file_.close();
    return fails ? std::optional<std::string>("the disk is full") : std::nullopt;
  }
  bool fails = false;

 private:
  std::ofstream file_;
};

/// Team of this process alone.
class OneProcess final : public EncodeTeam {
 public:
  qnv::Ranks& ranks() override { return ranks_; }
  unsigned threads() const override { return 1; }
  std::string task() const override { return task_name; }
  std::string hidden_errors() const override { return {}; }
  std::unique_ptr<TeamFile> create(const std::string& path) override {
    auto file = std::make_unique<PlainFile>(path);
    file->fails = fails;
    return file;
  }
  JsonValue statistics() override { return JsonValue::list(); }
  void end_together() override { ended = true; }

  std::string task_name = "encode";
  bool fails = false, ended = false;

 private:
  qnv::Ranks ranks_;
};

std::string rough_nrrd() {
  std::string text = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 40 30 90\nencoding: raw\n\n";
  for (int z = 0; z < 90; ++z)
    for (int y = 0; y < 30; ++y)
      for (int x = 0; x < 40; ++x) text += static_cast<char>((x * y / 3 + z * 2 + (x * 7 + y * 11 + z * 5) % 9) & 255);
  return text;
}

int encode(const std::string& in, const std::string& out, OneProcess& team, bool resume = false) {
  EncodeCommand options;
  options.files = {in, out};
  options.resume = resume;
  options.json = true;
  return encode_together(options, team);
}

TEST_CASE("encode together: writes the bytes of one process, and leaves no other file") {
  const ScratchFolder folder;
  const std::string in = folder.write("v.nrrd", rough_nrrd()), mesh = folder.write("ball.wrl", test::kBall);
  for (const std::string& input : {in, mesh}) {
    REQUIRE(test::run("encode " + test::quoted(input) + " " + test::quoted(folder.path("alone.qnv"))).status == kDone);
    OneProcess team;
    REQUIRE(encode(input, folder.path("out.qnv"), team) == kDone);
    CHECK(team.ended);
    CHECK(folder.read("out.qnv") == folder.read("alone.qnv"));
    CHECK_FALSE(std::filesystem::exists(folder.path("out.qnv.parts")));
  }
}

TEST_CASE("encode together: leaves the old output after an error, and continues from the finished parts") {
  const ScratchFolder folder;
  const std::string in = folder.write("v.nrrd", rough_nrrd()), out = folder.path("out.qnv");
  REQUIRE(test::run("encode " + test::quoted(in) + " " + test::quoted(folder.path("alone.qnv"))).status == kDone);
  OneProcess team;
  team.fails = true;
  CHECK(encode(in, out, team) == kNotWritten);
  CHECK(team.ended);
  CHECK_FALSE(std::filesystem::exists(out));
  CHECK(std::filesystem::exists(out + ".parts/1.done"));
  team.fails = false;
  team.task_name = "encode --lossless";
  CHECK(encode(in, out, team, true) == kFailed);
  team.task_name = "encode";
  REQUIRE(encode(in, out, team, true) == kDone);
  CHECK(folder.read("out.qnv") == folder.read("alone.qnv"));
  CHECK_FALSE(std::filesystem::exists(out + ".parts"));
}

TEST_CASE("encode together: --resume notices changes of the files that a header names") {
  const ScratchFolder folder;
  std::string voxels(8 * 8 * 8, 'a');
  for (std::size_t i = 0; i < voxels.size(); ++i) voxels[i] = static_cast<char>(i * i % 127);
  folder.write("voxels.raw", voxels);
  std::string numbers;
  for (const char voxel : voxels) numbers += std::to_string(static_cast<int>(voxel)) + " ";
  const std::string piece = R"(<VTKFile type="ImageData" version="1.0" byte_order="LittleEndian">
<ImageData WholeExtent="0 7 0 7 0 7" Origin="0 0 0" Spacing="1 1 1"><Piece Extent="0 7 0 7 0 7"><PointData Scalars="a">
<DataArray type="UInt8" Name="a" format="ascii">)" + numbers +
                            "</DataArray></PointData></Piece></ImageData></VTKFile>";
  folder.write("piece.vti", piece);
  struct Case {
    std::string header, text, other, changed;
  };
  const Case cases[] = {
      {"v.nhdr",
       "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 8 8 8\nencoding: raw\ndata file: voxels.raw\n\n",
       "voxels.raw", std::string(voxels.rbegin(), voxels.rend())},
      {"v.mhd", "NDims = 3\nDimSize = 8 8 8\nElementType = MET_UCHAR\nElementDataFile = voxels.raw\n", "voxels.raw",
       std::string(voxels.rbegin(), voxels.rend())},
      {"v.pvti",
       R"(<VTKFile type="PImageData" version="1.0" byte_order="LittleEndian">
<PImageData WholeExtent="0 7 0 7 0 7" GhostLevel="0" Origin="0 0 0" Spacing="1 1 1">
<PPointData Scalars="a"><PDataArray type="UInt8" Name="a"/></PPointData>
<Piece Extent="0 7 0 7 0 7" Source="piece.vti"/></PImageData></VTKFile>)",
       "piece.vti", std::string(piece).replace(piece.find("ascii\">") + 7, 1, "9")},
  };
  for (const Case& one : cases) {
    CAPTURE(one.header);
    const std::string in = folder.write(one.header, one.text), out = folder.path("out.qnv"),
                      old = folder.read(one.other);
    OneProcess team;
    team.fails = true;
    REQUIRE(encode(in, out, team) == kNotWritten);
    folder.write(one.other, one.changed);
    team.fails = false;
    CHECK(encode(in, out, team, true) == kFailed);
    folder.write(one.other, old);
    CHECK(encode(in, out, team, true) == kDone);
  }
}

TEST_CASE("encode together: --resume notices changes of large files beside a header, and of chunks of a container") {
  const ScratchFolder folder;
  const std::string raw = folder.write("voxels.raw", std::string(1 << 20, 'a'));
  folder.write("v.mhd", "NDims = 3\nDimSize = 128 128 64\nElementType = MET_UCHAR\nElementDataFile = voxels.raw\n");
  const std::string chunk = folder.write("v.zarr/0.0.0", std::string(8 * 8 * 8, 'b'));
  folder.write("v.zarr/.zarray", R"({"zarr_format": 2, "shape": [8, 8, 8], "chunks": [8, 8, 8], "dtype": "|u1",
    "compressor": null, "fill_value": 0, "filters": null, "order": "C"})");
  for (const auto& [in, other] : {std::pair(folder.path("v.mhd"), raw), std::pair(folder.path("v.zarr"), chunk)}) {
    CAPTURE(in);
    OneProcess team;
    team.fails = true;
    REQUIRE(encode(in, folder.path("out.qnv"), team) == kNotWritten);
    std::filesystem::last_write_time(other, std::filesystem::last_write_time(other) + std::chrono::seconds(2));
    team.fails = false;
    CHECK(encode(in, folder.path("out.qnv"), team, true) == kFailed);
  }
}

TEST_CASE("encode together: --resume notices changes of the hidden metadata of a container") {
  const ScratchFolder folder;
  const std::string array = R"({"zarr_format": 2, "shape": [8, 8, 8], "chunks": [8, 8, 8], "dtype": "|u1",
    "compressor": null, "fill_value": 7, "filters": null, "order": "C"})";
  const std::string changed = std::string(array).replace(array.find('7'), 1, "9");
  folder.write("v.zarr/.zarray", array);
  folder.write("group.zarr/.zgroup", R"({"zarr_format": 2})");
  folder.write("group.zarr/a/.zarray", array);
  for (const auto& [in, other] :
       {std::pair("v.zarr", "v.zarr/.zarray"), std::pair("group.zarr", "group.zarr/a/.zarray")}) {
    CAPTURE(in);
    OneProcess team;
    team.fails = true;
    REQUIRE(encode(folder.path(in), folder.path("out.qnv"), team) == kNotWritten);
    team.fails = false;
    const std::string file = folder.write(other, changed);
    std::filesystem::last_write_time(file, std::filesystem::last_write_time(file) + std::chrono::seconds(2));
    CHECK(encode(folder.path(in), folder.path("out.qnv"), team, true) == kFailed);
  }
}

TEST_CASE("encode together: reads each file once if VTK files name it often, or themselves") {
  std::string text = R"(<VTKFile type="Collection"><Collection>)";
  for (int i = 0; i < 40; ++i)
    for (const char* const file : {"v.pvd", "none.vti"})
      text += "<DataSet timestep=\"" + std::to_string(i) + "\" file=\"" + file + "\"/>";
  text += "</Collection></VTKFile>";
  const SharedBytes file = shared_bytes(copied_bytes(text));
  std::map<std::string, int> reads;
  FileStates states;
  states.add_members("v.pvd", file, [&](const std::string& reference) -> BytesResult {
    ++reads[reference];
    if (reference != "v.pvd") return reference + ": no such file";
    return file;
  });
  CHECK(states.text().starts_with("\nv.pvd "));
  CHECK(reads == std::map<std::string, int>{{"none.vti", 1}, {"v.pvd", 1}});
}

TEST_CASE("encode together: rejects slices that exceed the memory of a process") {
  const ScratchFolder folder;
  EncodeCommand options;
  options.files = {folder.write("v.nrrd", rough_nrrd()), folder.path("out.qnv")};
  options.limits.memory = 64 * 4 * 40 * 30 - 1;
  OneProcess team;
  CHECK(encode_together(options, team) == kFailed);
  CHECK_FALSE(std::filesystem::exists(folder.path("out.qnv.parts")));
}

TEST_CASE("encode together: ghostspace alone has no --resume") {
  EncodeCommand options;
  options.files = {"a.nrrd", "b.qnv"};
  options.resume = true;
  CHECK(check_encode(options));
  options.resume = false;
  CHECK_FALSE(check_encode(options));
}

}  // namespace encode_together_test
}  // namespace gs::app
