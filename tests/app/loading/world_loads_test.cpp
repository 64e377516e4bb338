// Tests of the load ledger's rows for the files of a world.
#include "app/loading/world_loading.h"
#include "app/streams/load_ledger.h"

#include "tests/app/late_worlds.h"
#include "vrml/syntax/printer.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <vector>

namespace gs::app::world_loads_test {

using late_worlds::kHeader;
using late_worlds::Site;

struct Loads {
  explicit Loads(Site& site) {
    site.options.ledger = ledger;
    loading = std::make_unique<WorldLoading>("memory://a/world.wrl", site.options);
  }
  void finish() {
    while (!loading->done()) (void)loading->step(std::chrono::milliseconds(10));
  }
  [[nodiscard]] LoadRow row(const std::string& name) const {
    for (LoadRow& one : ledger->rows())
      if (one.url.ends_with("/" + name)) return std::move(one);
    return {};
  }
  std::shared_ptr<LoadLedger> ledger = std::make_shared<LoadLedger>();
  std::unique_ptr<WorldLoading> loading;
};

TEST_CASE("has one row per file of a world, with its bytes, its end and its first appearance") {
  Site site;
  const std::string part = kHeader + "Shape { geometry Box { } }";
  site.put("world.wrl", kHeader +
                            "Inline { url \"part.wrl\" } Shape { appearance Appearance { texture "
                            "ImageTexture { url [ \"none.png\" \"grey.pgm\" ] } } } "
                            "Inline { url \"missing.wrl\" }");
  site.put("part.wrl", part);
  site.put("grey.pgm", std::string("P5 1 1 255\n") + "x");
  Loads loads(site);
  loads.finish();
  CHECK(loads.ledger->rows().size() == 4);
  CHECK(loads.row("world.wrl").stage == LoadStage::whole);
  CHECK(loads.row("world.wrl").kind == "memory");
  CHECK(loads.row("part.wrl").stage == LoadStage::whole);
  CHECK(loads.row("part.wrl").received == part.size());
  CHECK(loads.row("part.wrl").total == part.size());
  CHECK(loads.row("part.wrl").first_picture);
  CHECK(loads.row("part.wrl").node);
  // The second url has the image. Its row has the name of the first url.
  CHECK(loads.row("grey.pgm").stage == LoadStage::whole);
  CHECK(loads.row("none.png").number == 0);
  const LoadRow missing = loads.row("missing.wrl");
  CHECK(missing.stage == LoadStage::failed);
  CHECK_FALSE(missing.why.empty());
  CHECK_FALSE(missing.first_picture);
}

TEST_CASE("leaves out a cancelled file, and loads the rest of the world") {
  Site site;
  site.put("world.wrl", kHeader + "Inline { url \"never.wrl\" } Inline { url \"part.wrl\" }");
  site.never("never.wrl");
  site.put("part.wrl", kHeader + "Shape { geometry Box { } }");
  Loads loads(site);
  while (loads.row("never.wrl").number == 0 || !loads.row("part.wrl").ended)
    (void)loads.loading->step(std::chrono::milliseconds(10));
  CHECK(loads.row("never.wrl").stage == LoadStage::waiting);
  CHECK_FALSE(loads.loading->done());
  loads.ledger->cancel(loads.row("never.wrl").number);
  loads.finish();
  CHECK(loads.row("never.wrl").stage == LoadStage::cancelled);
  const LoadedWorld world = loads.loading->take();
  CHECK_FALSE(world.scene->inlines().of(world.scene->roots()[0]));
  CHECK(world.scene->inlines().of(world.scene->roots()[1]));
}

TEST_CASE("keeps the loaded part of a cancelled world") {
  Site site;
  site.put("world.wrl", kHeader + "Shape { geometry Box { } } " + std::string(100'000, ' ') + "Group { }", 2000);
  Loads loads(site);
  while (loads.row("world.wrl").received < kHeader.size() + 40)
    (void)loads.loading->step(std::chrono::milliseconds(10));
  loads.ledger->cancel(loads.row("world.wrl").number);
  loads.finish();
  CHECK(loads.row("world.wrl").stage == LoadStage::cancelled);
  const LoadedWorld world = loads.loading->take();
  REQUIRE(world.scene);
  CHECK(world.truncated);
  CHECK(vrml::print(*world.scene).find("Box") != std::string::npos);
}

}  // namespace gs::app::world_loads_test
