#include "app/saving/scene_formats.h"

#include "app/loading/world_loader.h"
#include "app/saving/scene_text.h"
#include "tests/app/scratch_folder.h"

#include <catch2/catch.hpp>

#include <string>

namespace gs::app::scene_formats_test {

TEST_CASE("selects the text format of a scene by the extension") {
  const auto grammar = [](const char* path) {
    const SceneFormat* const format = scene_format_of(path);
    REQUIRE(format);
    return format->grammar;
  };
  CHECK(grammar("A.WRL") == vrml::Grammar::vrml97);
  CHECK(grammar("a.wrl.gz") == vrml::Grammar::vrml97);
  CHECK(grammar("a.x3d") == vrml::Grammar::x3d_xml);
  CHECK(grammar("a.x3dz") == vrml::Grammar::x3d_xml);
  CHECK(grammar("a.b.x3dv") == vrml::Grammar::x3d_classic);
  CHECK(grammar("a.x3dj") == vrml::Grammar::x3d_json);
  CHECK_FALSE(scene_format_of("a.patches.wrl"));
  CHECK_FALSE(scene_format_of("a.glb"));
  CHECK(is_packed_path("A.X3DVZ"));
  CHECK(is_packed_path("a.x3d.gz"));
  CHECK_FALSE(is_packed_path("a.x3d"));
  for (const SceneFormat& format : scene_formats()) CHECK(&scene_format_of(format.grammar) == &format);
}

TEST_CASE("writes a scene for another folder, with its URLs and embedded textures") {
  const ScratchFolder folder;
  folder.write("b.png", "no picture");
  const std::string path = folder.write("a.wrl",
                                        "#VRML V2.0 utf8\nInline { url \"none.wrl\" }\nShape { appearance Appearance { "
                                        "texture ImageTexture { url \"b.png\" } } }\nPROTO P [ field MFString url "
                                        "\"b.png\" ] { Group { } }\nEXTERNPROTO E [ ] \"b.png\"\n");
  LoadOptions options;
  options.references = false;
  LoadedWorld world = load_world(path, options);
  REQUIRE(world.scene);
  const std::string here = scene_text(world, vrml::Grammar::x3d_xml, folder.path("c.x3d")).text;
  CHECK(here.find("<ImageTexture url='\"b.png\"'/>") != std::string::npos);
  const std::string there = scene_text(world, vrml::Grammar::x3d_xml, folder.path("sub/c.x3d")).text;
  CHECK(there.find("<ImageTexture url='\"../b.png\"'/>") != std::string::npos);
  CHECK(there.find("name='url' value='\"../b.png\"'") != std::string::npos);
  CHECK(there.find("<ExternProtoDeclare name='E' url='\"../b.png\"'>") != std::string::npos);
  CHECK(there.find("<Inline url='\"none.wrl\"'/>") != std::string::npos);
}

}  // namespace gs::app::scene_formats_test
