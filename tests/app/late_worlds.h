#pragma once

#include "app/loading/world_loader.h"
#include "app/loading/world_loading.h"
#include "app/session/running/world_runtime.h"
#include "tests/net/memory_network.h"
#include "vrml/syntax/parser.h"

#include <catch2/catch.hpp>

#include <chrono>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

// Worlds with parts that load at run time, from servers that the test controls.
namespace gs::app::late_worlds {

inline const std::string kHeader = "#VRML V2.0 utf8\n";

using Bytes = std::vector<std::byte>;

inline Bytes bytes_of(const std::string& text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

/// Adds a file of memory://a/. `rate`: bytes per second; 0 means that all bytes come in one delivery. `block`: bytes
/// per delivery.
inline void put(LoadOptions& options, const std::string& name, Bytes bytes, std::uint64_t rate = 0,
                std::size_t block = 64) {
  net::network_of(options.memory)
      .put("memory://a/" + name, [bytes = std::move(bytes), rate, block](const net::TransferRequest&, unsigned) {
        net::MemoryAnswer answer;
        answer.head.content_length = bytes.size();
        answer.body = bytes;
        answer.bytes_per_second = rate;
        if (rate > 0) answer.block = block;
        return answer;
      });
}
inline void put(LoadOptions& options, const std::string& name, const std::string& text) {
  put(options, name, bytes_of(text));
}

/// Files of memory://a/.
struct Site {
  void put(const std::string& name, Bytes bytes, std::uint64_t rate = 0, std::size_t block = 64) {
    late_worlds::put(options, name, std::move(bytes), rate, block);
  }
  void put(const std::string& name, const std::string& text, std::uint64_t rate = 0) {
    put(name, bytes_of(text), rate, 1);
  }
  /// Adds a server that never answers.
  void never(const std::string& name) {
    net::network_of(options.memory).put("memory://a/" + name, [](const net::TransferRequest&, unsigned) {
      net::MemoryAnswer answer;
      answer.answers = false;
      return answer;
    });
  }
  LoadOptions options = [] {
    LoadOptions made;
    made.memory = net::MakeMemoryTransport{};
    return made;
  }();
};

/// The running world memory://a/world.wrl with one view.
struct World {
  enum class Begins : std::uint8_t { with_its_own_file, with_all_that_it_names };

  explicit World(const Site& site, Begins begins = Begins::with_its_own_file)
      : loading("memory://a/world.wrl", site.options) {
    if (begins == Begins::with_all_that_it_names) {
      opened = load_world(loading, "memory://a/world.wrl");
    } else {
      while (!loading.root_is_read()) (void)loading.step(std::chrono::milliseconds(10));
      opened = loading.take();
    }
    REQUIRE(opened.scene);
    runtime = std::make_unique<WorldRuntime>(opened, meshes);
    runtime->start(1000);
    seen = runtime->look({0, 0, 10}, true);
  }
  vrml::SceneGraph& scene() { return *opened.scene; }
  vrml::NodeId root(std::size_t place) { return scene().roots()[place]; }
  /// Sets the url field to one URL, or to an empty list.
  void set_url(vrml::NodeId node, const std::string& url) {
    vrml::MFString list;
    if (!url.empty()) list.push_back(url);
    CHECK(runtime->send(scene(), node, "set_url", vrml::FieldValue(list)));
    runtime->step(time += 1);
  }
  /// Returns the requested resources when they are loaded.
  ResourceUpdates fetch() {
    loading.request(runtime->take_url_requests());
    while (!loading.done()) (void)loading.step(std::chrono::milliseconds(1000));
    return loading.take_updates();
  }
  void arrive(ResourceUpdates&& updates) {
    runtime->arrive(std::move(updates));
    runtime->step(time += 1);
  }
  /// Delivers all requested resources, and those that they request.
  void load() {
    do {
      loading.request(runtime->take_url_requests());
      while (!loading.done()) {
        (void)loading.step(std::chrono::milliseconds(1000));
        runtime->arrive(loading.take_updates());
      }
      arrive(loading.take_updates());
    } while (requests_wait());
  }
  /// Steps for a duration.
  void step_for(std::chrono::milliseconds span) {
    const auto end = std::chrono::steady_clock::now() + span;
    while (std::chrono::steady_clock::now() < end) (void)loading.step(std::chrono::milliseconds(5));
    arrive(loading.take_updates());
  }
  bool requests_wait() {
    auto requests = runtime->take_url_requests();
    const bool any = !requests.empty();
    loading.request(std::move(requests));
    return any && !loading.done();
  }
  const render::RenderList& list(const glm::dvec3& viewer = {0, 0, 10}) {
    (void)runtime->show(*seen, viewer);
    return seen->scene.list();
  }
  std::size_t items() { return list().items.size(); }

  WorldLoading loading;
  LoadedWorld opened;
  render::MeshCache meshes;
  std::unique_ptr<WorldRuntime> runtime;
  std::shared_ptr<RuntimeScene> seen;
  double time = 1000;
};

}  // namespace gs::app::late_worlds
