#include "app/session/documents/world_reader.h"
#include "app/simulation/simulation.h"
#include "tests/app/late_worlds.h"

#include <catch2/catch.hpp>

#include <atomic>
#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace gs::app::url_requests_test {
namespace {

using late_worlds::kHeader;
using late_worlds::Site;

std::string picture(unsigned char shade) {
  // One grey pixel (binary PGM).
  return std::string("P5 1 1 255\n") + static_cast<char>(shade);
}

Site site() {
  Site made;
  made.put("world.wrl", kHeader +
                            "Inline { url \"one.wrl\" } Shape { geometry Box { } appearance Appearance { "
                            "texture ImageTexture { url \"dark.pgm\" } } } Group { }");
  made.put("one.wrl", kHeader + "Viewpoint { } Shape { geometry Box { } }");
  made.put(
      "two.wrl",
      kHeader + "EXTERNPROTO Cone2 [ ] \"lib.wrl\" Shape { geometry Box { } } Inline { url \"inner.wrl\" } Cone2 { }");
  made.put(
      "inner.wrl",
      kHeader + "Shape { geometry Sphere { } appearance Appearance { texture ImageTexture { url \"light.pgm\" } } }");
  made.put("lib.wrl", kHeader + "PROTO Cone2 [ ] { Shape { geometry Cone { } } }");
  made.put("dark.pgm", picture(10));
  made.put("light.pgm", picture(200));
  made.put("slow.wrl", kHeader + std::string(4000, ' ') + "Shape { geometry Cone { } }", 100);
  return made;
}

struct World : late_worlds::World {
  explicit World(const Site& site) : late_worlds::World(site, Begins::with_all_that_it_names) {}
  vrml::NodeId texture() {
    const auto appearance = scene().get<vrml::SFNode>(root(1), "appearance");
    return scene().get<vrml::SFNode>(appearance, "texture");
  }
  // Returns the shades of the items' images, -1 for none.
  std::vector<int> shades() {
    std::vector<int> all;
    for (const render::DrawItem& item : list().items)
      all.push_back(item.texture.image ? item.texture.image->pixels[0] : -1);
    return all;
  }
};

using Shades = std::vector<int>;

}  // namespace

TEST_CASE("ends a load that fails at once within its step") {
  const Site files = site();
  World world(files);
  vrml::MFString list;
  list.push_back(vrml::SFString("unknown:x"));
  CHECK(world.runtime->send(world.scene(), world.root(0), "set_url", vrml::FieldValue(list)));
  world.runtime->step(world.time += 1);
  world.loading.request(world.runtime->take_url_requests());
  CHECK_FALSE(world.loading.done());
  CHECK_FALSE(world.loading.step(std::chrono::milliseconds(1000)));
  CHECK(world.loading.done());
}

TEST_CASE("shows the new image of an ImageTexture on set_url (6.22)") {
  World world(site());
  CHECK(world.shades() == Shades{-1, 10});
  world.set_url(world.texture(), "light.pgm");
  CHECK(world.shades() == Shades{-1, 10});
  world.runtime->arrive(world.fetch());
  CHECK(world.shades() == Shades{-1, 200});
  // The url names a loaded file, a missing file, and none.
  world.set_url(world.texture(), "dark.pgm");
  world.runtime->arrive(world.fetch());
  CHECK(world.shades() == Shades{-1, 10});
  world.set_url(world.texture(), "none.pgm");
  world.runtime->arrive(world.fetch());
  CHECK(world.shades() == Shades{-1, -1});
  CHECK(world.opened.diagnostics.warnings() == 1);
  world.set_url(world.texture(), "dark.pgm");
  world.runtime->arrive(world.fetch());
  world.set_url(world.texture(), "");
  world.runtime->arrive(world.fetch());
  CHECK(world.shades() == Shades{-1, -1});
}

