// Tests of playing MovieTextures with movies of tests/fuzz/corpus/render/movie. Frame i has the grey 20 + 4 i.
#include "app/confined/decoder_pool.h"
#include "app/loading/world_loader.h"
#include "app/loading/world_loading.h"
#include "app/media/movie_player.h"
#include "app/simulation/simulation.h"
#include "tests/app/program.h"
#include "tests/app/scratch_folder.h"
#include "tests/render/media/media_files.h"

#include <catch2/catch.hpp>

#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <thread>

namespace gs::app::movie_playing_test {
namespace {

const std::string kHeader = "#VRML V2.0 utf8\n";

std::string movie(const std::string& name) {
  return media::file_text(std::string(GHOSTSPACE_TESTS) + "/fuzz/corpus/render/" + name);
}

int number_of(const render::Image& image) {
  const double grey = image.pixels[0];
  return static_cast<int>(std::lround((grey / 255 * 219 + 16 - 20) / 4));
}

struct Shown {
  int number = -1;
  std::uint64_t version = 0;
};

/// Returns the picture of a world's only texture after a time.
Shown shown_at(const std::string& fields, double seconds, const std::string& file = "movie/counting.mp4") {
  const ScratchFolder folder;
  (void)folder.write("a.mpg", movie(file));
  const std::string path =
      folder.write("main.wrl", kHeader + "Shape { appearance Appearance { texture DEF M MovieTexture { url \"a.mpg\" " +
                                   fields + " } } geometry Box { } }");
  WorldLoading loading(path, {});
  LoadedWorld opened = load_world(loading, path);
  for (const Diagnostic& one : opened.diagnostics.entries()) UNSCOPED_INFO(one.text());
  REQUIRE(opened.scene);
  Simulation simulation(std::move(opened), {64, 48});
  simulation.run(seconds);
  const View& view = simulation.look();
  REQUIRE(view.list->items.size() == 1);
  REQUIRE(view.list->items[0].texture.image);
  const render::Image& image = *view.list->items[0].texture.image;
  return {number_of(image), image.version};
}

/// Returns a running world with a movie that repeats.
std::shared_ptr<Document> counting_world() {
  const ScratchFolder folder;
  (void)folder.write("a.mpg", movie("movie/counting.mp4"));
  const std::string path = folder.write(
      "main.wrl", kHeader +
                      "Shape { appearance Appearance { texture MovieTexture { url \"a.mpg\" startTime 946684800 "
                      "loop TRUE } } geometry Box { } }");
  auto document = hold_world(load_world(path));
  begin_world(*document, kSimulatedStart);
  return document;
}

TEST_CASE("shows the movie frame at t = (now - startTime) modulo (duration / speed) while active (6.28)") {
  const std::string begin = "startTime 946684800 ";
  CHECK(shown_at(begin, 0.5).number == 12);
  CHECK(shown_at(begin, 1.01).number == 25);
  CHECK(shown_at(begin + "loop TRUE", 2.5).number == 12);
  CHECK(shown_at("startTime 946684000.1 loop TRUE", 0.63).number ==
        static_cast<int>(std::fmod(799.9 + 0.63, 2.0) * 25));
  CHECK(shown_at(begin + "speed 2", 0.51).number == 25);
  CHECK(shown_at(begin + "speed 0.5", 0.97).number == 12);
  CHECK(shown_at(begin + "loop TRUE", 2.5, "movie/counting.m1v").number == 12);
  CHECK(shown_at(begin + "loop TRUE", 2.5, "sound/tone.mpg").number == 12);
}

TEST_CASE("plays a MovieTexture backwards at negative speed, and shows its first frame at speed 0 (6.28)") {
  CHECK(shown_at("startTime 946684800 speed -1", 0.51).number == 37);
  CHECK(shown_at("startTime 946684800 speed -1 loop TRUE", 2.51).number == 37);
  CHECK(shown_at("startTime 946684800 speed -2", 0.71).number == 14);
  CHECK(shown_at("startTime 946684800 speed 0", 1).number == 0);
}

TEST_CASE("shows the first, last or stopped frame of an inactive MovieTexture (6.28)") {
  CHECK(shown_at("", 1).number == 0);
  CHECK(shown_at("speed -1", 1).number == 49);
  CHECK(shown_at("startTime 946684800 stopTime 946684800.5 loop TRUE", 1.5).number == 12);
  CHECK(shown_at("startTime 946684800", 3).number == 49);
  CHECK(shown_at("startTime 946684800 speed -1", 3).number == 0);
}

TEST_CASE("plays an animated GIF in a MovieTexture (6.28)") {
  // Each tenth of a second is lighter than the previous one.
  int before = -2;
  for (const double time : {0.05, 0.35, 0.65}) {
    const int number = shown_at("startTime 946684800 loop TRUE", time, "movie/counting.gif").number;
    CHECK(number > before);
    before = number;
  }
}

TEST_CASE("decodes movie frames to one image, without a new render item") {
  const auto document = counting_world();
  WorldRuntime& world = *document->runtime;
  const render::Image* const image = document->list->items[0].texture.image.get();
  CHECK(world.next_time().has_value());  // requests frames
  (void)world.step(kSimulatedStart + 0.5);
  CHECK(world.movies().show(true));
  CHECK(number_of(*image) == 12);
  CHECK_FALSE(world.movies().show(true));  // the same frame
  (void)world.step(kSimulatedStart + 1.01);
  CHECK(world.movies().show(true));
  CHECK(number_of(*image) == 25);
  (void)world.show(*document->first_scene, {0, 0, 10});
  CHECK(document->list->items[0].texture.image.get() == image);
  CHECK(document->first_scene->scene.gathered() == 1);
}

TEST_CASE("reports once that the process of a movie ended, and keeps the last picture") {
  set_decoder_program(program());
  const auto document = counting_world();
  WorldRuntime& world = *document->runtime;
  const render::Image* const image = document->list->items[0].texture.image.get();
  (void)world.step(kSimulatedStart + 0.5);
  CHECK(world.movies().show(true));
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
    std::ifstream list(task.path() / "children");
    for (pid_t child = 0; list >> child;) (void)::kill(child, SIGKILL);
  }
  for (const double time : {1.01, 1.21}) {
    (void)world.step(kSimulatedStart + time);
    CHECK_FALSE(world.movies().show(true));
  }
  CHECK(number_of(*image) == 12);
  std::string messages;
  for (const Diagnostic& one : document->world.diagnostics.entries()) messages += one.message + "\n";
  CHECK(messages == "MovieTexture: the process that decoded it ended by signal Killed; its last picture stays\n");
  set_decoder_program({});
}

TEST_CASE("decodes frames on another thread, and shows them a little later") {
  auto file = std::make_shared<MediaFile>(media::bytes_of(movie("movie/counting.mp4")), Share());
  const auto info = render::examine_media(file->bytes());
  REQUIRE(info.index() == 0);
  file->info = std::get<0>(info);
  MoviePlayers players;
  render::Image first{64, 32, 3, std::vector<std::uint8_t>(std::size_t{64} * 32 * 3)};
  const WorldBudget budget = own_budget();
  const auto player = players.open(file, first, budget);
  REQUIRE(player);
  CHECK_FALSE(player->shown());
  for (const int number : {3, 30, 12, 49}) {
    const double time = (number + 0.5) / 25;
    for (int i = 0; i < 5000 && number_of(*player->image()) != number; ++i) {
      (void)players.show(player, time, false);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    CHECK(number_of(*player->image()) == number);
  }
  // A movie beyond the budget is not played.
  auto small = std::make_shared<Budget>(Limits{.memory = 1 << 16});
  CHECK_FALSE(
      players.open(file, render::Image{256, 256, 3, std::vector<std::uint8_t>(std::size_t{256} * 256 * 3)}, small));
}

TEST_CASE("keeps the last frame of a movie that breaks off, and runs the world on") {
  const std::string whole = movie("sound/tone.mpg");
  for (const std::size_t part : {whole.size() / 2, whole.size() / 3}) {
    const ScratchFolder folder;
    (void)folder.write("a.mpg", whole.substr(0, part) + std::string(4000, 'x'));
    const std::string path = folder.write(
        "main.wrl", kHeader +
                        "Shape { appearance Appearance { texture MovieTexture { url \"a.mpg\" loop TRUE } } "
                        "geometry Box { } }");
    LoadedWorld opened = load_world(path);
    REQUIRE(opened.scene);
    Simulation simulation(std::move(opened), {64, 48});
    simulation.run(1.5);
    const View& view = simulation.look();
    REQUIRE(view.list->items.size() == 1);
    CHECK(view.list->items[0].texture.image);
  }
}

}  // namespace
}  // namespace gs::app::movie_playing_test
