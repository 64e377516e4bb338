#include "app/commands/options/picture_options.h"

#include "tests/app/run_program.h"
#include "tests/app/scratch_folder.h"
#include "tests/watched.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace gs::app::picture_options_test {
namespace {

const std::string kBox =
    "#VRML V2.0 utf8\nDEF A Viewpoint { description \"Front\" } DEF B Viewpoint { position 5 0 5 "
    "orientation 0 1 0 0.785 }\nShape { geometry Box { } appearance Appearance { material Material { } } }\n";

/// Returns a volume of 8 x 8 x 4 bytes that contains a bright block.
std::string block_nrrd() {
  std::string text =
      "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 8 8 4\nspacings: 1 1 1\nsample units: \"K\"\nencoding: raw\n\n";
  for (int z = 0; z < 4; ++z)
    for (int y = 0; y < 8; ++y)
      for (int x = 0; x < 8; ++x) text += static_cast<char>(x > 2 && x < 6 && y > 2 && y < 6 ? 200 : 10);
  return text;
}

std::uint32_t number_at(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

const std::string kDraw = "--backend osmesa --samples 1 ";

}  // namespace

TEST_CASE("accepts sizes of paper, colours and times, and nothing else") {
  CHECK(*read_paper("210x297mm") == glm::dvec2(210, 297));
  CHECK(*read_paper("10x15cm") == glm::dvec2(100, 150));
  CHECK(read_paper("8.5x11in")->x == Approx(215.9));
  for (const char* wrong : {"", "mm", "10mm", "0x5mm", "-1x5cm", "10x20", "1x2x3mm", "nanx5mm"})
    CHECK_FALSE(read_paper(wrong));
  CHECK(*read_color("#ff8000") == glm::vec3(255, 128, 0) / 255.0f);
  CHECK(*read_color("0,0.5,1") == glm::vec3(0, 0.5f, 1));
  for (const char* wrong : {"", "#", "#ff80", "#ff80000", "#gg0000", "1,2,3", "red"}) CHECK_FALSE(read_color(wrong));
  CHECK(*read_times("0..10") == std::pair<double, double>{0, 10});
  CHECK(*read_times("1.5..2") == std::pair<double, double>{1.5, 2});
  for (const char* wrong : {"", "..", "5", "3..2", "-1..2", "0..99999", "0..x", "1..1"}) CHECK_FALSE(read_times(wrong));
  PictureRequest request;
  request.paper = glm::dvec2(25.4, 50.8);
  CHECK(*pixels_of(request) == glm::ivec2(300, 600));
  request.dots_per_inch = 72;
  CHECK(*pixels_of(request) == glm::ivec2(72, 144));
  request.dots_per_inch = 20000;
  request.paper = glm::dvec2(254, 254);
  CHECK_FALSE(pixels_of(request));
}

TEST_CASE("draws the same picture if the system limits the address space") {
  if (gs::watched()) return;  // AddressSanitizer reserves terabytes of addresses
  const ScratchFolder folder;
  const std::string world = quoted(folder.write("box.wrl", kBox));
  const auto draw = [&](const std::string& limit, const std::string& name) {
    const Run run = run_shell(limit + program() + " " + kDraw + "--size 32x24 --snapshot " + quoted(folder.path(name)) +
                              " " + world);
    INFO(run.output);
    CHECK(run.status == 0);
    return folder.read(name);
  };
  const std::string free = draw("", "free.png");
  CHECK(free.size() > 100);
  CHECK(draw("ulimit -v 4000000; ", "limited.png") == free);
}

TEST_CASE("writes a print picture in the size of its paper, without a background on request") {
  const ScratchFolder folder;
  const std::string world = folder.write("a.wrl", kBox);
  const Run drawn = run(kDraw + "--size 25.4x12.7mm --dpi 100 --background transparent --snapshot " +
                        quoted(folder.path("o.png")) + " " + quoted(world));
  INFO(drawn.output);
  REQUIRE(drawn.status == 0);
  const std::string png = folder.read("o.png");
  CHECK(number_at(png, 16) == 100);
  CHECK(number_at(png, 20) == 50);
  CHECK(png[25] == 6);  // RGBA
  CHECK(png.find("pHYs") != std::string::npos);
  CHECK(number_at(png, png.find("pHYs") + 4) == 3937);
}

TEST_CASE("writes as many pictures as an animation has, and refuses conflicting options") {
  const ScratchFolder folder;
  const std::string world = folder.write("a.wrl", kBox);
  const std::string to = " " + quoted(world) + " " + quoted(folder.path("t.%02d.png"));
  const Run turned = run("animate " + kDraw + "--size 32x24 --turntable --frames 3" + to);
  INFO(turned.output);
  CHECK(turned.status == 0);
  CHECK(turned.output.find("3 pictures") != std::string::npos);
  CHECK(folder.read("t.02.png").starts_with("\x89PNG"));
  CHECK(folder.read("t.03.png").empty());
  CHECK(folder.read("t.00.png") != folder.read("t.01.png"));
  const Run toured = run("animate " + kDraw + "--size 32x24 --tour A,B --frames 2" + to);
  CHECK(toured.status == 0);
  CHECK(folder.read("t.00.png") != folder.read("t.01.png"));
  CHECK(run("animate " + kDraw + "--tour A,C --size 8x8" + to).output.find("no Viewpoint 'C'") != std::string::npos);
  CHECK(run("animate " + kDraw + "--size 8x8" + to).output.find("nothing would move") != std::string::npos);
  CHECK(run("animate --turntable " + quoted(world) + " a.avi").status == 2);
  CHECK(run("--stereo anaglyph " + quoted(world)).status == 2);
  CHECK(run("--stereo cinema --snapshot o.png " + quoted(world)).status == 2);
}

TEST_CASE("applies slices, colour maps and bars to volumes, and the file of its time to a series") {
  const ScratchFolder folder;
  const std::string volume = folder.write("run.1.nrrd", block_nrrd());
  folder.write("run.2.nrrd", block_nrrd());
  const auto picture = [&](const std::string& options, const std::string& file) {
    const Run drawn = run(kDraw + "--size 96x64 --orbit 20,20 " + options + " --snapshot " +
                          quoted(folder.path("o.png")) + " " + quoted(file));
    INFO(drawn.output);
    CHECK(drawn.status == 0);
    return folder.read("o.png");
  };
  const std::string plain = picture("", volume), slices = picture("--slice z=50% --slice x=4 --slices-alone", volume);
  CHECK(plain != slices);
  CHECK(picture("--slice z=50% --slice x=4 --slices-alone --slice-map viridis", volume) != slices);
  CHECK(picture("--color-bar", volume) != plain);
  CHECK(picture("--transfer turbo", volume) != plain);
  CHECK(picture("", folder.path("run.%d.nrrd")) == plain);
  CHECK(picture("--time 1 --fps 1", folder.path("run.%03d.nrrd")) == plain);
  const std::string bad = folder.write("bad.json", "{");
  const std::string draw = kDraw + "--size 8x8 --snapshot " + quoted(folder.path("p.png")) + " ";
  CHECK(run(draw + "--transfer " + quoted(bad) + " " + quoted(volume)).output.find("bad.json:1:") != std::string::npos);
  CHECK(run(draw + "--transfer jet " + quoted(volume)).output.find("viridis") != std::string::npos);
  // A surface with colours of values has a colour bar too.
  const std::string keyed = folder.write(
      "keyed.wrl", std::string(kBox) + "WorldInfo { info \"color key: 0 10 #0000ff #ff0000 pressure (Pa)\" } ");
  CHECK(picture("--color-bar", keyed) != picture("", keyed));
  // A stream of such a file contains the colour key, and so does an export of that stream.
  const std::string stream = folder.path("keyed.qnv"), back = folder.path("back.wrl");
  const std::string surface =
      folder.write("keyed.ply",
                   "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
                   "property float quality\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n"
                   "0 0 0 -5\n1 0 0 0\n1 1 0 5\n0 1 0 0\n3 0 1 2\n3 0 2 3\n");
  CHECK(run("encode " + quoted(surface) + " " + quoted(stream)).status == 0);
  CHECK(run("info --json " + quoted(stream)).output.find("\"color key\": \"-5 5 #440154") != std::string::npos);
  CHECK(picture("--color-bar", stream) != picture("", stream));
  CHECK(run("export --vrml97 " + quoted(stream) + " " + quoted(back)).status == 0);
  CHECK(folder.read("back.wrl").find("info \"color key: -5 5 #440154") != std::string::npos);
  CHECK(run(draw + "--transfer grey " + quoted(keyed)).output.find("has no volume") != std::string::npos);
  CHECK(run(draw + "--color-bar " + quoted(folder.write("a.wrl", kBox))).output.find("has no volume") !=
        std::string::npos);
  CHECK(run(draw + quoted(folder.path("none.%d.nrrd"))).output.find("no file of this series") != std::string::npos);
  CHECK(run(draw + "--slice w=3 " + quoted(volume)).status == 2);
}

TEST_CASE("draws isosurfaces, projections and shares of the voxels of volumes and of streams of their values") {
  const ScratchFolder folder;
  const std::string volume = folder.write("a.nrrd", block_nrrd()), stream = folder.path("a.qnv");
  REQUIRE(run("encode --lossless " + quoted(volume) + " " + quoted(stream)).status == 0);
  const auto picture = [&](const std::string& options, const std::string& file) {
    const Run drawn = run(kDraw + "--size 96x64 --orbit 20,20 " + options + " --snapshot " +
                          quoted(folder.path("o.png")) + " " + quoted(file));
    INFO(options << ": " << drawn.output);
    CHECK(drawn.status == 0);
    return folder.read("o.png");
  };
  std::vector<std::string> pictures{picture("", volume)};
  for (const char* options : {"--isovalue 20", "--isovalue 100 --slice z=50%", "--projection maximum",
                              "--projection average --slice-map viridis", "--projection minimum --window 0,10",
                              "--fraction 40%", "--fraction 0.02", "--projection maximum --color-bar"}) {
    pictures.push_back(picture(options, volume));
    INFO(options);
    CHECK(std::count(pictures.begin(), pictures.end(), pictures.back()) == 1);
    CHECK(picture(options, stream) == pictures.back());
  }
  CHECK(picture("--fraction 0.09", volume) == pictures.front());
  const std::string draw = kDraw + "--size 8x8 --snapshot " + quoted(folder.path("p.png")) + " ";
  CHECK(run(draw + "--isovalue 1e6 " + quoted(volume)).output.find("no isosurface at 1e+06; expected") !=
        std::string::npos);
  for (const char* wrong : {"--isovalue x ", "--projection mip ", "--fraction 0.6 ", "--component -1 "})
    CHECK(run(draw + wrong + quoted(volume)).status == 2);
  const std::string records = folder.path("r.qnv");
  REQUIRE(run("encode --method records " + quoted(volume) + " " + quoted(records)).status == 0);
  CHECK(run(draw + "--projection maximum " + quoted(records)).output.find("has no values of voxels") !=
        std::string::npos);
  CHECK(run(draw + "--isovalue 3 " + quoted(folder.write("a.wrl", kBox))).output.find("has no volume") !=
        std::string::npos);
}

TEST_CASE("selects a component of volumes with several numbers per voxel") {
  const ScratchFolder folder;
  std::string text =
      "NRRD0004\ntype: short\ndimension: 4\nsizes: 2 8 8 8\nkinds: vector space space space\nencoding: ascii\n\n";
  for (int i = 0; i < 512; ++i) text += std::to_string(3 * (i % 8)) + " " + std::to_string(-4 * (i % 8)) + " ";
  const std::string volume = folder.write("v.nrrd", text), out = folder.path("v.qnv");
  const auto range_of = [&](const std::string& options) {
    const Run facts = run("info --json " + options + quoted(volume));
    INFO(facts.output);
    REQUIRE(facts.status == 0);
    return nlohmann::json::parse(facts.output)["values"];
  };
  CHECK(range_of("") == nlohmann::json({0.0, 21.0}));
  CHECK(range_of("--component 1 ") == nlohmann::json({-28.0, 0.0}));
  CHECK(range_of("--component magnitude ") == nlohmann::json({0.0, 35.0}));
  const Run none = run("info --component 2 " + quoted(volume));
  CHECK(none.status == 1);
  CHECK(none.output.find("no component 2; expected 0 to 1, or magnitude") != std::string::npos);
  REQUIRE(run("encode --lossless --component magnitude " + quoted(volume) + " " + quoted(out)).status == 0);
  CHECK(run("info --json " + quoted(out)).output.find("\"component\": \"magnitude of 2\"") != std::string::npos);
  const auto picture = [&](const std::string& options) {
    const Run drawn =
        run(kDraw + "--size 64x64 " + options + "--snapshot " + quoted(folder.path("o.png")) + " " + quoted(volume));
    INFO(drawn.output);
    CHECK(drawn.status == 0);
    return folder.read("o.png");
  };
  CHECK(picture("--slice z=50% --slices-alone ") != picture("--component 1 --slice z=50% --slices-alone "));
  CHECK(picture("--component 1 ") != picture(""));
}

TEST_CASE("takes a picture from a camera text, in parallel projection, with the chosen up axis") {
  const ScratchFolder folder;
  const std::string world = folder.write("a.wrl", kBox);
  // A wedge with its height along Z.
  const std::string wedge = folder.write("w.stl",
                                         "solid w\nfacet normal 0 -1 0\nouter loop\nvertex 0 0 0\nvertex 2 0 0\nvertex "
                                         "0 0 9\nendloop\nendfacet\nendsolid\n");
  const auto picture = [&](const std::string& options, const std::string& file) {
    const Run drawn =
        run(kDraw + "--size 48x48 " + options + " --snapshot " + quoted(folder.path("o.png")) + " " + quoted(file));
    INFO(options << ": " << drawn.output);
    CHECK(drawn.status == 0);
    return folder.read("o.png");
  };
  const std::string plain = picture("", world);
  CHECK(picture("--camera 'Viewpoint { position 0 0 10 }'", world) == plain);
  CHECK(picture("--camera 'position=0,0,10 height=4'", world) != plain);
  CHECK(picture("--orbit 30,30 --orthographic", world) != picture("--orbit 30,30", world));
  CHECK(picture("--display wireframe --background gradient", world) != plain);
  const std::string standing = picture("", wedge);
  CHECK(picture("--up z", wedge) == standing);
  CHECK(picture("--up -z", wedge) != standing);
  // A stream keeps the up axis of the file, or of the option.
  REQUIRE(run("encode " + quoted(wedge) + " " + quoted(folder.path("w.qnv"))).status == 0);
  CHECK(run("info " + quoted(folder.path("w.qnv"))).output.find("up: z") != std::string::npos);
  REQUIRE(run("encode --up -x " + quoted(wedge) + " " + quoted(folder.path("x.qnv"))).status == 0);
  CHECK(run("info " + quoted(folder.path("x.qnv"))).output.find("up: -x") != std::string::npos);
  REQUIRE(run("export --vrml97 " + quoted(folder.path("w.qnv")) + " " + quoted(folder.path("w.wrl"))).status == 0);
  CHECK(folder.read("w.wrl").find("rotation 1 0 0 1.5707964 children Viewpoint") != std::string::npos);
  REQUIRE(run("encode --outlines " + quoted(wedge) + " " + quoted(folder.path("o.wrl"))).status == 0);
  CHECK(folder.read("o.wrl").find("rotation 1 0 0 1.5707964 children Viewpoint") != std::string::npos);
  REQUIRE(run("encode --outlines " + quoted(wedge) + " " + quoted(folder.path("o.qnv"))).status == 0);
  CHECK(run("info " + quoted(folder.path("o.qnv"))).output.find("up: z") != std::string::npos);
  CHECK(picture("", folder.path("o.qnv")) == picture("--up z", folder.path("o.qnv")));
  for (const char* wrong : {"--up w", "--camera nowhere", "--display dots", "--camera position=1,2,3 --orbit 0,0"}) {
    INFO(wrong);
    CHECK(run(std::string(wrong) + " --snapshot " + quoted(folder.path("p.png")) + " " + quoted(world)).status == 2);
  }
}

}  // namespace gs::app::picture_options_test