TEST_CASE("loads urls again after each autoRefresh, up to its time limit (X3D 9.3.2)") {
  Site files = site();
  files.put("world.wrl",
            "#X3D V4.0 utf8\nPROFILE Full\nInline { url \"part.wrl\" autoRefresh 10 autoRefreshTimeLimit 25 } "
            "Shape { geometry Box { } appearance Appearance { texture ImageTexture { url \"dark.pgm\" "
            "autoRefresh 10 } } } Group { }");
  files.put("part.wrl", kHeader + "Shape { geometry Box { } }");
  World world(files);
  CHECK(world.items() == 2);
  files.put("part.wrl", kHeader + "Shape { geometry Box { } } Shape { geometry Cone { } }");
  files.put("dark.pgm", picture(90));
  const auto refresh_at = [&](double time) {
    world.runtime->step(world.time = time);
    auto requests = world.runtime->take_url_requests();
    const std::size_t count = requests.size();
    world.loading.request(std::move(requests));
    while (!world.loading.done()) {
      (void)world.loading.step(std::chrono::milliseconds(1000));
      world.runtime->arrive(world.loading.take_updates());
    }
    world.runtime->arrive(world.loading.take_updates());
    return count;
  };
  CHECK(refresh_at(1005) == 0);
  CHECK(world.runtime->next_time().value_or(0) == 1010);
  CHECK(refresh_at(1010) == 2);
  CHECK(world.items() == 3);
  CHECK(world.shades().back() == 90);
  CHECK(refresh_at(1015) == 0);
  CHECK(refresh_at(1020) == 2);
  CHECK(refresh_at(1030) == 1);  // the time of the Inline is over
}

TEST_CASE("sets the faces of a Background one by one (6.5)") {
  Site files = site();
  files.put("world.wrl", kHeader + "Background { frontUrl \"dark.pgm\" backUrl \"light.pgm\" }");
  World world(files);
  const vrml::NodeId background = world.scene().roots()[0];
  const auto face = [&](render::Background::Face which) {
    const auto& picture = world.list().background.panorama[which];
    return picture ? int{picture->pixels[0]} : -1;
  };
  CHECK(face(render::Background::front) == 10);
  CHECK(face(render::Background::back) == 200);
  CHECK(face(render::Background::top) == -1);
  const auto set = [&](const char* event, const char* url) {
    CHECK(world.runtime->send(world.scene(), background, event, vrml::FieldValue(vrml::MFString{vrml::SFString(url)})));
    world.runtime->step(world.time += 1);
    world.runtime->arrive(world.fetch());
  };
  set("set_frontUrl", "light.pgm");
  set("set_topUrl", "dark.pgm");
  CHECK(face(render::Background::front) == 200);
  CHECK(face(render::Background::back) == 200);
  CHECK(face(render::Background::top) == 10);
  set("set_backUrl", "none.pgm");
  CHECK(face(render::Background::back) == -1);
  CHECK(face(render::Background::front) == 200);
}

TEST_CASE("drops the result of a former url") {
  World world(site());
  world.set_url(world.texture(), "light.pgm");
  ResourceUpdates former = world.fetch();
  REQUIRE(former.images.size() == 1);
  world.set_url(world.texture(), "dark.pgm");
  ResourceUpdates present = world.fetch();
  world.runtime->arrive(std::move(former));
  CHECK(world.shades() == Shades{-1, 10});
  world.runtime->arrive(std::move(present));
  CHECK(world.shades() == Shades{-1, 10});

  world.set_url(world.scene().roots()[0], "two.wrl");
  ResourceUpdates inner = world.fetch();
  world.set_url(world.scene().roots()[0], "");
  world.runtime->arrive(std::move(inner));
  CHECK(world.shades() == Shades{-1, 10});
}

TEST_CASE("replaces the content of an Inline on set_url (6.25)") {
  World world(site());
  const vrml::NodeId inlined = world.scene().roots()[0];
  const vrml::SceneGraph* const first = world.scene().inlines().of(inlined);
  REQUIRE(first);
  for (int round = 0; round < 5; ++round) {
    world.set_url(inlined, "two.wrl");
    world.runtime->arrive(world.fetch());
    CHECK(world.shades() == Shades{-1, 200, -1, 10});
    if (round == 0) CHECK(!world.runtime->execution().scenes().has(first));
    world.set_url(inlined, "one.wrl");
    world.runtime->arrive(world.fetch());
    CHECK(world.shades() == Shades{-1, 10});
  }
  world.set_url(inlined, "");
  world.runtime->arrive(world.fetch());
  CHECK(world.shades() == Shades{10});
  CHECK(!world.scene().inlines().of(inlined));
  // Only the images of the outer scene remain.
  CHECK(world.opened.images.size() == 1);
}

