#include "tests/vrml/events/trace.h"
#include "vrml/scene/node_type.h"
#include "vrml/scene/values/field_numbers.h"

#include <string>

namespace gs::vrml::traces {
namespace {

// Returns a value of the type that differs from `initial`. Nodes are `node`.
FieldValue other_value(const FieldValue& initial, NodeId node) {
  switch (type_of(initial)) {
    case FieldType::SFBool:
      return SFBool{!std::get<SFBool>(initial)};
    case FieldType::SFColor:
      return SFColor{0.25F, 0.5F, 0.75F};
    case FieldType::SFFloat:
      return SFFloat{0.375F};
    case FieldType::SFImage:
      return SFImage{{1, 1, 1, 128}};
    case FieldType::SFInt32:
      return SFInt32{3};
    case FieldType::SFNode:
      return SFNode{node};
    case FieldType::SFRotation:
      return SFRotation{1, 0, 0, 0.5F};
    case FieldType::SFString:
      return SFString{"other"};
    case FieldType::SFTime:
      return SFTime{77.5};
    case FieldType::SFVec2f:
      return SFVec2f{3, 4};
    case FieldType::SFVec3f:
      return SFVec3f{3, 4, 5};
    case FieldType::MFColor:
      return MFColor{{0.25F, 0.5F, 0.75F}};
    case FieldType::MFFloat:
      return MFFloat{0.125F, 0.25F};
    case FieldType::MFInt32:
      return MFInt32{2, 1, 0, -1};
    case FieldType::MFNode:
      return MFNode{node};
    case FieldType::MFRotation:
      return MFRotation{{1, 0, 0, 0.5F}};
    case FieldType::MFString:
      return MFString{"other"};
    case FieldType::MFTime:
      return MFTime{77.5};
    case FieldType::MFVec2f:
      return MFVec2f{{3, 4}};
    case FieldType::MFVec3f:
      return MFVec3f{{3, 4, 5}};
    case FieldType::MFBool:
      return MFBool{true, false};
    case FieldType::MFImage:
      return MFImage{SFImage{{1, 1, 1, 128}}};
    default:
      break;
  }
  FieldValue other = initial_value(type_of(initial));
  const double numbers[kMaxNumbers] = {0.25, 0.5, 0.75};
  write_numbers(other, numbers);
  return other;
}

}  // namespace

TEST_CASE("accepts set_x of every exposedField of every node type, and sends x_changed at that time (4.7)") {
  World world("DEF X Group { }");
  world.start();
  double time = 0;
  int fields = 0;
  for (const auto& type : built_in_node_types()) {
    if (type->kind == NodeType::Kind::script) continue;
    const NodeId node = world.scene().create(*type);
    world.execution().scenes().attach();
    for (const InterfaceDeclaration& field : type->interfaces) {
      if (field.access != AccessType::exposedField) continue;
      INFO(type->name << '.' << field.name);
      ++fields;
      world.step(++time);
      (void)world.take();
      const FieldValue value = other_value(field.initial, world.node("X"));
      const InterfaceDeclaration* event = type->find_event_in("set_" + field.name);
      REQUIRE(event);
      CHECK(type->find_event_out(field.name + "_changed") == event);
      CHECK(world.execution().send(world.scene(), node, *event, value));
      const Lines sent = world.take('.' + field.name + ' ');
      REQUIRE(sent.size() == 1);
      std::string expected = std::to_string(static_cast<int>(time)) + ' ' + type->name + "#1." + field.name + ' ';
      if (type->name == "Group") expected.replace(expected.find('#') + 1, 1, "2");
      print_value(expected, value, world.scene());
      CHECK(sent[0] == expected);
      CHECK((world.scene().node(node).values[field.slot] == value));
      // A looping node stays active, and ignores some of the other events (4.6.9).
      if (has(type->role, Role::time_dependent) && field.name == "loop")
        CHECK(world.execution().send(world.scene(), node, *event, SFBool{false}));
    }
  }
  CHECK(fields > 150);
}

TEST_CASE("replaces every plain field x on set_x and sends nothing (6.17, 6.18, 6.23, 6.24)") {
  World world("DEF X Group { }");
  world.start();
  int fields = 0;
  for (const auto& type : built_in_node_types()) {
    if (type->kind == NodeType::Kind::script) continue;
    const NodeId node = world.scene().create(*type);
    for (const InterfaceDeclaration& event : type->interfaces) {
      if (event.access != AccessType::eventIn || !event.name.starts_with("set_")) continue;
      const InterfaceDeclaration* field = type->find_field(event.name.substr(4));
      if (!field) continue;
      INFO(type->name << '.' << event.name);
      ++fields;
      const FieldValue value = other_value(field->initial, world.node("X"));
      CHECK(world.execution().send(world.scene(), node, event, value));
      CHECK((world.scene().node(node).values[field->slot] == value));
      CHECK(world.take().empty());
    }
  }
  CHECK(fields == 11);  // height, four of Extrusion, four of IndexedFaceSet, two of IndexedLineSet
}

TEST_CASE("prefers an event of the exact name over one with set_ or _changed (4.10.2)") {
  World world(R"(
PROTO P [ eventIn SFVec3f x eventIn SFVec3f set_x eventOut SFVec3f y eventOut SFVec3f y_changed ] {
  DEF Plain Transform { set_translation IS x translation_changed IS y }
  DEF Prefixed Transform { set_translation IS set_x translation_changed IS y_changed } }
DEF S Transform { } DEF I P { } DEF T Transform { }
ROUTE S.translation TO I.x ROUTE S.scale TO I.set_x ROUTE I.y TO T.translation ROUTE I.y_changed TO T.scale)");
  world.start();
  world.send("S.translation", SFVec3f(1, 2, 3));
  CHECK(world.take("Plain") == Lines{"0 Plain.translation 1 2 3"});
  CHECK(world.scene().get<SFVec3f>(world.node("T"), "translation") == SFVec3f(1, 2, 3));
  CHECK(world.scene().get<SFVec3f>(world.node("T"), "scale") == SFVec3f(1));
  world.send_at(1, "S.scale", SFVec3f(4, 5, 6));
  CHECK(world.take("Prefixed") == Lines{"1 Prefixed.translation 4 5 6"});
  CHECK(world.scene().get<SFVec3f>(world.node("T"), "scale") == SFVec3f(4, 5, 6));
}

}  // namespace gs::vrml::traces
