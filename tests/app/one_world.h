#pragma once

#include "app/session/session.h"
#include "tests/app/worlds.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

// Session of one world, with input of a user.
namespace gs::app::sessions {

inline constexpr double kStart = 1000;
using Kind = WindowEvent::Kind;

inline WindowEvent key(Kind kind, char letter) {
  WindowEvent event;
  event.kind = kind;
  event.key = letter_key(letter);
  return event;
}

inline WindowEvent pointer(Kind kind, float x, float y) {
  WindowEvent event;
  event.kind = kind;
  event.pointer = {x, y};
  return event;
}

inline SessionInput input_of(std::vector<WindowEvent> events, bool over_interface = false) {
  SessionInput input;
  input.area = Viewport{0, 0, 200, 100};
  for (WindowEvent& event : events) input.events.push_back({std::move(event), over_interface});
  return input;
}

/// Session of one world that begins at kStart.
struct OneWorld {
  explicit OneWorld(const std::string& body, bool simulated = true)
      : document(hold_world(world_of(body))), session({{}, {}, {}, simulated}, {}, [] {}) {
    begin_world(*document, kStart);
    session.readers().show(document);
    frame = session.step(kStart, input_of({}));
    REQUIRE(frame.pictures.size() == 1);
    REQUIRE(frame.pictures[0].view);
  }
  [[nodiscard]] glm::vec3 place() const { return frame.pictures[0].view->navigation.pose.position; }
  [[nodiscard]] double number_of_events(const std::string& name) const {
    return static_cast<double>(std::count(events.begin(), events.end(), name));
  }
  void watch() {
    document->runtime->execution().cascade().observe(
        [this](const vrml::SentEvent& event) { events.push_back(event.event->name); });
  }

  std::shared_ptr<Document> document;
  Session session;
  Frame frame;
  std::vector<std::string> events;
};

}  // namespace gs::app::sessions
