// Tests of a world with hostile programs, which may say anything.
#include "app/script/boundary/hear.h"
#include "app/script/world/scripted_world.h"
#include "tests/vrml/events/trace.h"

#include <catch2/catch.hpp>

#include <functional>
#include <random>
#include <string>
#include <utility>

namespace gs::app::script::hostile_programs_test {
namespace {

/// Host that answers each order with a function.
class FakeHost final : public ProgramHost {
 public:
  explicit FakeHost(std::function<void(const Order&)> act) : act_(std::move(act)) {}
  [[nodiscard]] Report run(const Order& order) override {
    act_(order);
    Report report;
    report.good = report.runs = true;
    return report;
  }

 private:
  std::function<void(const Order&)> act_;
};

constexpr char kBody[] =
    "DEF T Transform { translation 1 2 3 } DEF W WorldInfo { title \"secret\" } "
    "DEF S Script { url \"javascript: ;\" field SFInt32 count 1 field SFNode node NULL eventOut SFInt32 out "
    "eventIn SFInt32 in } ";

/// World with a Script of a hostile program.
class HostileWorld : public vrml::traces::World {
 public:
  explicit HostileWorld(std::function<void(HostileWorld&, const Order&)> act)
      : vrml::traces::World(kBody), act_(std::move(act)), scripts_(execution(), {0, true}) {
    scripts_.set_host(std::make_unique<FakeHost>([this](const Order& order) {
      if (order.facts) self_ = order.facts->node;
      act_(*this, order);
    }));
    execution().scripts().set_host(&scripts_);
  }
  ~HostileWorld() override { execution().scripts().set_host(nullptr); }

  WorldAccess& answers() { return scripts_.answers(); }
  ScriptedWorld& scripts() { return scripts_; }
  [[nodiscard]] NodeRef ref(const std::string& name) { return {scene().serial(), node(name)}; }
  [[nodiscard]] const NodeRef& self() const { return self_; }

