// Traces of worlds in the encodings of X3D.
#include "tests/vrml/encodings.h"
#include "tests/vrml/events/trace.h"

#include <string>
#include <vector>

namespace gs::vrml::encoded_events_test {
namespace {

using traces::Lines;

// Returns the events of a world in two seconds, in which its TouchSensors and Scripts are not used.
Lines events_of(const std::string& text) {
  const auto world = traces::World::of_text(text);
  world->start();
  Lines lines;
  for (const double time : {0.0, 0.1, 0.5, 0.55, 1.0, 1.3, 2.0})
    for (std::string& line : world->take_at(time)) lines.push_back(std::move(line));
  return lines;
}

const std::vector<std::string> kWorlds = {
    "DEF C TimeSensor { cycleInterval 1 loop TRUE startTime 1000 }\n"
    "DEF P PositionInterpolator { key [ 0 1 ] keyValue [ 0 0 0, 1 2 3 ] }\n"
    "DEF O OrientationInterpolator { key [ 0 1 ] keyValue [ 0 1 0 0, 0 1 0 3 ] }\n"
    "DEF S ScalarInterpolator { key [ 0 0.5 1 ] keyValue [ 0 1 0 ] }\n"
    "DEF K ColorInterpolator { key [ 0 1 ] keyValue [ 1 0 0, 0 1 0 ] }\n"
    "DEF V CoordinateInterpolator { key [ 0 1 ] keyValue [ 0 0 0, 1 0 0, 0 1 0, 1 1 0 ] }\n"
    "DEF T Transform { }\nDEF M Material { }\nDEF W Coordinate { }\n"
    "ROUTE C.fraction_changed TO P.set_fraction\nROUTE C.fraction_changed TO O.set_fraction\n"
    "ROUTE C.fraction_changed TO S.set_fraction\nROUTE C.fraction_changed TO K.set_fraction\n"
    "ROUTE C.fraction_changed TO V.set_fraction\nROUTE P.value_changed TO T.set_translation\n"
    "ROUTE O.value_changed TO T.rotation\nROUTE S.value_changed TO M.transparency\n"
    "ROUTE K.value_changed TO M.set_diffuseColor\nROUTE V.value_changed TO W.point\n",
    "PROTO Clock [ field SFTime length 1 eventOut SFFloat part exposedField SFBool on TRUE ] {\n"
    "  DEF T TimeSensor { cycleInterval IS length loop TRUE startTime 1000 enabled IS on fraction_changed IS part } }\n"
    "PROTO Lamp [ exposedField SFFloat power 1 ] { PointLight { intensity IS power } }\n"
    "DEF C Clock { length 2 }\nDEF L Lamp { }\nDEF D Lamp { power 0.5 }\n"
    "ROUTE C.part TO L.set_power\nROUTE L.power_changed TO D.power\n",
    "DEF C TimeSensor { cycleInterval 0.5 startTime 1000.5 }\nDEF V1 Viewpoint { }\nDEF V2 Viewpoint { }\n"
    "DEF X Switch { choice [ Group { } Group { } ] whichChoice 0 }\nDEF Y Collision { collide TRUE }\n"
    "ROUTE C.isActive TO V2.set_bind\nROUTE V2.isBound TO Y.set_collide\nROUTE C.isActive TO Y.collide\n",
};

// Returns the events that VRML97 has, too: nodes of X3D send more of them.
Lines without_x3d_events(Lines lines) {
  std::erase_if(lines, [](const std::string& line) {
    return line.find(".elapsedTime ") != std::string::npos || line.find(".isActive") != std::string::npos ||
           line.find(".level_changed ") != std::string::npos;
  });
  return lines;
}

}  // namespace

TEST_CASE("sends the same events in each encoding of a world") {
  for (const std::string& body : kWorlds) {
    const std::string vrml97 = "#VRML V2.0 utf8\n" + body;
    const Lines expected = without_x3d_events(events_of(vrml97));
    CHECK(expected.size() > 2);
    for (const Grammar grammar : testing::kX3DGrammars) {
      INFO(testing::name_of(grammar) << "\n" << body);
      CHECK(without_x3d_events(events_of(testing::encoded(vrml97, grammar))) == expected);
    }
  }
}

}  // namespace gs::vrml::encoded_events_test
