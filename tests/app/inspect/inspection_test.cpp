#include "app/inspect/inspection.h"
#include "base/noncopyable.h"

#include "tests/app/one_world.h"

#include <catch2/catch.hpp>

#include <string>
#include <variant>

namespace gs::app::inspection_test {

using namespace sessions;

/// An inspector of one world.
struct Inspected : OneWorld, NonCopyable {
  explicit Inspected(const std::string& body, const InspectionWants& shown = {true, true, true, true, false})
      : OneWorld(body), wants(shown) {
    session.add_extension(inspection);
    for (int i = 0; i < 3; ++i) look();  // until the inspector has the picture, the world and its nodes
  }
  ~Inspected() { session.remove_extension(inspection); }
  // Runs a step, and draws a picture.
  void look(double seconds = 0) {
    now += seconds;
    frame = session.step(now, input_of({}));
    inspection.prepare(session, frame.pictures, now);
    inspection.drawn() = wants;
  }
  [[nodiscard]] NodeAt node(std::string_view name) const {
    const vrml::SceneGraph& scene = *document->world.scene;
    for (std::uint32_t i = 1; i <= scene.nodes().count(); ++i)
      if (scene.nodes().at(i).name == name) return {&scene, scene.nodes().id_at(i)};
    return {};
  }
  void choose(std::string_view name) {
    inspection.select(node(name), true);
    look();
  }
  [[nodiscard]] const vrml::InterfaceDeclaration& interface(std::string_view name) const {
    const NodeAt& at = inspection.selected();
    return *at.scene->node(at.id).type->find(name);
  }
  template <class T>
  [[nodiscard]] T value(std::string_view name) {
    return std::get<T>(*inspection.editor().value_of(interface(name)));
  }

