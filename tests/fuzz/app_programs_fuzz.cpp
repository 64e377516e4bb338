// Fuzzes what a hostile process of programs can tell its world. Each message follows its length in 2 bytes.
#include "app/script/boundary/hear.h"
#include "app/script/world/scripted_world.h"
#include "tests/fuzz/app_targets.h"
#include "vrml/syntax/parser.h"

#include <algorithm>
#include <memory>

using namespace gs::app;

namespace gs::fuzz {
namespace {

/// Host that sends the messages of an input.
class MessageHost final : public script::ProgramHost {
 public:
  MessageHost(script::WorldAccess& world, std::span<const std::byte> bytes) : world_(world), rest_(bytes) {}

  [[nodiscard]] script::Report run(const script::Order&) override {
    script::Report report;
    report.good = report.runs = report.has_processed = true;
    script::MessageWriter answer;
    while (rest_.size() >= 2) {
      const std::size_t length = std::to_integer<std::size_t>(rest_[0]) | std::to_integer<std::size_t>(rest_[1]) << 8;
      const std::span<const std::byte> message = rest_.subspan(2, std::min(length, rest_.size() - 2));
      rest_ = rest_.subspan(2 + message.size());
      const script::Heard heard = script::hear(world_, message, answer, report);
      sound_ = sound_ && heard != script::Heard::impossible;
      if (heard == script::Heard::report) break;
    }
    return report;
  }
  [[nodiscard]] bool sound() const { return sound_; }

 private:
  script::WorldAccess& world_;
  std::span<const std::byte> rest_;
  bool sound_ = true;
};

}  // namespace

bool run_program_messages(std::span<const std::byte> bytes) {
  vrml::SceneGraph scene("fuzz");
  Diagnostics diagnostics;
  (void)vrml::parse(
      "#VRML V2.0 utf8\nDEF T Transform { children Shape {} } DEF S Script { url \"javascript: ;\" field SFNode n USE "
      "T "
      "field MFNode list [] eventIn SFFloat go eventOut SFVec3f out } ROUTE S.out TO T.translation",
      scene, diagnostics);
  const vrml::NodeId script = scene.roots()[1];  // the program may remove this node
  const vrml::InterfaceDeclaration* const go = scene.node(script).type->find_event_in("go");
  vrml::Execution execution(scene);
  script::ScriptedWorld world(execution, {0, true});
  auto made = std::make_unique<MessageHost>(world.answers(), bytes);
  const MessageHost& host = *made;
  world.set_host(std::move(made));
  execution.scripts().set_host(&world);
  execution.start(1000);
  for (int i = 1; i <= 3; ++i) {
    world.begin_step();
    execution.step(1000 + i);
    if (scene.contains(script)) (void)execution.send(scene, script, *go, vrml::SFFloat(2));
    (void)world.take_messages();
    (void)world.take_requests();
  }
  return host.sound();
}

}  // namespace gs::fuzz
