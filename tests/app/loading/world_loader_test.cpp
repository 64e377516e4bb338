#include "app/loading/world_loader.h"

#include "app/formats/content_types.h"
#include "base/gzip.h"
#include "tests/app/scratch_folder.h"
#include "tests/app/worlds.h"
#include "tests/gzip.h"

#include <catch2/catch.hpp>

#include <string>
#include <tuple>
#include <vector>

using namespace gs::app;
using namespace gs;

namespace {

std::span<const std::byte> byte_span_of(std::string_view text) { return std::as_bytes(std::span(text)); }

const std::string kBoxWorld = "#VRML V2.0 utf8\nShape { geometry Box { } }\n";
// One red pixel.
const std::string kGif(
    "GIF89a\x01\x00\x01\x00\x80\x00\x00\xff\x00\x00\x00\x00\x00,"
    "\x00\x00\x00\x00\x01\x00\x01\x00\x00\x02\x02\x44\x01\x00;",
    35);

}  // namespace

TEST_CASE("gunzip: reads members, and reports truncation, damage and limits") {
  const std::string text(300000, 'x');
  const std::string packed = test::deflated(text);
  std::string out;
  const auto sink = [&](std::string_view piece) {
    out += piece;
    return true;
  };
  CHECK(is_gzip(byte_span_of(packed)));
  CHECK_FALSE(is_gzip(byte_span_of(kBoxWorld)));
  CHECK_FALSE(gunzip(byte_span_of(packed), own_budget(), sink));
  CHECK(out == text);
  out.clear();
  CHECK_FALSE(gunzip(byte_span_of(test::deflated(std::string("one")) + test::deflated(std::string("two"))),
                     own_budget(), sink));
  CHECK(out == "onetwo");
  out.clear();
  const auto small = std::make_shared<Budget>(Limits{.memory = 1024});
  CHECK(gunzip(byte_span_of(packed), small, sink)->find("more than the limit for unpacked data") != std::string::npos);
  CHECK(out == text.substr(0, 1024));
  for (std::size_t size = 0; size < packed.size(); ++size) {
    const std::vector<char> exact(packed.begin(), packed.begin() + static_cast<std::ptrdiff_t>(size));
    CHECK(gunzip(byte_span_of({exact.data(), exact.size()}), own_budget(), sink));
  }
  for (std::size_t i = 10; i < packed.size(); ++i) {
    std::string damaged = packed;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x40);
    std::string result;
    const auto problem = gunzip(byte_span_of(damaged), own_budget(), [&](std::string_view piece) {
      result += piece;
      return true;
    });
    CHECK((problem || result == text));
  }
}

TEST_CASE("gunzip: reads pieces of any size as one text, and reports errors at the end") {
  const std::string text = "one, " + std::string(300000, 'x'),
                    packed = test::deflated(text) + test::deflated(std::string("two")) + "rest";
  for (const std::size_t size : {1ul, 2ul, 3ul, 7ul, 1000ul}) {
    Gunzip unpacking(own_budget());
    std::string out;
    const auto sink = [&](std::string_view piece) {
      out += piece;
      return true;
    };
    bool more = true;
    for (std::size_t at = 0; at < packed.size() && more; at += size)
      more = unpacking.push(byte_span_of(packed.substr(at, size)), sink);
    CHECK_FALSE(more);  // ignores bytes after the last member
    CHECK_FALSE(unpacking.finish());
    CHECK(out == text + "two");
  }
  Gunzip early(own_budget());
  CHECK(early.push(byte_span_of(packed.substr(0, 40)), [](std::string_view) { return true; }));
  CHECK(early.finish()->find("truncated") != std::string::npos);
  Gunzip stopped(own_budget());
  CHECK_FALSE(stopped.push(byte_span_of(packed), [](std::string_view) { return false; }));
  CHECK_FALSE(stopped.finish());
}

TEST_CASE("opens gzip'd worlds under any name, and shows the beginning of a truncated one") {
  const ScratchFolder folder;
  const std::string packed = test::deflated(std::string(kBoxWorld));
  for (const char* name : {"a.wrl", "a.wrz", "a.wrl.gz", "a"}) {
    const LoadedWorld world = load_world(folder.write(name, packed));
    REQUIRE(world.scene);
    CHECK(world.scene->roots().size() == 1);
    CHECK(world.diagnostics.errors() == 0);
    CHECK(world.bytes == packed.size());
  }
  std::string large = "#VRML V2.0 utf8\n";
  for (int i = 0; i < 5000; ++i)
    large += "Shape { geometry Sphere { radius " + std::to_string(i * 7919 % 1000) + " } }\n";
  const std::string packed_large = test::deflated(large);
  const LoadedWorld world = load_world(folder.write("cut.wrl", packed_large.substr(0, packed_large.size() / 2)));
  REQUIRE(world.scene);
  CHECK(world.truncated);
  CHECK(world.scene->roots().size() > 1000);
  CHECK(said(world).find("the gzip data is truncated") != std::string::npos);
}

