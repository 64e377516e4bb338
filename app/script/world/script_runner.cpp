#include "app/script/script_runner.h"

#include "app/script/engine/engine.h"
#include "app/script/process/program_process.h"
#include "app/script/world/scripted_world.h"

#include <utility>

namespace gs::app {
namespace {

// World without nodes, for programs that are only compiled.
class EmptyWorld final : public script::WorldAccess {
 public:
  [[nodiscard]] script::Answer ask(const script::Question&) override { return {}; }
  void tell(const script::Notice&) override {}
};

}  // namespace

std::unique_ptr<ScriptRunner> ScriptRunner::make(vrml::Execution& execution, Settings settings) {
  auto made = std::make_unique<script::ScriptedWorld>(execution, settings);
  auto host = script::make_confined_programs(made->answers(), settings.repeatable);
  if (!host) return nullptr;
  made->set_host(std::move(host));
  return made;
}

void ScriptRunner::on_overdue(std::function<void(const std::string&)> observer) {
  script::Engine::on_overdue(std::move(observer));
}

void check_programs(const vrml::SceneGraph& scene, Diagnostics& diagnostics) {
  EmptyWorld world;
  std::unique_ptr<script::ProgramHost> host;
  for (std::uint32_t i = 1; i <= scene.nodes().count(); ++i) {
    const vrml::Node& node = scene.nodes().at(i);
    if (!node.type || !vrml::has(node.type->role, vrml::Role::script) || !scene.contains(scene.nodes().id_at(i)))
      continue;
    if (node.instance != 0) continue;  // a copy in a PROTO instance; its original is checked
    const vrml::InterfaceDeclaration* const url = node.type->find_field("url");
    const auto* const list = url ? std::get_if<vrml::MFString>(&node.values[url->slot]) : nullptr;
    if (!list) continue;
    for (std::size_t k = 0; k < list->size(); ++k) {
      const ProgramPlace held = program_place((*list)[k].view());
      const std::string label = node.name.empty() ? "Script" : "Script " + std::string(node.name);
      if (held.kind == ProgramPlace::Kind::java)
        diagnostics.add({Severity::warning, node.text->file_name(), node.location,
                         label + ": Java programs are not supported; skipped"});
      if (held.kind != ProgramPlace::Kind::held) continue;
      if (!host) host = script::make_confined_programs(world, false);
      if (!host) return;
      script::Order order{script::Order::Kind::check};
      order.text = held.text;
      order.file = node.text->file_name();
      order.at = node.location;
      if (node.type->url_places.size() == list->size()) {
        order.at = node.type->url_places[k];
        order.at.column += static_cast<std::uint32_t>(held.text.data() - (*list)[k].view().data()) + 1;
      }
      script::Report report = host->run(order);
      if (!report.problem) continue;
      report.problem->message = label + ": " + report.problem->message;
      diagnostics.add(std::move(*report.problem));
    }
  }
}

}  // namespace gs::app
