#include "app/loading/world_loader.h"
#include "tests/app/scratch_folder.h"

#include <catch2/catch.hpp>

#include <fstream>
#include <iterator>
#include <string>

namespace gs::app::movie_texture_test {

namespace {

std::string corpus(const std::string& name) {
  std::ifstream file(std::string(GHOSTSPACE_TESTS) + "/fuzz/corpus/render/" + name, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST_CASE("shows the first frame of a MovieTexture (VRML97 6.28)") {
  const ScratchFolder folder;
  const std::string header = "#VRML V2.0 utf8\n";
  const std::string movie = corpus("mpeg_system_stream/red_blue.mpg");
  REQUIRE(movie.size() > 1000);
  (void)folder.write("good.mpg", movie);
  (void)folder.write("cut.mpg", movie.substr(0, 40));
  const auto world_of = [&](const std::string& url) {
    return load_world(folder.write("main.wrl", header +
                                                   "Shape { appearance Appearance { texture MovieTexture { url [ " +
                                                   url + " ] } } geometry Box { } }\n"));
  };
  const LoadedWorld good = world_of("\"good.mpg\"");
  REQUIRE(good.scene);
  CHECK(good.diagnostics.entries().empty());
  REQUIRE(good.images.size() == 1);
  const render::Image& image = *good.images.begin()->second;
  CHECK(image.width == 48);
  CHECK(image.height == 32);
  CHECK(image.pixels[0] > 200);  // red
  CHECK(image.pixels[2] < 60);

  // Urls are tried in order of preference.
  CHECK(world_of("\"none.mpg\" \"good.mpg\"").images.size() == 1);

  const LoadedWorld cut = world_of("\"cut.mpg\"");
  REQUIRE(cut.scene);
  CHECK(cut.images.empty());
  REQUIRE(cut.diagnostics.entries().size() == 1);
  const std::string text = cut.diagnostics.entries().front().text();
  INFO(text);
  CHECK(text.find("main.wrl:2:") != std::string::npos);
  CHECK(text.find("MovieTexture") != std::string::npos);
  CHECK(text.find("cut.mpg") != std::string::npos);
}

}  // namespace
}  // namespace gs::app::movie_texture_test