TEST_CASE("gives up a stalled Inline when its url is set again") {
  World world(site());
  const vrml::NodeId inlined = world.scene().roots()[0];
  world.set_url(inlined, "slow.wrl");
  world.loading.request(world.runtime->take_url_requests());
  (void)world.loading.step(std::chrono::milliseconds(20));
  CHECK(world.loading.state().waiting == 1);
  CHECK(world.loading.take_updates().contents.empty());
  world.set_url(inlined, "two.wrl");
  world.runtime->arrive(world.fetch());
  CHECK(world.shades() == Shades{-1, 200, -1, 10});
}

TEST_CASE("set_url of an Inline twice within a step stops the fetches of its inner Inlines") {
  Site files = site();
  files.put("nested.wrl", kHeader + "Inline { url \"silent.wrl\" }");
  std::atomic<bool> asked = false;
  net::network_of(files.options.memory).put("memory://a/silent.wrl", [&](const net::TransferRequest&, unsigned) {
    asked = true;
    net::MemoryAnswer answer;
    answer.answers = false;
    return answer;
  });
  World world(files);
  const vrml::NodeId inlined = world.scene().roots()[0];
  world.set_url(inlined, "nested.wrl");
  world.loading.request(world.runtime->take_url_requests());
  while (!asked) (void)world.loading.step(std::chrono::milliseconds(5));
  for (const char* const url : {"one.wrl", "two.wrl"}) {
    world.set_url(inlined, url);
    world.loading.request(world.runtime->take_url_requests());
  }
  world.runtime->arrive(world.fetch());
  CHECK(world.shades() == Shades{-1, 200, -1, 10});
}

TEST_CASE("loads the urls of nodes made at run time, on behalf of the file") {
  World world(site());
  Diagnostics diagnostics;
  const vrml::RunTimeNodes made =
      vrml::read_into(world.scene(), "script",
                      "PROTO P [ field MFString u [ ] ] { Shape { geometry Box { } appearance Appearance { "
                      "texture ImageTexture { url IS u } } } } P { u \"light.pgm\" } Inline { url \"one.wrl\" }",
                      diagnostics);
  CHECK(diagnostics.errors() == 0);
  world.runtime->execution().scenes().attach(world.scene());
  CHECK(world.runtime->send(world.scene(), world.scene().roots()[2], "addChildren", vrml::FieldValue(made.roots)));
  world.runtime->step(1001);
  world.runtime->arrive(world.fetch());
  CHECK(world.shades() == Shades{-1, 10, 200, -1});
}

TEST_CASE("continues to read requests while the world runs") {
  WorldReader reader("memory://a/world.wrl", site().options, {});
  WorldReader::News news;
  const auto wait_for = [&](const auto& there) {
    for (news = reader.take(); !there(); news = reader.take())
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
  };
  wait_for([&] { return news.document && news.document->runtime; });
  const std::shared_ptr<Document> document = news.document;
  vrml::SceneGraph& scene = *document->world.scene;
  for (const char* url : {"two.wrl", "one.wrl", "two.wrl"}) {
    vrml::MFString list;
    list.push_back(url);
    CHECK(document->runtime->send(scene, scene.roots()[0], "set_url", vrml::FieldValue(list)));
    reader.request(document->runtime->take_url_requests());
    // A late result of an earlier url changes nothing.
    const auto shown = [&] {
      const vrml::SceneGraph* const inlined = scene.inlines().of(scene.roots()[0]);
      return inlined ? inlined->file_name() : std::string();
    };
    const std::string wanted = std::string("memory://a/") + url;
    wait_for([&] {
      if (!news.updates.contents.empty()) document->runtime->arrive(std::move(news.updates));
      return shown() == wanted;
    });
    CHECK(shown() == wanted);
  }
}

}  // namespace gs::app::url_requests_test
