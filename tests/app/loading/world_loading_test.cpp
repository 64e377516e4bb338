// Tests of worlds from a scripted network.
#include "app/loading/world_loading.h"

#include "app/streams/stream_feed.h"
#include "qnv/codecs/octree/lod/lod.h"
#include "qnv/reader/stream_decoder.h"
#include "tests/app/geometry_shapes.h"
#include "tests/app/large_stream.h"
#include "tests/app/scratch_folder.h"
#include "tests/app/worlds.h"
#include "tests/geometries.h"
#include "tests/net/memory_network.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

using namespace gs;
using namespace gs::app;
using test::bytes_of;

namespace {

constexpr std::chrono::milliseconds kLoadingWait{50};

/// Network of well-behaved resources, with the options to read from it.
struct Web {
  std::shared_ptr<net::MemoryNetwork> network = std::make_shared<net::MemoryNetwork>();
  LoadOptions options;

  Web() {
    options.memory = net::MakeMemoryTransport{network};
    options.timeout_seconds = 60;
  }
  void put(const std::string& url, std::string_view text, const std::string& version = "\"1\"") {
    net::MemoryResource resource;
    resource.bytes = bytes_of(text);
    resource.validator.etag = version;
    network->put(url, std::move(resource));
  }
  void put_script(const std::string& url, net::MemoryNetwork::Answer answer) { network->put(url, std::move(answer)); }
};

/// Returns a server's answer to a whole request of `text`.
net::MemoryAnswer whole(std::string_view text) {
  net::MemoryAnswer answer;
  answer.head.content_length = text.size();
  answer.body = bytes_of(text);
  return answer;
}

std::string boxes(int count) {
  std::string text = "#VRML V2.0 utf8\n";
  for (int i = 0; i < count; ++i)
    text += "Transform { translation " + std::to_string(i) + " 0 0 children Shape { geometry Box { } } }\n";
  return text;
}

}  // namespace

TEST_CASE("asks for a coarse version only of volumes that a server reached by ssh encodes") {
  LoadOptions options;
  options.by_view = true;
  const auto coarse = [&](const std::string& path) { return coarse_url_of(path, options); };
  CHECK(coarse("ssh://ann@host/runs/a.h5") == "ssh://ann@host/runs/a.h5.coarse.qnv?from=8388608");
  CHECK(coarse("ssh://host/~/run.nrrd") == "ssh://host/~/run.nrrd.coarse.qnv?from=8388608");
  for (const char* const other : {"run.nrrd", "https://host/run.nrrd", "ssh://host/run.qnv", "ssh://host/scan.stl",
                                  "ssh://host/image.zarr", "ssh://host/run.nrrd?from=1"})
    CHECK(coarse(other).empty());
  options.by_view = false;
  CHECK(coarse("ssh://host/run.nrrd").empty());
}

TEST_CASE("shows a world before its file ends, with more of it each time") {
  Web web;
  const std::string text = boxes(3000);
  web.put_script("memory://a/slow.wrl", [&](const net::TransferRequest&, unsigned) {
    net::MemoryAnswer answer = whole(text);
    answer.bytes_per_second = text.size() * 2;
    answer.block = 8192;
    return answer;
  });
  WorldLoading loading("memory://a/slow.wrl", web.options);
  std::vector<std::size_t> seen;
  while (!loading.done()) {
    (void)loading.step(kLoadingWait);
    if (!loading.changed()) continue;
    const std::size_t items = loading.collect({0, 0, 10}).items.size();
    if (!seen.empty()) CHECK(items >= seen.back());
    seen.push_back(items);
    CHECK(loading.state().received <= text.size());
    CHECK(loading.state().total == text.size());
  }
  REQUIRE(seen.size() > 3);
  CHECK(seen.front() < 1000);
  CHECK(seen.back() == 3000);
  const LoadedWorld world = loading.take();
  CHECK(world.diagnostics.entries().empty());
  CHECK(world.bytes == text.size());
}

