#pragma once

#include "app/script/run_time_nodes.h"
#include "app/script/script_runner.h"
#include "vrml/scene/node_names.h"
#include "vrml/syntax/parser.h"
#include "vrml/syntax/printer.h"

#include <catch2/catch.hpp>

#include <charconv>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gs::app::scripts {

using Lines = std::vector<std::string>;

/// World with Scripts. Records their printed text and errors, and the events of the world: "time node.event value",
/// with times in seconds since kStart.
class World {
 public:
  static constexpr double kStart = 1000;

  explicit World(const std::string& body, const Limits& limits = {}, ScriptRunner::Settings settings = {0, true})
      : scene_(std::make_unique<vrml::SceneGraph>("text.wrl", limits)) {
    Diagnostics diagnostics;
    (void)vrml::parse("#VRML V2.0 utf8\n" + body, *scene_, diagnostics);
    for (const Diagnostic& diagnostic : diagnostics.entries()) UNSCOPED_INFO(diagnostic.text());
    CHECK(diagnostics.errors() == 0);
    execution_ = std::make_unique<vrml::Execution>(*scene_);
    names_ = std::make_unique<vrml::NodeNames>(*scene_);
    execution_->cascade().observe([this](const vrml::SentEvent& event) {
      char digits[64];
      std::string line(digits, std::to_chars(digits, digits + sizeof digits, event.time - kStart).ptr);
      line += ' ' + names_->of(*event.scene, event.node) + '.' + event.event->name + ' ';
      vrml::print_value(line, *event.value, *event.scene);
      events_.push_back(line);
    });
    runner_ = ScriptRunner::make(*execution_, settings);
    REQUIRE(runner_);
    runner_->observe([this](const ScriptMessage& message) {
      (message.printed ? printed_ : problems_)
          .push_back(message.printed ? message.diagnostic.message : message.diagnostic.text());
    });
    execution_->scripts().set_host(runner_.get());
  }
  ~World() {
    runner_.reset();
    execution_->scripts().set_host(nullptr);
  }
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  void start(double at = 0) { execution_->start(kStart + at); }
  void step(double at) {
    if (runner_) runner_->begin_step();
    execution_->step(kStart + at);
  }
  template <class T>
  void send(std::string_view target, T value) {
    const std::size_t point = target.rfind('.');
    const vrml::NodeId node = names_->find(target.substr(0, point));
    REQUIRE(node);
    const vrml::InterfaceDeclaration* event = scene_->node(node).type->find_event_in(target.substr(point + 1));
    REQUIRE(event);
    CHECK(execution_->send(*scene_, node, *event, vrml::FieldValue(std::move(value))));
  }
  /// Returns all printed lines since the last call.
  Lines printed() { return std::exchange(printed_, {}); }
  Lines problems() { return std::exchange(problems_, {}); }
  Lines events() { return std::exchange(events_, {}); }
  /// Returns the events that contain `part`.
  Lines events(std::string_view part) {
    Lines some;
    for (const std::string& line : events())
      if (line.find(part) != std::string::npos) some.push_back(line);
    return some;
  }
  /// Ends the world and its programs. printed() then also returns the output of shutdown().
  void end() { runner_.reset(); }
  vrml::SceneGraph& scene() { return *scene_; }
  vrml::Execution& execution() { return *execution_; }
  ScriptRunner& runner() { return *runner_; }
  /// Delivers the text that a program requested (createVrmlFromURL).
  bool created(const ScriptRequest& request, const std::string& text, const std::string& url) {
    Diagnostics diagnostics;
    const vrml::RunTimeNodes made = make_nodes(execution(), *request.scene, url, text, diagnostics, request.origin);
    return send_made(execution(), request, made.roots);
  }
  vrml::NodeId node(std::string_view name) { return names_->find(name); }

 private:
  Lines printed_, problems_, events_;
  std::unique_ptr<vrml::SceneGraph> scene_;
  std::unique_ptr<vrml::Execution> execution_;
  std::unique_ptr<vrml::NodeNames> names_;
  std::unique_ptr<ScriptRunner> runner_;
};

/// Returns the lines that a program prints in initialize(). `program` must be valid inside a VRML string.
inline Lines run(const std::string& program, const std::string& interface = {}) {
  World world("DEF S Script { directOutput TRUE " + interface + " url \"javascript: function initialize() { " +
              program + " }\" }");
  world.start();
  CHECK(world.problems() == Lines{});
  return world.printed();
}

/// Returns the text of one expression.
inline std::string value(const std::string& expression, const std::string& before = {}) {
  const Lines lines = run(before + " print(" + expression + ");");
  return lines.empty() ? "" : lines.front();
}

}  // namespace gs::app::scripts
