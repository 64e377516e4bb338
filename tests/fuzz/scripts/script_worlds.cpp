#include "tests/fuzz/scripts/script_worlds.h"

#include "tests/fuzz/scripts/script_grammar.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <utility>

namespace gs::fuzz {
namespace {

constexpr std::string_view kMark = "==== ";

struct Slot {
  const char *type, *name;
};
constexpr std::array<Slot, 9> kIns = {{{"SFTime", "tick"},
                                       {"SFFloat", "go"},
                                       {"SFVec3f", "place"},
                                       {"MFNode", "nodes"},
                                       {"SFNode", "one"},
                                       {"MFVec3f", "points"},
                                       {"SFString", "word"},
                                       {"MFString", "lines"},
                                       {"SFBool", "on"}}};
constexpr std::array<Slot, 21> kOuts = {
    {{"SFVec3f", "v"},     {"SFNode", "n"},     {"MFNode", "kids"},     {"MFVec3f", "pts"},  {"MFString", "strs"},
     {"SFImage", "img"},   {"SFInt32", "i"},    {"SFColor", "c"},       {"SFRotation", "r"}, {"SFFloat", "f"},
     {"SFTime", "t"},      {"SFBool", "b"},     {"SFString", "s"},      {"SFVec2f", "flat"}, {"MFFloat", "nums"},
     {"MFInt32", "ints"},  {"MFColor", "cols"}, {"MFRotation", "rots"}, {"MFTime", "times"}, {"MFVec2f", "flats"},
     {"MFString", "words"}}};

/// Pair of an eventOut and an eventIn with the same type.
struct Wire {
  const char *out, *in;
};
constexpr std::array<Wire, 8> kWires = {{{"v", "place"},
                                         {"kids", "nodes"},
                                         {"n", "one"},
                                         {"pts", "points"},
                                         {"s", "word"},
                                         {"f", "go"},
                                         {"strs", "lines"},
                                         {"b", "on"}}};

class WorldMaker {
 public:
  explicit WorldMaker(std::uint64_t seed) : random_(seed), kinds_(random_.next() | random_.next()) {}
  std::string make();

 private:
  void file(const std::string& name, bool whole);
  void script(const std::string& name, const std::string& node, const std::string& other, const std::string& inl);
  void prototype(const std::string& name);
  void routes(int scripts, bool prototypes);
  void input(int rows);
  std::string number(int most) { return std::to_string(random_.below(most)); }