TEST_CASE("shows a long IndexedFaceSet during loading") {
  Web web;
  std::string text = "#VRML V2.0 utf8\nShape { geometry IndexedFaceSet { coord Coordinate { point [ ";
  for (int i = 0; i < 2000; ++i)
    text += std::to_string(i) + " " + std::to_string(i % 7) + " " + std::to_string(i % 3) + ",";
  text += " ] } coordIndex [ ";
  for (int i = 0; i + 2 < 2000; ++i)
    text += std::to_string(i) + " " + std::to_string(i + 1) + " " + std::to_string(i + 2) + " -1 ";
  text += "] } }\n";
  web.put_script("memory://a/mesh.wrl", [&](const net::TransferRequest&, unsigned) {
    net::MemoryAnswer answer = whole(text);
    answer.bytes_per_second = text.size() * 3;
    answer.block = 4096;
    return answer;
  });
  WorldLoading loading("memory://a/mesh.wrl", web.options);
  std::vector<std::size_t> triangles;
  while (!loading.done()) {
    (void)loading.step(kLoadingWait);
    if (!loading.changed()) continue;
    const render::RenderList list = loading.collect({0, 0, 10});
    if (!list.items.empty()) triangles.push_back(list.items[0].mesh->indices.size() / 3);
  }
  REQUIRE(triangles.size() > 2);
  CHECK(std::is_sorted(triangles.begin(), triangles.end()));
  CHECK(triangles.front() < 1900);
  // As many triangles as without pieces; slivers without area are omitted.
  web.put("memory://a/whole.wrl", text);
  WorldLoading at_once("memory://a/whole.wrl", web.options);
  while (!at_once.done()) (void)at_once.step(kLoadingWait);
  CHECK(triangles.back() == at_once.collect({0, 0, 10}).items[0].mesh->indices.size() / 3);
}

TEST_CASE("loads Inlines, libraries, textures and importers' files from beside the document") {
  Web web;
  web.put("memory://a/main.wrl",
          "#VRML V2.0 utf8\nEXTERNPROTO B [ field SFFloat r ] [ \"none.wrl#B\" \"sub/lib.wrl#B\" ]\n"
          "Inline { url \"sub/in.wrl\" }\nShape { geometry B { r 5 } appearance Appearance { texture ImageTexture { "
          "url \"sub/p.gif\" } } }\nInline { url \"sub/m.obj\" }\n");
  web.put("memory://a/sub/lib.wrl", "#VRML V2.0 utf8\nPROTO B [ field SFFloat r 2 ] { Sphere { radius IS r } }\n");
  web.put("memory://a/sub/in.wrl", "#VRML V2.0 utf8\nInline { url \"deep.wrl\" }\n");
  web.put("memory://a/sub/deep.wrl", boxes(2));
  web.put("memory://a/sub/p.gif",
          std::string_view("GIF89a\1\0\1\0\x80\0\0\xff\0\0\0\0\0,\0\0\0\0\1\0\1\0\0\2\2D\1\0;", 35));
  web.put("memory://a/sub/m.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl green\nf 1 2 3\n");
  web.put("memory://a/sub/m.mtl", "newmtl green\nKd 0 1 0\n");
  WorldLoading loading("memory://a/main.wrl", web.options);
  while (!loading.done()) (void)loading.step(kLoadingWait);
  const render::RenderList list = loading.collect({0, 0, 10});
  const LoadedWorld world = loading.take();
  INFO(said(world));
  CHECK(world.diagnostics.entries().empty());
  REQUIRE(world.scene);
  CHECK(list.items.size() == 4);  // two boxes, a sphere, a triangle
  CHECK(world.images.size() == 1);
  CHECK(std::any_of(list.items.begin(), list.items.end(),
                    [](const auto& item) { return item.material.diffuse == glm::vec3(0, 1, 0); }));
}

TEST_CASE("warns once of an EXTERNPROTO that differs from its PROTO (VRML97 4.9.2)") {
  Web web;
  web.put("memory://a/main.wrl",
          "#VRML V2.0 utf8\nEXTERNPROTO Good [ eventIn SFFloat r ] \"lib.wrl#Ball\"\n"
          "EXTERNPROTO Bad [ field SFTime r eventOut SFBool gone ] \"lib.wrl#Ball\"\n"
          "EXTERNPROTO Unused [ field SFTime r ] \"lib.wrl#Ball\"\n"
          "Shape { geometry Good { } } Shape { geometry Bad { } } Shape { geometry Bad { } }");
  web.put("memory://a/lib.wrl", "#VRML V2.0 utf8\nPROTO Ball [ exposedField SFFloat r 2 ] { Sphere { } }\n");
  WorldLoading loading("memory://a/main.wrl", web.options);
  while (!loading.done()) (void)loading.step(kLoadingWait);
  const LoadedWorld world = loading.take();
  CHECK(said(world) ==
        "memory://a/main.wrl:3:13: warning: PROTO Ball of memory://a/lib.wrl has no field SFTime 'r', as declared by "
        "EXTERNPROTO Bad (VRML97 4.9.2)\n");
}

