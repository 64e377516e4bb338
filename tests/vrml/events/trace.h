#pragma once

#include "vrml/events/execution.h"
#include "vrml/scene/node_names.h"
#include "vrml/syntax/parser.h"
#include "vrml/syntax/printer.h"

#include <catch2/catch.hpp>

#include <charconv>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace gs::vrml::traces {

/// World with a trace of its events: "time node.event value", with times in seconds since kStart.
class World {
 public:
  static constexpr double kStart = 1000;

  explicit World(const std::string& body, const Limits& limits = {}, Language language = Language::vrml97)
      : scene_(std::make_unique<SceneGraph>("text.wrl", limits)) {
    Diagnostics diagnostics;
    constexpr int kX3DVersion = 33;
    if (language == Language::x3d) {
      scene_->set_language(language, kX3DVersion);
      (void)Parser(*scene_, diagnostics).parse_fragment(body);
    } else {
      (void)parse("#VRML V2.0 utf8\n" + body, *scene_, diagnostics);
    }
    begin(diagnostics);
  }
  /// Reads a whole text of any grammar.
  static std::unique_ptr<World> of_text(const std::string& text) {
    auto world = std::unique_ptr<World>(new World());
    Diagnostics diagnostics;
    (void)parse(text, *world->scene_, diagnostics);
    world->begin(diagnostics);
    return world;
  }
  virtual ~World() = default;

  /// Returns the trace since the last call.
  std::vector<std::string> take() { return std::exchange(lines_, {}); }
  /// Returns the lines of the trace that contain `part`.
  std::vector<std::string> take(std::string_view part) {
    std::vector<std::string> some;
    for (const std::string& line : take())
      if (line.find(part) != std::string::npos) some.push_back(line);
    return some;
  }
  void start(double at = 0) { execution_->start(kStart + at); }
  virtual void step(double at) { execution_->step(kStart + at); }
  /// Steps to a time since kStart, and returns the trace since the last call.
  std::vector<std::string> take_at(double at) {
    step(at);
    return take();
  }
  /// Steps to a time since kStart, and returns the lines of the trace that contain `part`.
  std::vector<std::string> take_at(double at, std::string_view part) {
    step(at);
    return take(part);
  }
  /// Steps to a time since kStart, and sends an event to "name.eventIn".
  template <class T>
  void send_at(double at, std::string_view target, T value) {
    step(at);
    send(target, std::move(value));
  }
  /// Sends an event to "name.eventIn" at a time since kStart.
  template <class T>
  void send(std::string_view target, T value) {
    const std::size_t point = target.rfind('.');
    const NodeId node = names_->find(target.substr(0, point));
    REQUIRE(node);
    const InterfaceDeclaration* event = scene_->node(node).type->find_event_in(target.substr(point + 1));
    REQUIRE(event);
    CHECK(execution_->send(*scene_, node, *event, FieldValue(std::move(value))));
  }
  SceneGraph& scene() { return *scene_; }
  Execution& execution() { return *execution_; }
  NodeId node(std::string_view name) { return names_->find(name); }

 private:
  World() : scene_(std::make_unique<SceneGraph>("text")) {}

  void begin(const Diagnostics& diagnostics) {
    for (const Diagnostic& diagnostic : diagnostics.entries()) UNSCOPED_INFO(diagnostic.text());
    CHECK(diagnostics.errors() == 0);
    execution_ = std::make_unique<Execution>(*scene_);
    names_ = std::make_unique<NodeNames>(*scene_);
    execution_->cascade().observe([this](const SentEvent& event) {
      std::string line =
          time_text(event.time - kStart) + ' ' + names_->of(*event.scene, event.node) + '.' + event.event->name + ' ';
      print_value(line, *event.value, *event.scene);
      lines_.push_back(line);
    });
  }

  static std::string time_text(double time) {
    char digits[64];
    return {digits, std::to_chars(digits, digits + sizeof digits, time).ptr};
  }

  std::unique_ptr<SceneGraph> scene_;
  std::unique_ptr<Execution> execution_;
  std::unique_ptr<NodeNames> names_;
  std::vector<std::string> lines_;
};

using Lines = std::vector<std::string>;

/// World with the node types of X3D.
class X3DWorld : public World {
 public:
  explicit X3DWorld(const std::string& body) : World(body, {}, Language::x3d) {}
};

}  // namespace gs::vrml::traces
