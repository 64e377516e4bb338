#include "app/commands/encode.h"
#include "app/encode/encode_team.h"
#include "tests/app/commands/vector_commands.h"

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
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