TEST_CASE("reports failures during loading, and shows the rest") {
  const std::string text = boxes(400);
  const std::string half = text.substr(0, text.size() / 2);
  struct Case {
    const char* name;
    net::MemoryNetwork::Answer answer;
    const char* message;
    bool shows;
  };
  const auto redirect = [](const net::TransferRequest&, unsigned) {
    net::MemoryAnswer answer;
    answer.head.status = 302;
    answer.head.location = "memory://a/world.wrl";
    return answer;
  };
  const Case cases[] = {
      {"gone",
       [](const net::TransferRequest&, unsigned) {
         net::MemoryAnswer answer;
         answer.head.status = 404;
         return answer;
       },
       "404", false},
      {"garbage", [](const net::TransferRequest&, unsigned) { return whole(std::string(3000, '\1')); },
       "unknown format", false},
      {"truncated",
       [&](const net::TransferRequest&, unsigned) {
         net::MemoryAnswer answer = whole(text);
         answer.break_after = half.size();
         return answer;
       },
       "world.wrl", true},
      {"changed midway",
       [&](const net::TransferRequest&, unsigned transfer) {
         net::MemoryAnswer answer = whole(text);
         answer.head.validator.etag = "\"" + std::to_string(transfer) + "\"";
         if (transfer == 0) answer.break_after = half.size();
         return answer;
       },
       "changed on the server", true},
      {"redirected for ever", redirect, "redirect", false},
  };
  for (const Case& one : cases) {
    INFO(one.name);
    Web web;
    web.options.timeout_seconds = 20;
    web.put_script("memory://a/world.wrl", one.answer);
    const LoadedWorld world = load_world("memory://a/world.wrl", web.options);
    INFO(said(world));
    CHECK(world.diagnostics.errors() >= 1);
    CHECK(said(world).find(one.message) != std::string::npos);
    CHECK((world.scene != nullptr) == one.shows);
    if (!world.scene) continue;
    CHECK(world.scene->roots().size() > 100);
    CHECK(world.truncated);
  }
}

TEST_CASE("ends stalled loads at the time limit") {
  Web web;
  web.options.timeout_seconds = 0.3;
  web.put("memory://a/world.wrl", boxes(3) + "Inline { url \"never.wrl\" }\n");
  web.put_script("memory://a/never.wrl", [](const net::TransferRequest&, unsigned) {
    net::MemoryAnswer answer;
    answer.answers = false;
    return answer;
  });
  const LoadedWorld world = load_world("memory://a/world.wrl", web.options);
  REQUIRE(world.scene);
  CHECK(world.scene->roots().size() == 4);
  CHECK(said(world).find("the time limit for loading was reached") != std::string::npos);
}

TEST_CASE("denies files to a document from the network, and denies the network to offline sessions") {
  const ScratchFolder folder;
  const std::string secret = folder.write("secret.wrl", boxes(1));
  Web web;
  web.put("memory://a/world.wrl", "#VRML V2.0 utf8\nInline { url \"file://" + secret + "\" }\nShape { }\n");
  const LoadedWorld world = load_world("memory://a/world.wrl", web.options);
  REQUIRE(world.scene);
  CHECK_FALSE(world.scene->inlines().of(world.scene->roots()[0]));
  CHECK(said(world).find("may not refer to file:") != std::string::npos);
  web.options.offline = true;
  const LoadedWorld none = load_world("memory://a/world.wrl", web.options);
  CHECK_FALSE(none.scene);
  CHECK(said(none).find("--offline") != std::string::npos);
}

