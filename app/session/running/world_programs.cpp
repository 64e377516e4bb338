#include "app/session/running/world_programs.h"

#include "app/script/run_time_nodes.h"
#include "net/base/url.h"

#include <glm/geometric.hpp>

#include <filesystem>
#include <system_error>
#include <utility>

namespace gs::app {
namespace {

constexpr std::size_t kMaxMessages = 1000;  // max messages until the caller takes them; further ones are dropped

}  // namespace

WorldPrograms::WorldPrograms(LoadedWorld& world, vrml::Execution& execution) : world_(world), execution_(execution) {
  browser_.world_url = world_.path;
  if (!net::parse_url(world_.path).scheme.empty()) return;
  std::error_code error;
  const std::filesystem::path whole = std::filesystem::absolute(world_.path, error);
  if (!error) browser_.world_url = net::url_of_path(whole.lexically_normal().string()).text();
}

void WorldPrograms::start() {
  if (runner_ || !execution_.scripts().has_scripts()) return;
  runner_ = ScriptRunner::make(execution_, settings_);
  if (!runner_) return;
  if (observer_) runner_->observe(observer_);
  runner_->set_browser(browser_);
  execution_.scripts().set_host(runner_.get());
  for (ProgramText& one : world_.programs)
    if (execution_.scenes().has(one.scene)) runner_->provide(*one.scene, one.script, std::move(one.text), one.url);
  world_.programs.clear();
}

void WorldPrograms::stop() {
  runner_.reset();
  execution_.scripts().set_host(nullptr);
}

// Computes the viewer's speed and the frame rate from the time and distance since the last step.
void WorldPrograms::begin_step(double now) {
  if (runner_) runner_->begin_step();
  if (!runner_ && !measures_viewer_) return;
  const glm::dvec3 place(execution_.viewer().pose()[3]);
  const double seconds = now - execution_.now();
  if (viewer_ && seconds > 0) {
    browser_.speed = glm::length(place - *viewer_) / seconds;
    browser_.frame_rate = 1 / seconds;
    if (runner_) runner_->set_browser(browser_);
  }
  viewer_ = place;
}

void WorldPrograms::tell(ScriptMessage message) {
  if (observer_) return observer_(message);
  if (messages_.size() < kMaxMessages) messages_.push_back(std::move(message));
}

void WorldPrograms::observe(std::function<void(const ScriptMessage&)> observer) {
  observer_ = std::move(observer);
  if (runner_) runner_->observe(observer_);
}

std::vector<ScriptMessage> WorldPrograms::take_messages() {
  std::vector<ScriptMessage> messages = std::exchange(messages_, {});
  if (!runner_) return messages;
  for (ScriptMessage& one : runner_->take_messages()) messages.push_back(std::move(one));
  return messages;
}

vrml::RunTimeNodes WorldPrograms::create(vrml::SceneGraph& scene, const std::string& label, std::string_view text,
                                         Diagnostics& diagnostics, const vrml::SourceText* written_by,
                                         std::shared_ptr<const vrml::TextSource> fetched_from) {
  vrml::RunTimeNodes made =
      make_nodes(execution_, scene, label, text, diagnostics, written_by, std::move(fetched_from));
  start();
  return made;
}

ScriptRunner::Evaluation WorldPrograms::evaluate(const vrml::SceneGraph& scene, vrml::NodeId script,
                                                 const std::string& line) {
  const vrml::SceneGraph* of = &scene;
  if (!script) {
    of = world_.scene.get();
    if (!of->contains(console_)) {
      Diagnostics diagnostics;
      const vrml::RunTimeNodes made =
          create(*world_.scene, "console", "Script { directOutput TRUE url \"javascript: ;\" }", diagnostics, nullptr);
      if (made.roots.empty()) return {"not enough memory for a program", true};
      console_ = made.roots.front();
      execution_.lifetime().hold(*of, console_);
    }
    script = console_;
  }
  execution_.cascade().begin_update();
  execution_.cascade().drain();  // starts Scripts that were added since the last event
  if (!runner_) return {"this world has no Script engine", true};
  execution_.cascade().begin_update();
  ScriptRunner::Evaluation result = runner_->evaluate(*of, script, line);
  execution_.cascade().drain();
  return result;
}

}  // namespace gs::app
