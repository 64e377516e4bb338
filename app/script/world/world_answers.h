#pragma once

#include "app/script/boundary/world_access.h"
#include "app/script/world/read_guard.h"
#include "app/script/world/request_queue.h"
#include "app/script/world/script_messages.h"
#include "vrml/events/execution.h"

#include <array>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

namespace gs::app::script {

/// Node of a running world; the scene is null if there is none.
struct NodeAt {
  vrml::SceneGraph* scene = nullptr;
  vrml::NodeId node;
  [[nodiscard]] const vrml::Node& get() const { return scene->node(node); }
};

/// Answers of a running world to its programs. Judges every question and notice, because programs may be hostile: nodes
/// must be part of the world, values must have the type of their field, and ReadGuard allows each read. One thread.
class WorldAnswers final : public WorldAccess {
 public:
  /// All arguments must outlive the object.
  WorldAnswers(vrml::Execution& execution, ScriptMessages& messages, RequestQueue& requests, ReadGuard& reads);

  [[nodiscard]] Answer ask(const Question& question) override;
  void tell(const Notice& notice) override;

  /// Sets the Script of the running program; null while none runs.
  void set_running(ScriptRecord* script) { running_ = script; }
  void set_browser(BrowserState state) { state_ = std::move(state); }
  [[nodiscard]] const BrowserState& browser() const { return state_; }
  /// Begins the end of the world. From now on, programs have no effect.
  void begin_end() { ends_ = true; }
  /// Returns the scenes that programs know and that left the world since the last call.
  [[nodiscard]] std::vector<std::uint64_t> take_gone();
  /// Releases all nodes that programs hold. Call it when no program runs any more.
  void release_all();

  // Parts for the functions of the rows.
  [[nodiscard]] vrml::Execution& execution() { return execution_; }
  [[nodiscard]] ScriptRecord& running() { return *running_; }
  [[nodiscard]] RequestQueue& requests() { return requests_; }
  [[nodiscard]] ScriptMessages& messages() { return messages_; }
  /// Reports whether the running program may change the world. Returns false in shutdown(), and while the world ends.
  [[nodiscard]] bool may_act() const { return !ends_ && running_ && !running_->ended; }
  [[nodiscard]] bool may_read(const vrml::Node& node) { return reads_.may_read(*running_, node); }
  /// Returns the name of a node for programs.
  [[nodiscard]] NodeRef ref(vrml::SceneGraph& scene, vrml::NodeId node);
  /// Returns the scene that a program names; null if it is not part of the world.
  [[nodiscard]] vrml::SceneGraph* scene_of(std::uint64_t serial) const;
  /// Returns the node that a program names; its scene is null if it is not part of the world.
  [[nodiscard]] NodeAt find(const NodeRef& node) const;

 private:
  [[nodiscard]] static bool acts_at_once(Ask ask);
  void hold(const Notice& notice);
  void release(const Notice& notice);
  void set_own_value(const Notice& notice);
  void send_own(const Notice& notice);
  void post(const Notice& notice);

  vrml::Execution& execution_;
  ScriptMessages& messages_;
  RequestQueue& requests_;
  ReadGuard& reads_;
  BrowserState state_;
  ScriptRecord* running_ = nullptr;
  bool ends_ = false;
  std::unordered_map<std::uint64_t, vrml::SceneGraph*> scenes_;  // that programs know, by serial number
  std::uint64_t removals_ = 0;                                   // WorldScenes::removals() at the last take_gone()
  std::unordered_map<NodeRef, std::uint32_t, HashNodeRef> held_;
};

/// Row of a table of questions and the functions that answer them.
struct AnswerRow {
  Ask ask;
  Answer (*answer)(WorldAnswers& world, const Question& question);
};
[[nodiscard]] std::span<const AnswerRow> answers_about_nodes();
[[nodiscard]] std::span<const AnswerRow> answers_of_browser();
[[nodiscard]] std::span<const AnswerRow> answers_about_viewer();
[[nodiscard]] std::span<const AnswerRow> answers_for_x3d();

/// Returns a value with null for each node that its scene does not have.
[[nodiscard]] vrml::FieldValue with_present_nodes(const vrml::SceneGraph& scene, const vrml::FieldValue& value);
/// Returns a pointer to the type of a node that exists as long as the node. It owns nothing.
[[nodiscard]] std::shared_ptr<const vrml::NodeType> pointer_to(const vrml::NodeType& type);
/// Reports whether an event to this eventIn would replace the program of a Script.
[[nodiscard]] bool sets_program(const vrml::NodeType& type, const vrml::InterfaceDeclaration& event_in);

}  // namespace gs::app::script