TEST_CASE("reports in one line why a file cannot be opened") {
  const ScratchFolder folder;
  const auto refused = [&](const std::string& path, const std::string& word) {
    const LoadedWorld world = load_world(path);
    CHECK_FALSE(world.scene);
    CHECK(world.diagnostics.entries().size() == 1);
    INFO(said(world));
    CHECK(said(world).find(word) != std::string::npos);
  };
  refused(folder.path("missing.wrl"), "missing.wrl: error: ");
  refused(folder.path(""), "error: ");
  refused(folder.write("empty.wrl", ""), "the file is empty");
  refused(folder.write("empty.stl", ""), "the file is empty");
  refused(folder.write("binary.wrl", std::string(100, '\0') + "abc"), "data of an unknown format");
  refused(folder.write("one.iv", "#Inventor V2.1 binary\n"), "binary Inventor cannot be read");
  refused("gopher://example.org/a.wrl", "gopher");
}

TEST_CASE("detects the type of a file by its first bytes, then by its name") {
  const auto name_of = [](std::string_view path, std::string_view bytes) {
    return content_type_of(path, byte_span_of(bytes)).name;
  };
  const std::tuple<const char*, const char*, const char*> types[] = {{"a.stl", "#VRML V2.0 utf8\n", "VRML97"},
                                                                     {"a.wrl", "ply\nformat", "PLY"},
                                                                     {"a", "glTF", "glTF"},
                                                                     {"A.OBJ", "v 0 0 0", "OBJ"},
                                                                     {"a.stl.gz", "solid", "STL"},
                                                                     {"folder.stl/readme", "hello", "VRML97"}};
  for (const auto& [path, bytes, type] : types) CHECK(name_of(path, bytes) == type);
}

TEST_CASE("finds Inlines, EXTERNPROTOs and textures beside the file, in any letter case") {
  const ScratchFolder folder;
  folder.write("parts/Box.wrl", kBoxWorld);
  folder.write("parts/lib.wrl",
               "#VRML V2.0 utf8\nPROTO A [ ] { Group { } } PROTO B [ field SFFloat r 2 ] { Sphere { radius IS r } }\n");
  folder.write("img/Red.GIF", kGif);
  const LoadedWorld world = load_world(
      folder.write("main.wrl",
                   "#VRML V2.0 utf8\nEXTERNPROTO B [ field SFFloat r ] [ \"nowhere.wrl#B\" \"parts/lib.wrl#B\" ]\n"
                   "Inline { url [ \"urn:nobody:box\" \"PARTS\\box.wrl\" ] }\nShape { geometry B { r 5 } appearance "
                   "Appearance { texture "
                   "ImageTexture { url \"img/red.gif\" } } }\n"));
  INFO(said(world));
  REQUIRE(world.scene);
  CHECK(world.diagnostics.entries().empty());
  REQUIRE(world.scene->inlines().of(world.scene->roots()[0]));
  CHECK(world.scene->inlines().of(world.scene->roots()[0])->roots().size() == 1);
  const auto shape = world.scene->roots()[1];
  const auto sphere = world.scene->resolve(world.scene->get<vrml::SFNode>(shape, "geometry"));
  REQUIRE(sphere);
  REQUIRE(world.scene->node(sphere).type->name == "Sphere");
  CHECK(world.scene->get<float>(sphere, "radius") == 5);
  REQUIRE(world.images.size() == 1);
  CHECK(world.images.begin()->second->width == 1);
}

TEST_CASE("loads the panorama images of a Background, each file once") {
  const ScratchFolder folder;
  folder.write("sky/side.gif", kGif);
  folder.write("top.gif", kGif);
  const LoadedWorld world = load_world(
      folder.write("main.wrl",
                   "#VRML V2.0 utf8\nBackground { frontUrl \"sky/side.gif\" backUrl [ \"gone.gif\" \"sky/side.gif\" ] "
                   "leftUrl \"sky/side.gif\" topUrl \"top.gif\" bottomUrl \"gone.gif\" rightUrl \"\" }\n"));
  REQUIRE(world.scene);
  const vrml::Node* node = &world.scene->node(world.scene->roots()[0]);
  using render::Background;
  for (const auto face : {Background::front, Background::back, Background::left, Background::top}) {
    INFO("face " << face);
    REQUIRE(world.images.contains({node, face}));
    CHECK(world.images.at({node, face})->width == 1);
  }
  CHECK(world.images.at({node, Background::front}) == world.images.at({node, Background::left}));
  CHECK(world.images.size() == 4);
  CHECK(said(world).find("warning: Background: cannot find 'gone.gif'") != std::string::npos);
  CHECK(world.diagnostics.entries().size() == 1);
}