  Random random_;
  std::uint64_t kinds_;  // permitted kinds of statements
  std::string out_;
};

void WorldMaker::script(const std::string& name, const std::string& node, const std::string& other,
                        const std::string& inl) {
  out_ += "DEF " + name + " Script {\ndirectOutput TRUE\n";
  if (random_.once_in(3)) out_ += "mustEvaluate TRUE\n";
  out_ += "field SFNode me USE " + name + "\nfield SFNode node " + node + "\nfield SFNode other " + other +
          "\nfield SFNode inl " + inl + "\nfield SFNode view USE V0\nfield SFNode clock USE C\nfield MFNode mine [ " +
          node + " Group { } DEF K" + name +
          " Transform { children Group { } } ]\nfield SFVec3f at 1 2 3\nfield MFVec3f path [ 0 0 0, 1 1 1 ]\n";
  for (const Slot& one : kIns) out_ += "eventIn " + std::string(one.type) + " " + one.name + "\n";
  for (const Slot& one : kOuts) out_ += "eventOut " + std::string(one.type) + " " + one.name + "\n";
  out_ += "url ";
  const bool several = random_.once_in(6);
  if (several) out_ += "[ \"" + std::string(random_.once_in(2) ? "program.js" : "missing.js") + "\" ";
  out_ += "\"javascript:\n";
  ScriptGrammar(random_, out_, kinds_).program();
  out_ += several ? "\" ]\n}\n" : "\"\n}\n";
}

// Appends a PROTO with a Script in it. The Script has fields and events of the PROTO.
void WorldMaker::prototype(const std::string& name) {
  out_ += "PROTO " + name + " [ field SFNode given NULL eventIn SFTime tick eventOut MFNode kids\n" +
          "exposedField MFNode held [ ] exposedField SFVec3f p 0 0 0 ] {\nGroup { children [ DEF PT Transform {\n" +
          "translation IS p children IS held } ] }\nDEF PS Script {\ndirectOutput TRUE\nfield SFNode given IS given\n" +
          "field SFNode me USE PS\nfield SFNode node USE PT\nfield SFNode other USE PT\nfield SFNode inl Inline { }\n" +
          "field SFNode view Viewpoint { }\nfield SFNode clock TimeSensor { }\n" +
          "field MFNode mine [ USE PT ]\neventIn SFTime tick IS tick\neventOut MFNode kids IS kids\n" +
          "eventOut SFVec3f v\neventOut SFNode n\neventOut MFVec3f pts\neventOut MFString strs\neventOut SFString s\n" +
          "url \"javascript:\n";
  ScriptGrammar(random_, out_, kinds_).program();
  out_ += "\"\n}\nROUTE PS.v TO PT.set_translation\n}\n";
}

void WorldMaker::routes(int scripts, bool prototypes) {
  const auto name = [&] { return "S" + number(scripts); };
  for (int i = 0; i < scripts; ++i) out_ += "ROUTE C.cycleTime TO S" + std::to_string(i) + ".tick\n";
  out_ += "ROUTE C.fraction_changed TO " + name() + ".go\n";
  for (const char* route : {".v TO T0.set_translation", ".kids TO T0.addChildren", ".kids TO T1.removeChildren",
                            ".pts TO X.set_point", ".strs TO I0.set_url", ".words TO X2.set_string"})
    if (random_.once_in(2)) out_ += "ROUTE " + name() + route + "\n";
  for (int i = 2 + random_.below(5); i > 0; --i) {
    const Wire& wire = kWires[static_cast<std::size_t>(random_.below(static_cast<int>(kWires.size())))];
    out_ += "ROUTE " + name() + "." + wire.out + " TO ";
    out_ += name() + "." + wire.in + "\n";
  }
  if (random_.once_in(3)) out_ += "ROUTE Browser.event_changed TO " + name() + ".one\n";
  if (random_.once_in(3)) out_ += "ROUTE Browser.viewpointPosition TO " + name() + ".place\n";
  if (random_.once_in(4)) out_ += "ROUTE I0.children_changed TO " + name() + ".nodes\n";
  if (prototypes) out_ += "ROUTE C.cycleTime TO P0.tick\nROUTE P0.kids TO " + name() + ".nodes\n";
}

void WorldMaker::file(const std::string& name, bool whole) {
  out_ += std::string(kMark) + name + "\n#VRML V2.0 utf8\n";
  const bool prototypes = random_.once_in(2);
  if (prototypes) prototype("P");
  out_ += "DEF T0 Transform { children [ DEF X0 TouchSensor { } Shape { geometry Box { } } ] }\n";
  out_ +=
      "DEF T1 Transform { children USE T0 }\nDEF T2 Group { children [ DEF T3 Transform { children Group { } } USE T3 "
      "] }\n";
  out_ += "DEF V0 Viewpoint { description \"v\" }\nDEF V1 Viewpoint { position 0 1 9 }\n";
  out_ += "DEF C TimeSensor { loop TRUE cycleInterval " + std::string(random_.pick({"0.05", "0.1", "0.3"})) + " }\n";
  out_ +=
      "Shape { geometry IndexedFaceSet { coord DEF X Coordinate { point [ 0 0 0, 1 0 0, 0 1 0 ] }\n"
      "coordIndex [ 0 1 2 ] } }\nShape { geometry DEF X2 Text { string \"t\" } }\n";
  if (random_.once_in(3)) out_ += "DEF X3 ProximitySensor { size 9 9 9 }\n";
  out_ += "DEF I0 Inline { " + std::string(whole ? "url \"part0.wrl\" " : "") + "}\n";
  if (whole && random_.once_in(2)) out_ += "DEF I1 Inline { url \"part1.wrl\" }\n";
  if (whole && random_.once_in(3)) out_ += "DEF I2 Inline { url \"memory://b/other.wrl\" }\n";
  if (whole && random_.once_in(3))
    out_ +=
        "EXTERNPROTO E [ eventIn SFTime tick eventOut MFNode kids ] \"part0.wrl#P\"\nDEF E0 E { }\n" +
        std::string("DEF E1 Group { children E { } }\nROUTE C.cycleTime TO E0.tick\nROUTE E0.kids TO E1.addChildren\n");
  out_ +=
      "DEF SX Script {\ndirectOutput TRUE\nfield SFNode node USE T3\nfield MFNode mine [ USE T0 Group { } ]\n"
      "eventIn MFNode nodes\neventOut MFNode kids\neventOut MFVec3f pts\neventOut MFString strs\n"
      "url \"javascript:\nfunction nodes(e) { kids = e; pts[3] = pts[0]; Browser.keep = [e, kids]; }\n\"\n}\n";
  const int scripts = whole ? 2 + random_.below(2) : 1;
  for (int i = 0; i < scripts; ++i) {
    const std::string before = i == 0 ? "SX" : "S" + std::to_string(i - 1);
    script("S" + std::to_string(i), "USE T" + number(4), "USE " + before, "USE I0");
  }
  if (prototypes) {
    out_ += "DEF P0 P { given USE S0 held USE T3 }\n";
    if (random_.once_in(2)) out_ += "DEF P1 P { given USE P0 held P { } }\n";
  }
  routes(scripts, prototypes);
}

void WorldMaker::input(int rows) {
  out_ += std::string(kMark) + "input\n";
  for (int i = 0; i < rows; ++i) {
    char time[32];
    (void)std::snprintf(time, sizeof time, "%.2f", 0.9 * i / rows);
    out_ +=
        "{\"t\": " + std::string(time) + ", " +
        random_.pick({"\"set\": \"S0.tick\", \"value\": 1", "\"set\": \"S1.one\", \"value\": \"T0\"",
                      "\"set\": \"S0.nodes\", \"value\": \"[ T1 S1 ]\"", "\"set\": \"S1.go\", \"value\": 2",
                      "\"set\": \"I0.url\", \"value\": \"[]\"", "\"set\": \"I0.url\", \"value\": \"\\\"part0.wrl\\\"\"",
                      "\"set\": \"I0.url\", \"value\": \"\\\"part1.wrl\\\"\"", "\"move\": [32, 32]",
                      "\"press\": [32, 32]", "\"release\": [32, 32]", "\"press\": \"X0\"", "\"release\": true",
                      "\"viewer\": [0, 0, 3]", "\"set\": \"S0.url\", \"value\": \"[]\"", "\"viewpoint\": \"V1\"",
                      "\"set\": \"S1.url\", \"value\": \"\\\"javascript: function tick(e) { kids = mine; }\\\"\"",
                      "\"set\": \"S0.points\", \"value\": \"[ 1 2 3, 4 5 6 ]\"",
                      "\"set\": \"T0.children\", \"value\": \"[]\""}) +
        "}\n";
  }
}

std::string WorldMaker::make() {
  file("world.wrl", true);
  file("part0.wrl", false);
  if (random_.once_in(2)) file("part1.wrl", false);
  if (random_.once_in(2)) file("b/other.wrl", false);
  if (random_.once_in(3)) file("next.wrl", false);
  if (random_.once_in(4)) file("beside.wrl", false);
  if (random_.once_in(3)) {
    out_ += std::string(kMark) + "program.js\n";
    ScriptGrammar(random_, out_, kinds_).program();
  }
  input(2 + random_.below(8));
  if (random_.once_in(4)) {
    out_ += std::string(kMark) + "console\n";
    ScriptGrammar(random_, out_, kinds_).program();
  }
  return std::move(out_);
}

}  // namespace

std::vector<WorldPart> world_parts(std::string_view text) {
  std::vector<WorldPart> parts;
  bool any = false;
  while (text.starts_with(kMark)) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view name = text.substr(kMark.size(), end - kMark.size());
    text.remove_prefix(std::min(end + 1, text.size()));
    std::size_t next = text.starts_with(kMark) ? 0 : text.find("\n" + std::string(kMark));
    next = next == std::string_view::npos ? text.size() : next == 0 ? 0 : next + 1;
    parts.push_back({name, text.substr(0, next)});
    any = any || name == "world.wrl";
    text.remove_prefix(next);
  }
  return any ? parts : std::vector<WorldPart>{};
}

std::string make_script_world(std::uint64_t seed) { return WorldMaker(seed).make(); }

}  // namespace gs::fuzz
