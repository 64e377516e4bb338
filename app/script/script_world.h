#pragma once

#include "app/script/program_calls.h"
#include "app/script/program_loader.h"
#include "app/script/request_queue.h"
#include "app/script/script_library.h"
#include "app/script/script_messages.h"
#include "app/script/script_runner.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace gs::app::script {

/// Implementation of ScriptRunner: the programs of one world, and the parts that serve them.
class World final : public ScriptRunner {
 public:
  World(vrml::Execution& execution, Engine& engine, Settings settings);
  ~World() override;

  bool begin(vrml::EventNode script) override;
  bool deliver(vrml::EventNode script, std::uint32_t interface, const vrml::FieldValue& value, double time) override;
  void events_processed(vrml::EventNode script) override;
  void prepare_events() override;
  [[nodiscard]] bool prepares_events() const override;
  void end(vrml::EventNode script) override;
  void forget(vrml::EventNode script) override;
  [[nodiscard]] bool waits(vrml::EventNode script) const override;
  [[nodiscard]] bool has_time() override { return calls_.time().has_time(); }
  void begin_step() override;
  void set_browser(BrowserState state) override { browser_ = std::move(state); }
  void found(const vrml::SceneGraph& scene, vrml::NodeId script, std::optional<std::string> text,
             const std::string& url) override;
  void provide(const vrml::SceneGraph& scene, vrml::NodeId script, std::optional<std::string> text,
               const std::string& url) override;
  [[nodiscard]] Evaluation evaluate(const vrml::SceneGraph& scene, vrml::NodeId script,
                                    const std::string& line) override;
  [[nodiscard]] std::vector<ScriptMessage> take_messages() override { return messages_.take(); }
  void observe(std::function<void(const ScriptMessage&)> observer) override { messages_.observe(std::move(observer)); }
  [[nodiscard]] std::vector<ScriptRequest> take_requests() override { return requests_.take(); }
  void forget_scene(const vrml::SceneGraph& scene) override { requests_.forget_scene(scene); }
  [[nodiscard]] const std::string& private_file() const override { return reads_.private_file(); }
  [[nodiscard]] bool is_late() const override { return calls_.time().is_late(); }

  // Parts for calls from programs.
  [[nodiscard]] vrml::Execution& execution() { return execution_; }
  [[nodiscard]] Engine& engine() { return engine_; }
  [[nodiscard]] const BrowserState& browser() const { return browser_; }
  [[nodiscard]] ScriptMessages& messages() { return messages_; }
  [[nodiscard]] RequestQueue& requests() { return requests_; }
  [[nodiscard]] ReadGuard& reads() { return reads_; }
  [[nodiscard]] ProgramCalls& calls() { return calls_; }

 private:
  [[nodiscard]] Program* program_of(vrml::EventNode node) const;

  vrml::Execution& execution_;
  Engine& engine_;
  BrowserState browser_;
  ScriptMessages messages_;
  RequestQueue requests_;
  ReadGuard reads_;
  ProgramCalls calls_;
  ScriptLibraries libraries_;
  ProgramLoader loader_;
  std::unordered_map<vrml::EventNode, std::unique_ptr<Program>> programs_;
};

}  // namespace gs::app::script
