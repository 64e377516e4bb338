#include "app/session/documents/world_reader.h"

#include "render/image/image.h"
#include "tests/net/memory_network.h"

#include <catch2/catch.hpp>

#include <atomic>
#include <chrono>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

using namespace gs;
using namespace gs::app;

namespace {

/// Returns a world of boxes that loads in about half a second.
LoadOptions slow_world(int boxes) {
  std::string text = "#VRML V2.0 utf8\n";
  for (int i = 0; i < boxes; ++i)
    text += "Transform { translation " + std::to_string(i) + " 0 0 children Shape { geometry Box { } } }\n";
  LoadOptions options;
  options.memory = net::MakeMemoryTransport{};
  net::network_of(options.memory).put("memory://a/slow.wrl", [text](const net::TransferRequest&, unsigned) {
    net::MemoryAnswer answer;
    answer.head.content_length = text.size();
    const auto bytes = std::as_bytes(std::span(text));
    answer.body = {bytes.begin(), bytes.end()};
    answer.bytes_per_second = text.size() * 2;
    answer.block = 4096;
    return answer;
  });
  return options;
}

std::vector<WorldReader::News> all_news(WorldReader& reader) {
  std::vector<WorldReader::News> all;
  for (bool over = false; !over;) {
    WorldReader::News news = reader.take();
    over = news.over;
    if (news.document)
      all.push_back(std::move(news));
    else if (!over)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return all;
}

}  // namespace

TEST_CASE("reports visible parts while reading, and hands over the world at the end") {
  std::atomic<int> woken = 0;
  WorldReader reader("memory://a/slow.wrl", slow_world(3000), [&] { ++woken; });
  const std::vector<WorldReader::News> news = all_news(reader);
  REQUIRE(news.size() > 1);
  CHECK(woken >= static_cast<int>(news.size()));
  for (std::size_t i = 0; i + 1 < news.size(); ++i) {
    CHECK(news[i].document->is_preview);
    CHECK_FALSE(news[i].document->world.scene);
    CHECK(news[i].document->list->items.size() <= news[i + 1].document->list->items.size());
  }
  CHECK(news.front().document->list->items.size() < 3000);
  const Document& whole = *news.back().document;
  CHECK_FALSE(whole.is_preview);
  REQUIRE(whole.world.scene);
  CHECK(whole.list->items.size() == 3000);
  CHECK_FALSE(whole.world.truncated);
  reader.retire();
  while (!reader.ended()) std::this_thread::yield();
}

TEST_CASE("hands over a world before a late image, and adds the image later") {
  LoadOptions options;
  options.memory = net::MakeMemoryTransport{};
  const std::string text =
      "#VRML V2.0 utf8\nDEF T TimeSensor { loop TRUE }\n"
      "Shape { geometry IndexedFaceSet { coord Coordinate { point [ 0 0 0, 1 0 0, 0 1 0 ] } coordIndex [ 0 1 2 ] }\n"
      "appearance Appearance { texture ImageTexture { url \"late.png\" } } }\n"
      "Shape { appearance Appearance { texture ImageTexture { url \"never.png\" } } geometry Box { } }";
  const auto answer = [](std::vector<std::byte> bytes, std::size_t rate) {
    return [bytes, rate](const net::TransferRequest&, unsigned) {
      net::MemoryAnswer given;
      given.head.content_length = bytes.size();
      given.body = bytes;
      if (rate > 0) given.bytes_per_second = rate;
      given.block = 16;
      return given;
    };
  };
  const auto bytes = std::as_bytes(std::span(text));
  net::network_of(options.memory).put("memory://a/world.wrl", answer({bytes.begin(), bytes.end()}, 0));
  const auto png = render::encode_png(render::Image{2, 2, 3, std::vector<std::uint8_t>(12, 200)});
  const auto image = std::as_bytes(std::span(png));
  net::network_of(options.memory).put("memory://a/late.png", answer({image.begin(), image.end()}, png.size()));
  WorldReader reader("memory://a/world.wrl", options, {});
  std::shared_ptr<Document> document;
  bool over = false;
  ResourceUpdates updates;
  std::optional<std::size_t> waited;  // missing resources when the world was received
  while (!over) {
    WorldReader::News news = reader.take();
    over = news.over;
    if (news.document && !news.document->is_preview) {
      REQUIRE(news.document->world.scene);
      document = news.document;
      waited = over ? 0 : news.state.waiting;
      CHECK(document->runtime->next_time().has_value());  // its time advances
      CHECK(document->list->items.at(0).texture.image == nullptr);
    }
    updates.append(std::move(news.updates));
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  REQUIRE(document);
  CHECK(waited == 1u);  // the image was already counted as missing
  CHECK(updates.images.size() == 1);
  CHECK(document->world.diagnostics.warnings() + updates.diagnostics.warnings() == 1);
  document->runtime->arrive(std::move(updates));
  CHECK(document->runtime->show(*document->first_scene, {0, 0, 10}));
  REQUIRE(document->list->items.at(0).texture.image);
  CHECK(document->list->items.at(0).mesh->texture_coordinates.size() == 3);
  CHECK(document->first_scene->scene.gathered() == 1);
}

TEST_CASE("keeps the received parts of a cancelled reader, and ends one without waiting") {
  WorldReader reader("memory://a/slow.wrl", slow_world(3000), {});
  while (!reader.take().document) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  reader.cancel();
  const std::vector<WorldReader::News> news = all_news(reader);
  const Document& part = *news.back().document;
  REQUIRE(part.world.scene);
  CHECK(part.world.truncated);
  CHECK(part.list->items.size() > 0);
  CHECK(part.list->items.size() < 3000);
  const WorldReader dropped("memory://a/slow.wrl", slow_world(30000), {});
  WorldReader none("memory://a/none.wrl", slow_world(1), {});
  const std::vector<WorldReader::News> failed = all_news(none);
  CHECK_FALSE(failed.back().document->world.scene);
  CHECK(failed.back().document->world.diagnostics.errors() == 1);
}
