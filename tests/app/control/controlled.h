#pragma once

#include "app/control/control.h"
#include "app/session/session.h"
#include "base/noncopyable.h"
#include "tests/app/control/queued_channel.h"
#include "tests/app/worlds.h"

#include <nlohmann/json.hpp>

#include <catch2/catch.hpp>

#include <chrono>
#include <deque>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace gs::app::controlled {

using Json = nlohmann::json;

/// Channel that keeps the sent messages.
class Channel final : public QueuedChannel {
 public:
  void send(std::uint64_t client, std::string message) override {
    INFO(message);
    CHECK(message.find('\n') == std::string::npos);
    sent[client].push_back(Json::parse(message));
  }
  [[nodiscard]] bool is_behind(std::uint64_t client) const override { return behind.contains(client); }

  std::map<std::uint64_t, std::vector<Json>> sent;
  std::set<std::uint64_t> behind;
};

/// Session of a world in simulated time, controlled by clients.
class World : NonCopyable {
 public:
  static constexpr double kStart = 1000;

  explicit World(const std::string& body, std::chrono::seconds most_of_step = std::chrono::hours(1))
      : session({{}, {}, {}, true}, {}, [] {}),
        control(
            channel, [this] { ++wakes; }, most_of_step) {
    session.add_extension(control);
    input.area = Viewport{0, 0, 200, 100};
    open(body);
  }
  World() : session({{}, {}, {}, true}, {}, [] {}), control(channel, [this] { ++wakes; }) {
    session.add_extension(control);
    input.area = Viewport{0, 0, 200, 100};
  }
  ~World() { session.remove_extension(control); }

  void open(const std::string& body) {
    document = hold_world(world_of(body));
    begin_world(*document, now);
    session.readers().show(document);
    step(0);
  }
  Frame step(double seconds) {
    now += seconds;
    return session.step(now, input);
  }
  /// Sends a message of a client in a step without time.
  Frame say(const std::string& message, std::uint64_t client = 1) {
    channel.news.push_back({client, false, message});
    return step(0);
  }
  void leave(std::uint64_t client = 1) {
    channel.news.push_back({client, true, {}});
    step(0);
  }
  /// Returns all messages to a client since the last call.
  std::vector<Json> take(std::uint64_t client = 1) { return std::exchange(channel.sent[client], {}); }
  /// Returns the answer to a call. Earlier events wait for `events`.
  Json answer(const std::string& method, const Json& parameters = Json::object(), std::uint64_t client = 1) {
    const int id = ++last_id;
    say(Json{{"jsonrpc", "2.0"}, {"id", id}, {"method", method}, {"params", parameters}}.dump(), client);
    Json found;
    for (Json& one : take(client)) {
      if (one.contains("id") && one["id"] == id) {
        found = std::move(one);
      } else {
        others[client].push_back(std::move(one));
      }
    }
    return found;
  }
  Json call(const std::string& method, const Json& parameters = Json::object(), std::uint64_t client = 1) {
    const Json got = answer(method, parameters, client);
    INFO(method << ' ' << parameters.dump() << ": " << got.dump());
    REQUIRE(got.contains("result"));
    return got["result"];
  }
  std::string problem(const std::string& method, const Json& parameters = Json::object(), std::uint64_t client = 1) {
    const Json got = answer(method, parameters, client);
    INFO(method << ' ' << parameters.dump() << ": " << got.dump());
    REQUIRE(got.contains("error"));
    return got["error"]["message"];
  }
  /// Returns the received notifications of one method, and keeps the others.
  std::vector<Json> told(const std::string& method, std::uint64_t client = 1) {
    std::vector<Json> all = std::exchange(others[client], {});
    for (Json& one : take(client)) all.push_back(std::move(one));
    std::vector<Json> result;
    for (Json& one : all)
      if (one.value("method", "") == method) result.push_back(std::move(one["params"]));
    return result;
  }
  [[nodiscard]] vrml::SceneGraph& scene() { return *document->world.scene; }

  double now = kStart;
  Channel channel;
  SessionInput input;
  std::shared_ptr<Document> document;
  Session session;
  Control control;
  int wakes = 0;

 private:
  int last_id = 0;
  std::map<std::uint64_t, std::vector<Json>> others;
};

}  // namespace gs::app::controlled