 private:
  std::function<void(HostileWorld&, const Order&)> act_;
  ScriptedWorld scripts_;
  NodeRef self_;
};

std::uint32_t place_of(const vrml::NodeType& type, std::string_view name) {
  for (std::uint32_t i = 0; i < type.interfaces.size(); ++i)
    if (type.interfaces[i].name == name) return i;
  return 0;
}

}  // namespace

TEST_CASE("accepts only own values of the right type, and never the url of a Script") {
  HostileWorld world([](HostileWorld& self, const Order& order) {
    if (order.kind != Order::Kind::start) return;
    const vrml::NodeType& type = *order.facts->type;
    const auto tell = [&](std::uint32_t place, vrml::FieldValue value) {
      Notice notice{Notice::Kind::own_value};
      notice.place = place;
      notice.value = std::move(value);
      self.answers().tell(notice);
    };
    tell(place_of(type, "url"), vrml::MFString{"javascript: evil"});
    tell(place_of(type, "count"), vrml::SFFloat{2});
    tell(place_of(type, "in"), vrml::SFInt32{2});
    tell(place_of(type, "node"), vrml::SFNode{1000, 1});
    tell(100000, vrml::SFInt32{2});
    Notice send{Notice::Kind::send_own};
    for (const std::uint32_t place : {place_of(type, "url"), place_of(type, "in"), 100000U}) {
      send.place = place;
      self.answers().tell(send);
    }
  });
  world.start();
  const vrml::Node& script = world.scene().node(world.node("S"));
  const auto value = [&](const char* name) -> const vrml::FieldValue& {
    return script.values[script.type->find_field(name)->slot];
  };
  CHECK(std::get<vrml::MFString>(value("url"))[0].view() == "javascript: ;");
  CHECK(std::get<vrml::SFInt32>(value("count")) == 1);
  CHECK(std::get<vrml::SFNode>(value("node")) == vrml::SFNode{});
}

TEST_CASE("sends events of programs only to nodes of the world, with values of their type") {
  HostileWorld world([](HostileWorld& self, const Order& order) {
    if (order.kind != Order::Kind::start) return;
    const NodeRef transform = self.ref("T");
    const vrml::NodeType& type = *self.scene().node(transform.id).type;
    const auto post = [&](NodeRef node, std::uint32_t place, vrml::FieldValue value) {
      Notice notice{Notice::Kind::post, node, place};
      notice.value = std::move(value);
      self.answers().tell(notice);
    };
    post(transform, place_of(type, "translation"), vrml::SFBool{true});
    post(transform, place_of(type, "bboxSize"), vrml::SFVec3f(9, 9, 9));  // a field
    post(transform, 100000, vrml::SFVec3f(9, 9, 9));
    post({transform.scene + 1, transform.id}, place_of(type, "translation"), vrml::SFVec3f(9, 9, 9));
    post({transform.scene, {transform.id.index, transform.id.generation + 1}}, place_of(type, "translation"),
         vrml::SFVec3f(9, 9, 9));
    post(transform, place_of(type, "children"), vrml::MFNode{{12345, 6}, self.node("T")});
  });
  world.start();
  const vrml::Node& node = world.scene().node(world.node("T"));
  CHECK(std::get<vrml::SFVec3f>(node.values[node.type->find_field("translation")->slot]) == vrml::SFVec3f(1, 2, 3));
  CHECK(std::get<vrml::SFVec3f>(node.values[node.type->find_field("bboxSize")->slot]) == vrml::SFVec3f(-1, -1, -1));
}

TEST_CASE("ignores releases of nodes that programs do not hold") {
  HostileWorld world([](HostileWorld& self, const Order&) {
    for (int i = 0; i < 3; ++i) self.answers().tell({Notice::Kind::release, self.ref("T")});
    self.answers().tell({Notice::Kind::hold, {1, {99999, 1}}});
  });
  world.start();
  world.step(1);
  CHECK(world.scene().contains(world.node("T")));
}

TEST_CASE("survives any questions and notices of programs") {
  std::mt19937 generator(7);
  const auto random = [&] { return static_cast<std::uint32_t>(generator()); };
  HostileWorld world([&](HostileWorld& self, const Order&) {
    const auto any_ref = [&] {
      const std::uint64_t scene = random() % 4 == 0 ? random() : self.scene().serial();
      return NodeRef{scene, {random() % 8, random() % 4 == 0 ? random() : random() % 8}};
    };
    const auto any_value = [&] {
      vrml::FieldValue value = vrml::initial_value(static_cast<vrml::FieldType>(random() % vrml::kFieldTypeCount));
      if (auto* const node = std::get_if<vrml::SFNode>(&value)) *node = any_ref().id;
      if (auto* const nodes = std::get_if<vrml::MFNode>(&value))
        for (int i = 0; i < 3; ++i) nodes->push_back(any_ref().id);
      return value;
    };
    for (int i = 0; i < 500; ++i) {
      Question question{static_cast<Ask>(random() % kAskCount), any_ref(), any_ref(),
                        random() % 3 == 0 ? random() : random() % 20, random() % 2 == 0};
      constexpr const char* kTexts[] = {"", "T", "translation", "title", "Shape { geometry Box {} }", "avatarSize"};
      question.text = kTexts[random() % std::size(kTexts)];
      question.more = kTexts[random() % std::size(kTexts)];
      question.value = any_value();
      question.second = any_value();
      (void)self.answers().ask(question);
      Notice notice{static_cast<Notice::Kind>(random() % kNoticeCount), any_ref(),
                    random() % 3 == 0 ? random() : random() % 20};
      notice.text = kTexts[random() % std::size(kTexts)];
      notice.value = any_value();
      self.answers().tell(notice);
    }
  });
  world.start();
  for (int i = 1; i < 20; ++i) {
    world.scripts().begin_step();
    world.step(i);
    (void)world.scripts().take_requests();
    (void)world.scripts().take_messages();
    if (world.scene().contains(world.node("S")))
      (void)world.execution().send(world.scene(), world.node("S"),
                                   *world.scene().node(world.node("S")).type->find_event_in("in"), vrml::SFInt32{i});
  }
  SUCCEED();
}

}  // namespace gs::app::script::hostile_programs_test
