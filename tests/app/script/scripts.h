#pragma once

#include "app/script/run_time_nodes.h"
#include "app/script/script_runner.h"
#include "tests/vrml/events/trace.h"

#include <catch2/catch.hpp>

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace gs::app::scripts {

using vrml::traces::Lines;

/// World with Scripts, their printed text and their errors.
class World : public vrml::traces::World {
 public:
  explicit World(const std::string& body, const Limits& limits = {}, ScriptRunner::Settings settings = {0, true},
                 vrml::Language language = vrml::Language::vrml97)
      : vrml::traces::World(body, limits, language), runner_(ScriptRunner::make(execution(), settings)) {
    REQUIRE(runner_);
    runner_->observe([this](const ScriptMessage& message) {
      (message.printed ? printed_ : problems_)
          .push_back(message.printed ? message.diagnostic.message : message.diagnostic.text());
    });
    execution().scripts().set_host(runner_.get());
  }
  ~World() override {
    runner_.reset();
    execution().scripts().set_host(nullptr);
  }

  void step(double at) override {
    if (runner_) runner_->begin_step();
    vrml::traces::World::step(at);
  }
  /// Returns all printed lines since the last call.
  Lines printed() { return std::exchange(printed_, {}); }
  Lines problems() { return std::exchange(problems_, {}); }
  /// Ends the world and its programs. printed() then also returns the output of shutdown().
  void end() { runner_.reset(); }
  ScriptRunner& runner() { return *runner_; }
  /// Delivers the text that a program requested (createVrmlFromURL).
  bool created(const ScriptRequest& request, const std::string& text, const std::string& url) {
    Diagnostics diagnostics;
    const vrml::RunTimeNodes made = make_nodes(execution(), *request.scene, url, text, diagnostics, request.origin);
    return send_made(execution(), request, made.roots);
  }

 private:
  Lines printed_, problems_;
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

/// World of an X3D text in classic encoding, without header.
class X3DWorld : public World {
 public:
  explicit X3DWorld(const std::string& body) : World(body, {}, {0, true}, vrml::Language::x3d) {}
};

/// Returns the lines that an X3D program prints in initialize(). `others` are statements before the Script.
inline Lines run_x3d(const std::string& program, const std::string& interface = {}, const std::string& others = {}) {
  X3DWorld world(others + " DEF S Script { directOutput TRUE " + interface +
                 " url \"ecmascript: function initialize() { " + program + " }\" }");
  world.start();
  CHECK(world.problems() == Lines{});
  return world.printed();
}

/// Returns the text of one expression in an X3D program.
inline std::string x3d_value(const std::string& expression, const std::string& before = {}) {
  const Lines lines = run_x3d(before + " print(" + expression + ");");
  return lines.empty() ? "" : lines.front();
}

/// Returns the text of one expression.
inline std::string value(const std::string& expression, const std::string& before = {}) {
  const Lines lines = run(before + " print(" + expression + ");");
  return lines.empty() ? "" : lines.front();
}

}  // namespace gs::app::scripts
