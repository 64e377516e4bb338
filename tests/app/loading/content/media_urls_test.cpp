#include "app/loading/world_loader.h"
#include "app/media/media_file.h"
#include "app/session/documents/documents.h"
#include "tests/app/scratch_folder.h"
#include "tests/render/media/media_files.h"

#include <catch2/catch.hpp>

#include <string>
#include <vector>

namespace gs::app::media_urls_test {
namespace {

const std::string kHeader = "#VRML V2.0 utf8\n";

std::vector<std::string> texts_of(const LoadedWorld& world) {
  std::vector<std::string> texts;
  for (const Diagnostic& one : world.diagnostics.entries()) texts.push_back(one.text());
  return texts;
}

TEST_CASE("plays the first readable url of an AudioClip (4.5.2, 6.4)") {
  const ScratchFolder folder;
  (void)folder.write("good.wav", media::tone(0.25));
  (void)folder.write("bad.wav", media::tone(0.25).substr(0, 30));
  (void)folder.write("text.wav", "no sound at all");
  const auto world_of = [&](const std::string& url) {
    return load_world(folder.write("main.wrl", kHeader + "Sound { source AudioClip { url [ " + url + " ] } }\n"));
  };
  for (const char* url : {"\"good.wav\"", "\"none.wav\" \"good.wav\"", "\"bad.wav\" \"text.wav\" \"good.wav\""}) {
    INFO(url);
    const LoadedWorld world = world_of(url);
    REQUIRE(world.scene);
    CHECK(texts_of(world).empty());
    REQUIRE(world.media.size() == 1);
    CHECK(world.media.begin()->second->info.duration == Approx(0.25));
    CHECK(world.media.begin()->second->name.ends_with("good.wav"));
    REQUIRE(world.durations.size() == 1);
    CHECK(world.durations[0].seconds == Approx(0.25));
  }
  const LoadedWorld none = world_of("\"bad.wav\" \"text.wav\"");
  CHECK(none.media.empty());
  REQUIRE(none.durations.size() == 1);
  CHECK(none.durations[0].seconds == -1);
  REQUIRE(texts_of(none).size() == 1);
  CHECK(texts_of(none)[0].find("main.wrl:2:") != std::string::npos);
  CHECK(texts_of(none)[0].find("AudioClip") != std::string::npos);
  CHECK(texts_of(none)[0].find("text.wav") != std::string::npos);
  // The message also has the reason.
  CHECK(texts_of(world_of("\"bad.wav\""))[0].find("broken WAV") != std::string::npos);
  CHECK(texts_of(world_of("\"none.wav\"")).size() == 1);
}

TEST_CASE("plays sounds in data: URLs, and reads a shared file once") {
  const ScratchFolder folder;
  const std::string bytes = media::wav(8000, 1, 800, [](std::size_t, int) { return 0.5; });
  std::string data = "data:audio/wav,";
  for (const char letter : bytes) {
    constexpr char kDigits[] = "0123456789abcdef";
    data += '%';
    data += kDigits[static_cast<unsigned char>(letter) >> 4];
    data += kDigits[static_cast<unsigned char>(letter) & 15];
  }
  (void)folder.write("a.wav", bytes);
  const LoadedWorld world =
      load_world(folder.write("main.wrl", kHeader + "Sound { source AudioClip { url \"" + data +
                                              "\" } } Sound { source AudioClip { url \"a.wav\" } } "
                                              "Sound { source AudioClip { url \"a.wav\" } }"));
  CHECK(texts_of(world).empty());
  REQUIRE(world.durations.size() == 3);
  for (const MediaDuration& one : world.durations) CHECK(one.seconds == Approx(0.1));
  CHECK(world.media.at(&world.durations[1].scene->node(world.durations[1].node)) ==
        world.media.at(&world.durations[2].scene->node(world.durations[2].node)));
}

TEST_CASE("leaves out a sound beyond the budget, with a message") {
  const ScratchFolder folder;
  (void)folder.write("a.wav", media::constant(5));
  LoadOptions options;
  options.limits.memory = 400'000;
  const LoadedWorld world =
      load_world(folder.write("main.wrl", kHeader + "Sound { source AudioClip { url \"a.wav\" } }"), options);
  REQUIRE(world.scene);
  CHECK(world.media.empty());
  REQUIRE(texts_of(world).size() == 1);
  INFO(texts_of(world)[0]);
  CHECK(texts_of(world)[0].find("--memory") != std::string::npos);
}

TEST_CASE("loads another sound on set_url in a running world, and sends duration_changed (6.4)") {
  const ScratchFolder folder;
  (void)folder.write("a.wav", media::tone(0.25));
  const auto document =
      hold_world(load_world(folder.write("main.wrl", kHeader + "Sound { source DEF C AudioClip { url \"a.wav\" } }")));
  std::vector<double> durations;
  document->runtime->execution().cascade().observe([&](const vrml::SentEvent& event) {
    if (event.event->name == "duration_changed") durations.push_back(std::get<vrml::SFTime>(*event.value));
  });
  begin_world(*document, 1000);
  CHECK(durations == std::vector<double>{0.25});
  vrml::SceneGraph& scene = *document->world.scene;
  const vrml::NodeId clip = scene.get<vrml::SFNode>(scene.roots()[0], "source");
  (void)document->runtime->step(1001);
  REQUIRE(document->runtime->send(scene, clip, "set_url", vrml::MFString{vrml::SFString("b.wav")}));
  const auto requests = document->runtime->take_url_requests();
  REQUIRE(requests.size() == 1);
  CHECK(requests[0].content == vrml::UrlContent::sound);
  ResourceUpdates updates;
  auto file = std::make_shared<MediaFile>(media::bytes_of(media::tone(0.5)), Share());
  file->info = {0.5, false, true};
  updates.media.push_back({{requests[0].place}, file, nullptr});
  (void)arrive(*document, std::move(updates));
  (void)document->runtime->step(1002);
  CHECK(durations == std::vector<double>{0.25, 0.5});
  CHECK(document->world.media.at(&scene.node(clip)) == file);
}

}  // namespace
}  // namespace gs::app::media_urls_test