TEST_CASE("leaves out broken and cyclic references, and reports them") {
  const ScratchFolder folder;
  folder.write("b.wrl", "#VRML V2.0 utf8\nInline { url \"a.wrl\" }\nShape { }\n");
  folder.write("x.png", "no picture");
  const LoadedWorld world = load_world(
      folder.write("a.wrl",
                   "#VRML V2.0 utf8\nInline { url \"b.wrl\" }\nInline { url [ \"gone.wrl\" \"http://x/y.wrl\" ] }\n"
                   "Shape { appearance Appearance { texture ImageTexture { url \"x.png\" } } }\nEXTERNPROTO P [ ] "
                   "\"gone2.wrl\" P { }\n"));
  REQUIRE(world.scene);
  const std::string text = said(world);
  CHECK(text.find("Inline refers back to") != std::string::npos);
  CHECK(text.find("a.wrl:3:1: warning: Inline: cannot find 'gone.wrl' or the 1 others") != std::string::npos);
  CHECK(text.find("x.png: ") != std::string::npos);
  CHECK(text.find("EXTERNPROTO P: cannot find 'gone2.wrl'") != std::string::npos);
  CHECK(world.images.empty());
}

TEST_CASE("ignores an empty url, and searches a url from a server's root in the folders above") {
  const ScratchFolder folder;
  const auto texture = [](const std::string& url) {
    return "#VRML V2.0 utf8\nShape { geometry Box { } appearance Appearance { texture ImageTexture { url \"" + url +
           "\" } } }\nInline { url \"\" }\n";
  };
  CHECK(said(load_world(folder.write("empty.wrl", texture("")))).empty());
  (void)folder.write("pictures/red.gif", kGif);
  const LoadedWorld rooted = load_world(folder.write("rooted.wrl", texture("/pictures/red.gif")));
  CHECK(said(rooted).empty());
  CHECK(rooted.images.size() == 1);
  // Files in folders that the world may not read are not found.
  (void)folder.write("inner/outer.gif", kGif);
  const LoadedWorld outside = load_world(folder.write("inner/deep/world.wrl", texture("/outer.gif")));
  CHECK(outside.images.empty());
  CHECK(outside.diagnostics.warnings() == 1);
}

TEST_CASE("reads only the first bytes on request, without errors about the rest") {
  const ScratchFolder folder;
  LoadOptions options;
  options.max_bytes = 60;
  const LoadedWorld world =
      load_world(folder.write("a.wrl", kBoxWorld + kBoxWorld.substr(16) + kBoxWorld.substr(16)), options);
  REQUIRE(world.scene);
  CHECK(world.bytes == 60);
  CHECK_FALSE(world.truncated);
  CHECK(world.scene->roots().size() == 2);
}

TEST_CASE("data: URLs hold worlds, textures and libraries") {
  const ScratchFolder folder;
  const LoadedWorld world = load_world(
      folder.write("a.wrl",
                   "#VRML V2.0 utf8\nInline { url \"data:model/vrml,%23VRML%20V2.0%20utf8%0AShape%20%7B%20%7D\" }\n"
                   "Inline { url \"data:;base64,a*bc\" }\n"));
  INFO(said(world));
  REQUIRE(world.scene);
  REQUIRE(world.scene->inlines().of(world.scene->roots()[0]));
  CHECK(world.scene->inlines().of(world.scene->roots()[0])->roots().size() == 1);
  CHECK(world.diagnostics.warnings() == 1);
}

TEST_CASE("leaves out a bitmap of height 0 in a data: URL with a message") {
  const ScratchFolder folder;
  const std::string bitmap =
      "Qk12AAAAAAAAAHYAAAAoAAAACQAAAAAAAAABAAQAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAABEREQAiIiIAMzMzAERE"
      "RABVVVUAZmZmAHd3dwCIiIgAmZmZAKqqqgC7u7sAzMzMAN3d3QDu7u4A////AA==";
  const LoadedWorld world =
      load_world(folder.write("a.wrl",
                              "#VRML V2.0 utf8\nShape { appearance Appearance { texture ImageTexture { url "
                              "\"data:image/bmp;base64," +
                                  bitmap + "\" } } geometry Box { } }\n"));
  INFO(said(world));
  REQUIRE(world.scene);
  CHECK(world.images.empty());
  CHECK(said(world).find("it has no pixels; its size is 9 x 0") != std::string::npos);
}
