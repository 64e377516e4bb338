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

  [[nodiscard]] script::Report run(const script::Order& order) override {
    script::Report last;
    run_all({&order, 1}, [&](const script::Report& report) {
      last = report;
      return true;
    });
    return last;
  }
  void run_all(std::span<const script::Order> orders, const Reported& reported) override {
    script::MessageWriter answer;
    std::size_t left = orders.size();
    const Reported count = [&](const script::Report& report) {
      if (left == 0) return false;
      --left;
      (void)reported(report);
      return true;
    };
    while (left > 0 && rest_.size() >= 2) {
      const std::size_t length = std::to_integer<std::size_t>(rest_[0]) | std::to_integer<std::size_t>(rest_[1]) << 8;
      const std::span<const std::byte> message = rest_.subspan(2, std::min(length, rest_.size() - 2));
      rest_ = rest_.subspan(2 + message.size());
      sound_ = script::hear(world_, message, answer, count) != script::Heard::impossible && sound_;
    }
    script::Report report;
    report.good = report.runs = report.has_processed = true;
    while (left > 0) (void)count(report);
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
      "field MFNode list [] eventIn SFFloat go eventOut SFVec3f out } ROUTE S.out TO T.translation "
      "DEF C TimeSensor { loop TRUE } DEF B Script { url \"javascript: ;\" eventIn SFFloat go eventIn SFTime tick "
      "eventOut SFVec3f out } ROUTE C.fraction_changed TO S.go ROUTE C.fraction_changed TO B.go ROUTE C.time TO B.tick",
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