TEST_CASE("reports no step of a running simulation that a newer one has replaced") {
  for (const bool live : {true, false}) {
    INFO(live);
    Web web;
    web.put("memory://a/world.wrl", std::string("#VRML V2.0 utf8\n") +
                                        (live ? "WorldInfo { info \"live data: insitu.json\" }\n" : "") +
                                        "Shape { geometry QNV { url \"heat.000001.zarr/zarr.json\" } }\n");
    web.put_script("memory://a/heat.000001.zarr/zarr.json", [](const net::TransferRequest&, unsigned) {
      net::MemoryAnswer answer;
      answer.head.status = 410;
      return answer;
    });
    const LoadedWorld world = load_world("memory://a/world.wrl", web.options);
    REQUIRE(world.scene);
    CHECK((said(world).find("410 Gone") != std::string::npos) == !live);
  }
}

TEST_CASE("shows a stream from its front, and refines it") {
  Web web;
  web.put("memory://a/world.wrl", "#VRML V2.0 utf8\nShape { geometry QNV { url \"ball.qnv\" } }\n");
  web.put_script("memory://a/ball.qnv", [](const net::TransferRequest&, unsigned) {
    net::MemoryAnswer answer = whole(large_stream());
    answer.bytes_per_second = large_stream().size() * 4;
    return answer;
  });
  WorldLoading loading("memory://a/world.wrl", web.options);
  std::vector<std::size_t> clusters;
  std::vector<std::shared_ptr<StreamFeed>> feeds;
  while (!loading.done()) {
    (void)loading.step(kLoadingWait);
    const render::RenderList list = loading.collect({0, 0, 10});
    if (list.splats.empty()) continue;
    const auto octree = content_of<qnv::OctreeSplats>(*list.splats[0].geometry);
    if (feeds.empty()) feeds = loading.feeds();
    for (const auto& feed : feeds) (void)feed->apply();
    clusters.push_back(octree.stream->statistics().clusters);
  }
  REQUIRE(clusters.size() > 3);
  CHECK(std::is_sorted(clusters.begin(), clusters.end()));
  CHECK(clusters.front() * 2 < clusters.back());
  const LoadedWorld world = load_world("memory://a/ball.qnv", web.options);
  REQUIRE(world.geometries.size() == 1);
  const auto octree = content_of<qnv::OctreeSplats>(*world.geometries.begin()->second);
  CHECK(octree.stream->statistics().clusters == clusters.back());
}

TEST_CASE("slows a stream beside one of more weight") {
  const auto longest = [](double weight) {
    Web web;
    web.options.by_view = true;
    web.put("memory://a/ball.qnv", large_stream());
    WorldLoading loading("memory://a/ball.qnv", web.options);
    while (!loading.done()) (void)loading.step(kLoadingWait);
    const LoadedWorld world = loading.take();
    REQUIRE(world.feeds.size() == 1);
    StreamFeed& feed = *world.feeds[0];
    feed.set_weight(weight);
    qnv::LodStream& stream = *content_of<qnv::OctreeSplats>(*world.geometries.begin()->second).stream;
    qnv::LodView view;
    view.eye = {0, 0, 4};
    view.pixels = 5000;
    view.error_pixels = 1;
    const std::size_t before = web.network->transfers().size();
    bool has_read = false;
    for (int rounds = 0; rounds < 1000 && !(has_read && stream.complete()); ++rounds) {
      (void)loading.step(kLoadingWait);
      (void)feed.apply();
      (void)stream.cut(view);
      feed.ask();
      has_read = has_read || feed.reading();
    }
    CHECK(has_read);
    CHECK(stream.complete());
    CHECK_FALSE(feed.reading());
    std::uint64_t most = 0;
    const auto transfers = web.network->transfers();
    for (std::size_t i = before; i < transfers.size(); ++i) {
      REQUIRE(transfers[i].range);
      const std::uint64_t end = std::min<std::uint64_t>(transfers[i].range->end, large_stream().size());
      if (end < large_stream().size()) most = std::max(most, end - transfers[i].range->begin);  // not the directory
    }
    return most;
  };
  const std::uint64_t favoured = longest(1), other = longest(0.125);
  CHECK(other > 0);
  CHECK(other * 2 < favoured);
}