  InspectionWants wants;
  Inspection inspection;
  double now = kStart;
};

constexpr const char* kLamp =
    "DEF Place Transform { translation 5 0 0 children DEF Lamp Shape { appearance Appearance { material DEF Paint "
    "Material {} } geometry DEF Ball Sphere { radius 2 } } } "
    "DEF Clock TimeSensor { loop TRUE cycleInterval 2 } DEF Bright ScalarInterpolator { key [ 0 1 ] keyValue [ 0 1 ] } "
    "ROUTE Clock.fraction_changed TO Bright.set_fraction ROUTE Bright.value_changed TO Paint.transparency";

TEST_CASE("reads no values while no inspector is open") {
  Inspected world(kLamp, {});
  CHECK_FALSE(world.inspection.world());
  CHECK(world.inspection.outline().size() == 0);
  CHECK(world.inspection.index().size() == 0);
  CHECK(world.inspection.routes().rows().empty());
  CHECK_FALSE(world.inspection.busy());
  world.look(1);
  CHECK(world.inspection.events().size() == 0);
  world.wants.tree = true;
  world.look();
  world.look();
  world.look();
  CHECK(world.inspection.outline().size() == 3);
}

TEST_CASE("sends an entered value in the next step, and along ROUTEs") {
  Inspected world(kLamp);
  world.choose("Bright");
  CHECK_FALSE(world.inspection.editor().send_text(world.interface("set_fraction"), "0.25"));
  CHECK(world.inspection.busy());
  world.watch();
  const NodeAt paint = world.node("Paint");
  CHECK(paint.scene->get<vrml::SFFloat>(paint.id, "transparency") != 0.25f);
  world.look();
  CHECK(paint.scene->get<vrml::SFFloat>(paint.id, "transparency") == 0.25f);
  CHECK(world.number_of_events("value_changed") == 1);
  CHECK_FALSE(world.inspection.busy());
}

TEST_CASE("rejects an invalid value, and reports why") {
  Inspected world(kLamp);
  world.choose("Paint");
  const auto before = world.value<vrml::SFFloat>("transparency");
  const auto why = world.inspection.editor().send_text(world.interface("transparency"), "7");
  REQUIRE(why);
  CHECK(*why == "7 is out of range; expected at least 0 and at most 1");
  CHECK(world.inspection.editor().send(world.interface("transparency"), vrml::SFBool(true)));
  CHECK_FALSE(world.inspection.busy());
  world.look();
  CHECK(world.value<vrml::SFFloat>("transparency") == before);
  // Elements of a list field.
  world.choose("Bright");
  const vrml::FieldValue list = *world.inspection.editor().value_of(world.interface("keyValue"));
  CHECK(world.inspection.editor().send_element_text(world.interface("keyValue"), list, 1, "x"));
  CHECK_FALSE(world.inspection.editor().send_element_text(world.interface("keyValue"), list, 1, "0.75"));
  CHECK(world.inspection.editor().send_element_text(world.interface("keyValue"), list, 2, "1") ==
        "the element no longer exists");
  world.look();
  CHECK(world.value<vrml::MFFloat>("keyValue") == vrml::MFFloat{0, 0.75f});
}

TEST_CASE("shows current values, and the times at which eventOuts were sent") {
  Inspected world(kLamp);
  world.choose("Clock");
  world.look(0.5);
  CHECK(world.value<vrml::SFFloat>("fraction_changed") == Approx(0.25f).margin(1e-4));
  const EventWatch::Seen* const seen =
      world.inspection.events().find(world.inspection.selected(), world.interface("fraction_changed"));
  REQUIRE(seen);
  CHECK(seen->time == Approx(kStart + 0.5));
  CHECK(world.inspection.take_news(world.now + 1));
  CHECK(world.inspection.routes().rows().size() == 2);
  world.inspection.routes().set_only_selected(true);
  world.look();
  CHECK(world.inspection.routes().rows().size() == 1);
}

TEST_CASE("selects the clicked Shape, and reveals it in the scene tree") {
  Inspected world(
      "DEF Far Transform { translation 0 0 -500 children Shape { geometry Box {} } } "
      "Group { children DEF Near Shape { geometry Box {} } } Viewpoint { position 0 0 10 }");
  world.inspection.set_picking(true);
  CHECK_FALSE(world.inspection.pick(world.session, {1, 1}));
  CHECK_FALSE(world.inspection.picking());
  REQUIRE(world.inspection.pick(world.session, {100, 50}));
  CHECK(world.inspection.selected() == world.node("Near"));
  world.look();
  CHECK(world.inspection.take_revealed() == 2U);
  CHECK_FALSE(world.inspection.take_revealed());
  CHECK(world.inspection.outline().row(2).node == world.node("Near"));
}

TEST_CASE("marks the selected node in the picture, and flies to it") {
  Inspected world(kLamp);
  // A geometry node has the position of its Shape.
  world.choose("Ball");
  const WideBox& bounds = world.inspection.mark().bounds();
  CHECK(bounds.lower.x == Approx(3).margin(0.1));
  CHECK(bounds.upper.x == Approx(7).margin(0.1));
  REQUIRE(world.inspection.mark().outlines().size() == 1);
  CHECK(world.inspection.mark().outlines()[0].lines.size() == 12);
  CHECK(world.inspection.fly_to_selected());
  world.look();
  world.look(1);
  // After the flight, the centre of the marked edges is the centre of the picture.
  glm::vec2 middle(0);
  for (const auto& [a, b] : world.inspection.mark().outlines()[0].lines) middle += (a + b) / 24.0f;
  CHECK(middle.x == Approx(100).margin(1));
  CHECK(middle.y == Approx(50).margin(1));
  // The camera does not fly to a node without a position.
  world.choose("Clock");
  CHECK_FALSE(world.inspection.fly_to_selected());
  CHECK(world.inspection.mark().outlines()[0].lines.empty());
}

TEST_CASE("finds nodes during typing, one after the other") {
  Inspected world("DEF A Group { children [ DEF B1 Group {} DEF C Group {} ] } DEF B2 Transform {}");
  world.inspection.find("b");
  world.look();
  CHECK(world.inspection.selected() == world.node("B1"));
  world.inspection.find_next(false);
  CHECK(world.inspection.selected() == world.node("B2"));
  CHECK(world.inspection.match() == 1U);
  world.inspection.find_next(false);
  CHECK(world.inspection.selected() == world.node("B1"));
  world.inspection.find_next(true);
  CHECK(world.inspection.selected() == world.node("B2"));
  world.inspection.find("nothing");
  world.look();
  CHECK_FALSE(world.inspection.match());
}

TEST_CASE("runs lines in the selected Script, or alone") {
  Inspected world(
      "DEF S Script { field SFFloat x 2 url \"javascript: function initialize() { print('begun'); }\" } "
      "DEF G Group {} DEF Java Script { url \"a.class\" }");
  const auto last = [&] { return world.inspection.console().lines().back(); };
  CHECK(world.inspection.console().lines().front().text == "begun");
  world.inspection.console().enter("x + 1");
  world.look();
  CHECK(last().kind == ProgramLine::Kind::failure);  // not about a Script
  world.choose("S");
  world.inspection.console().enter("x + 1");
  CHECK(world.inspection.busy());
  world.look();
  CHECK(last().text == "3");
  CHECK(last().kind == ProgramLine::Kind::result);
  world.choose("G");
  world.inspection.console().enter("var kept = Browser.getName(); kept.length > 0");
  world.look();
  CHECK(last().text == "true");
  world.inspection.console().enter("typeof kept");
  world.look();
  CHECK(last().text == "\"string\"");
  world.choose("Java");
  world.inspection.console().enter("1");
  world.look();
  CHECK(last().text == "this Script has no running program");
}

// In a world without Scripts the console's own Script is not in the tree.
TEST_CASE("runs lines in a world without programs") {
  Inspected world("DEF G Group {}");
  world.inspection.console().enter("Browser.createVrmlFromString('Group {}').length");
  world.look();
  CHECK(world.inspection.console().lines().back().text == "1");
  CHECK(world.inspection.outline().size() == 1);
}

TEST_CASE("clears the selection when its node is removed") {
  Inspected world("DEF G Group {}");
  const auto made = world.document->runtime->programs().evaluate(
      *world.document->world.scene, {},
      "var n = Browser.createVrmlFromString('DEF New Group {}'); Browser.replaceWorld(n)");
  INFO(made.text);
  CHECK_FALSE(made.failed);
  world.choose("G");
  world.look(0.1);
  CHECK_FALSE(world.inspection.selected());
  CHECK(world.inspection.outline().size() == 1);
  // A new world clears the selection.
  const auto other = hold_world(world_of("Group {} Group {}"));
  begin_world(*other, world.now);
  world.session.readers().show(other);
  world.look();
  world.look();
  CHECK_FALSE(world.inspection.selected());
}

}  // namespace gs::app::inspection_test
