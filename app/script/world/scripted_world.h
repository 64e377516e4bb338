#pragma once

#include "app/script/boundary/program_host.h"
#include "app/script/engine/step_time.h"
#include "app/script/script_runner.h"
#include "app/script/world/program_loader.h"
#include "app/script/world/world_answers.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace gs::app::script {

/// Implementation of ScriptRunner: the Scripts of a world, their rights, and the host that runs their programs.
class ScriptedWorld final : public ScriptRunner, private ProgramStarter {
 public:
  ScriptedWorld(vrml::Execution& execution, Settings settings);
  ~ScriptedWorld() override;

  [[nodiscard]] WorldAccess& answers() { return answers_; }
  /// Sets the host of the programs. Call it before all others.
  void set_host(std::unique_ptr<ProgramHost> host) { host_ = std::move(host); }

  using Made = std::function<void(const vrml::ScriptCall&, bool)>;
  bool begin(vrml::EventNode script) override;
  bool deliver(vrml::EventNode script, std::uint32_t interface, const vrml::FieldValue& value, double time) override;
  void events_processed(vrml::EventNode script) override;
  [[nodiscard]] bool may_wait(vrml::EventNode script) const override;
  [[nodiscard]] std::size_t make_calls(std::span<const vrml::ScriptCall> calls, const Made& made) override;
  void prepare_events() override;
  [[nodiscard]] bool prepares_events() const override;
  void end(vrml::EventNode script) override;
  void forget(vrml::EventNode script) override;
  [[nodiscard]] bool waits(vrml::EventNode script) const override;
  [[nodiscard]] bool has_time() override { return time_.has_time(); }
  void begin_step() override;
  void set_browser(BrowserState state) override { answers_.set_browser(std::move(state)); }
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
  [[nodiscard]] bool is_late() const override { return time_.is_late(); }
  [[nodiscard]] const std::string& stopped() const override { return stopped_; }

 private:
  bool start_text(ScriptRecord& script, std::string_view text, const std::string& file, SourceLocation place) override;
  [[nodiscard]] ScriptRecord* record_of(vrml::EventNode node) const;
  /// Adds the facts that all orders have, and the values that the program does not know.
  void complete(ScriptRecord& script, Order& order);
  /// Runs an order for a Script.
  Report run(ScriptRecord& script, Order order);
  [[nodiscard]] bool makes_call(vrml::EventNode script) const;
  /// Makes the first calls together. Returns their number.
  [[nodiscard]] std::size_t make_together(std::span<const vrml::ScriptCall> calls, const Made& made);
  static void note(ScriptRecord& script, const Report& report);
  void add_values(ScriptRecord& script, Order& order);
  void forget_values(const Order& order);
  void call(ScriptRecord& script, const char* function);
  /// Reports that no program of this world runs any more, if the host says so. `script` was the last one to run.
  void note_stop(const ScriptRecord& script);

  vrml::Execution& execution_;
  ScriptMessages messages_;
  RequestQueue requests_;
  ReadGuard reads_;
  WorldAnswers answers_;
  StepTime time_;
  ProgramLoader loader_;
  std::unique_ptr<ProgramHost> host_;
  std::unordered_map<vrml::EventNode, std::unique_ptr<ScriptRecord>> scripts_;
  std::string stopped_;
};

}  // namespace gs::app::script