TEST_CASE("reads from a long stream only the parts that a view needs") {
  Web web;
  web.options.by_view = true;
  web.put("memory://a/ball.qnv", large_stream());
  WorldLoading loading("memory://a/ball.qnv", web.options);
  while (!loading.done()) (void)loading.step(kLoadingWait);
  const LoadedWorld world = loading.take();
  REQUIRE(world.scene);
  REQUIRE(world.feeds.size() == 1);
  StreamFeed& feed = *world.feeds[0];
  qnv::LodStream& stream = *content_of<qnv::OctreeSplats>(*world.geometries.begin()->second).stream;
  CHECK(loading.streaming());
  qnv::LodView view;
  view.eye = {0, 0, 4};
  view.pixels = 500;
  view.error_pixels = 4;
  std::size_t rounds = 0;
  do {
    (void)loading.step(kLoadingWait);
    (void)feed.apply();
    (void)stream.cut(view);
    feed.ask();
  } while (!(stream.complete() && stream.statistics().clusters > 1 && ++rounds > 5));
  CHECK(feed.take_problem().empty());
  std::uint64_t asked = 0;
  for (const net::TransferRequest& transfer : web.network->transfers()) {
    REQUIRE(transfer.range);
    asked += std::min<std::uint64_t>(transfer.range->end, large_stream().size()) - transfer.range->begin;
  }
  CHECK(asked < large_stream().size() * 3 / 4);
  // Compares with the cut of the whole stream.
  auto opened = qnv::LodStream::open(bytes_of(large_stream()));
  auto& reference = *std::get<std::unique_ptr<qnv::LodStream>>(opened);
  std::size_t discs = 0, wanted = 0;
  for (const qnv::Piece& piece : stream.cut(view)) discs += piece.count;
  for (const qnv::Piece& piece : reference.cut(view)) wanted += piece.count;
  CHECK(discs == wanted);
}

TEST_CASE("reads the chunks in view first from a stream that is decoded completely") {
  // An octree with an exact mesh, which never comes here, is decoded like a displaced surface.
  std::vector<std::byte> bytes = bytes_of(large_stream());
  std::size_t header_bytes = 0;
  bool need_more = false;
  auto header = std::get<qnv::StreamHeader>(qnv::decode_header(bytes, header_bytes, need_more));
  header.meshed = true;
  const std::vector<std::byte> meshed = qnv::encode_header(header);
  REQUIRE(meshed.size() == header_bytes);
  std::copy(meshed.begin(), meshed.end(), bytes.begin());
  qnv::StreamDecoder decoder;
  REQUIRE(decoder.push(bytes));
  for (const bool with_view : {true, false}) {
    Web web;
    web.options.by_view = true;
    web.put("memory://a/world.wrl", "#VRML V2.0 utf8\nShape { geometry QNV { url \"ball.qnv\" } }\n");
    web.put("memory://a/ball.qnv", test::string_of(bytes));
    WorldLoading loading("memory://a/world.wrl", web.options);
    qnv::LodView view;
    view.planes[0] = {1, 0, 0, -header.description.box.upper.x * 0.97f};
    bool noted = false;
    while (!loading.done()) {
      (void)loading.step(kLoadingWait);
      if (!with_view || noted || loading.feeds().empty()) continue;
      StreamFeed& feed = *loading.feeds().front();
      CHECK_FALSE(feed.takes_bytes());
      feed.requests()->note(view);
      feed.ask();
      noted = true;
    }
    CHECK(noted == with_view);
    const LoadedWorld world = loading.take();
    INFO(said(world));
    CHECK(said(world).empty());
    REQUIRE(world.geometries.size() == 1);
    CHECK(world.geometries.begin()->second->size() == decoder.vectors());
    REQUIRE(world.feeds.size() == 1);
    CHECK_FALSE(world.feeds[0]->reading());
    // Bytes of all transfers, and of the transfers until all chunks in view were read.
    std::uint64_t read = 0, read_in_view = 0;
    std::set<std::uint64_t> known;
    for (const net::TransferRequest& transfer : web.network->transfers()) {
      if (!transfer.range || transfer.range->begin == 0 || transfer.range->begin >= header.directory) continue;
      read += std::min<std::uint64_t>(transfer.range->end, bytes.size()) - transfer.range->begin;
      for (const qnv::DirectoryEntry& entry : decoder.directory())
        if (entry.offset >= transfer.range->begin && entry.offset < transfer.range->end &&
            known.insert(entry.offset).second && !outside(entry.box, view))
          read_in_view = read;
    }
    CHECK(read < bytes.size() * 5 / 4);
    CHECK((read_in_view < read / 2) == with_view);
  }
}
